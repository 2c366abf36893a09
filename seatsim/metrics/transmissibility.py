"""How the seat passes floor vibration on to the driver, frequency by frequency."""

from __future__ import annotations

from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from seatsim.metrics.arrays import as_pair, require_positive
from seatsim.metrics.spectra import cross_spectral_density, power_spectral_density
from seatsim.metrics.weighting import ComplexArray
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError

AVERAGES = 8
"""Least number of half-overlapping segments: from few of them the coherence is near 1 for any signals."""

LONGEST = 10.0
"""Longest segment in s: lines 0.1 Hz apart resolve a seat's resonance; longer records buy averages."""

SHORTEST = 1.0
"""Shortest segment in s: beyond 1 Hz between lines the resonance of a seat suspension is smeared out."""

Spectrum = TypeVar("Spectrum", Array, ComplexArray)


class Transmissibility(NamedTuple):
    """Estimate of the response of the driver's acceleration to the floor's, shape (F,) each."""

    frequency: Array
    """In Hz, from 0 to half the sample rate."""
    response: ComplexArray
    """H1(f), dimensionless; NaN where the floor does not move."""
    coherence: Array
    """gamma^2(f), 0 to 1: share of the driver's power that the floor explains; NaN where one is at rest."""
    segments: int
    """Number of half-overlapping segments that were averaged."""

    @property
    def gain(self) -> Array:
        """|H1(f)|, the transmissibility, dimensionless, shape (F,)."""
        return np.abs(self.response)


def transmissibility(floor: ArrayLike, driver: ArrayLike, sample_rate: float) -> Transmissibility:
    """Return H1 = S_fd / S_ff with the coherence |S_fd|^2 / (S_ff S_dd), by Welch's method.

    Hann segments with their mean removed, half overlapping, as long as eight of them allow but 10 s at most.
    Noise on the driver's signal does not bias H1, noise on the floor's makes it small. Trust it where the
    coherence is high. Source: J. S. Bendat and A. G. Piersol, Random Data.

    Args:
        floor: acceleration of the floor in m/s^2, shape (N,).
        driver: acceleration of the driver in m/s^2, same shape.
        sample_rate: in Hz, above 0.

    Raises:
        InputError: the shapes differ, or the record is shorter than 4.5 s.
    """
    x, y = as_pair(floor, driver, ("floor", "driver"))
    length = _segment(x.size, require_positive(sample_rate, "sample_rate"))
    frequency, floor_psd = power_spectral_density(x, sample_rate, length)
    _, driver_psd = power_spectral_density(y, sample_rate, length)
    _, cross = cross_spectral_density(x, y, sample_rate, length)
    response = _quotient(cross, floor_psd)
    coherence = _quotient(np.abs(cross) ** 2, floor_psd * driver_psd)
    segments = 2 * x.size // length - 1
    return Transmissibility(frequency, response, coherence, segments)


def _segment(samples: int, sample_rate: float) -> int:
    """Return the even length of a segment such that `AVERAGES` of them, half overlapping, fit into the record."""
    # n segments that overlap by half span (n + 1) half segments.
    longest = 2 * (samples // (AVERAGES + 1))
    if longest < SHORTEST * sample_rate:
        needed = SHORTEST * (AVERAGES + 1) / 2
        raise InputError(f"the record lasts {samples / sample_rate:g} s; a transmissibility needs {needed:g} s or more")
    return min(longest, 2 * round(LONGEST * sample_rate / 2))


def _quotient(numerator: Spectrum, power: Array) -> Spectrum:
    """Return the quotient, shape (F,), where there is power, and NaN elsewhere."""
    undefined = np.full_like(numerator, np.nan)
    return np.divide(numerator, power, out=undefined, where=power > 0)
