"""Power spectral densities by Welch's method, and how the seat passes floor vibration on, frequency by frequency."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy import fft

from seatsim.metrics.motion import as_pair, require_positive
from seatsim.metrics.weighting import ComplexArray
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError


def cross_spectral_density(x: Array, y: Array, sample_rate: float, length: int) -> tuple[Array, ComplexArray]:
    """Return frequencies in Hz and the one-sided cross spectral density `S_xy(f)`, shape (F,), in units of x y per Hz.

    `S_xy = 2 mean(conj(X) Y) / (sample_rate sum(w^2))` over half-overlapping segments of `length` samples, each with
    its mean removed and under a periodic Hann window w: what `scipy.signal.csd(x, y, sample_rate, nperseg=length)`
    returns, without that module's half second of import at the start of every command. Source: P. D. Welch 1967, IEEE
    Trans. Audio Electroacoust. 15:70.
    """
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length) if length > 1 else np.ones(1)
    first, second = (_segments(values, length) * window for values in (x, y))
    products = np.conj(fft.rfft(first, axis=-1)) * fft.rfft(second, axis=-1)
    density = products.mean(axis=0) / (sample_rate * np.sum(window**2))
    # One-sided: every line stands for its negative frequency too, except zero and, for even lengths, Nyquist's.
    density[1 : (length + 1) // 2] *= 2.0
    return fft.rfftfreq(length, 1.0 / sample_rate), density


def power_spectral_density(x: Array, sample_rate: float, length: int) -> tuple[Array, Array]:
    """Return frequencies in Hz and the one-sided power spectral density `S_xx(f)`, shape (F,), in units of x^2 per Hz.

    Estimated as in `cross_spectral_density`, over segments of `length` samples.
    """
    frequency, power = cross_spectral_density(x, x, sample_rate, length)
    return frequency, power.real


LOWEST = 0.1
"""Hz at which the bands begin over which a density is averaged: the distance of the lines of the longest segment."""
FIRST_LINE = 2
"""First line of a density. The line before keeps some of the mean under the window: the plain mean is removed."""
PER_OCTAVE = 12
"""Bands in an octave, finer than the resonance of a seat is wide."""
LEAST_SAMPLES = 64
"""Samples from which on a signal has a density."""
_SEGMENTS = 4
"""Least number of half-overlapping segments: half of what a coherence needs, for lines half as far apart.

What is lost in averages comes back where bands hold several lines.
"""


def estimate_density(step: float, signals: Sequence[Array]) -> tuple[Array, Array]:
    """Return frequency in Hz and power spectral density, averaged over narrow bands and several runs, shape (F,) each.

    step: interval of the samples in s. Signals, shape (N,) each, that are too short give none.
    """
    shortest = min(map(len, signals))
    if shortest < LEAST_SAMPLES:
        return np.empty(0), np.empty(0)
    length = min(round(LONGEST / step), 2 * (shortest // (_SEGMENTS + 1)))
    found = [power_spectral_density(values, 1 / step, length) for values in signals]
    return _average_bands(found[0][0], np.mean([power for _, power in found], axis=0))


def _average_bands(frequency: Array, power: Array) -> tuple[Array, Array]:
    """Return mean frequency and mean density of bands of equal width on a logarithmic axis.

    Otherwise the many lines of the high decades would make a drawn line thick and noisy.
    """
    # above what a mean leaves
    inside = frequency >= max(LOWEST, frequency[FIRST_LINE])
    band = np.floor(PER_OCTAVE * np.log2(frequency[inside] / LOWEST) + 1e-9).astype(int)
    _, index, count = np.unique(band, return_inverse=True, return_counts=True)
    return np.bincount(index, frequency[inside]) / count, np.bincount(index, power[inside]) / count


def _segments(values: Array, length: int) -> Array:
    """Return half-overlapping segments with their means removed, shape (S, length)."""
    parts: Array = sliding_window_view(values, length)[:: max(1, length - length // 2)]
    centred: Array = parts - parts.mean(axis=-1, keepdims=True)
    return centred


_AVERAGES = 8
"""Least number of half-overlapping segments: from few of them the coherence is near 1 for any signals."""

LONGEST = 10.0
"""Longest segment in s: lines 0.1 Hz apart resolve a seat's resonance; longer records buy averages."""

_SHORTEST = 1.0
"""Shortest segment in s: beyond 1 Hz between lines the resonance of a seat suspension is smeared out."""

_Spectrum = TypeVar("_Spectrum", Array, ComplexArray)


TRUSTED = 0.5
"""Least coherence of a transmissibility: below it most of the driver's motion is not the floor's."""
_STRETCH = 3
"""Least neighbouring bands of a transmissibility that are trusted: by chance a single one is coherent anywhere."""
POWER = 1e-3
"""Least density of the floor over its highest at which it has power enough for a transmissibility."""


def trusted_gain(floor: Array, driver: Array, sample_rate: float, highest: float) -> tuple[Array, Array]:
    """Return frequency in Hz and transmissibility |H1|, shape (F,) each, NaN where the limits above forbid it.

    H1 = S_fd / S_ff and the coherence |S_fd|^2 / (S_ff S_dd) are estimated by Welch's method: Hann segments with their
    mean removed, half overlapping, as long as eight of them allow but 10 s at most. Noise on the driver's signal does
    not bias H1, noise on the floor's makes it small. Source: J. S. Bendat and A. G. Piersol, Random Data.

    Spectra are averaged over the bands of a density, up to `highest` Hz, and the transmissibility ends for good where a
    stretch of bands is not trusted: above it, chance makes islands of coherence.

    Args:
        floor: acceleration of the floor in m/s^2, shape (N,).
        driver: acceleration of the driver in m/s^2, same shape.
        sample_rate: in Hz, above 0.
        highest: in Hz.

    Raises:
        InputError: the shapes differ, or the record is shorter than 4.5 s.
    """
    from scipy.ndimage import binary_opening

    x, y = as_pair(floor, driver, ("floor", "driver"))
    length = _segment(x.size, require_positive(sample_rate, "sample_rate"))
    lines, first = power_spectral_density(x, sample_rate, length)
    second, cross = (cross_spectral_density(*pair, sample_rate, length)[1] for pair in ((y, y), (x, y)))
    averaged = [_average_bands(lines, values) for values in (first, second.real, cross.real, cross.imag)]
    frequency, (floor_psd, driver_psd, real, imaginary) = averaged[0][0], (power for _, power in averaged)
    joint = real + 1j * imaginary
    response, coherence = _quotient(joint, floor_psd), _quotient(np.abs(joint) ** 2, floor_psd * driver_psd)
    inside = frequency <= highest
    is_strong = floor_psd >= POWER * np.max(floor_psd[inside], initial=1e-300)
    whole = np.ones(_STRETCH, bool)
    known = binary_opening((is_strong & (coherence >= TRUSTED))[inside], whole)
    ends = np.flatnonzero(binary_opening(~known, whole) & np.logical_or.accumulate(known))
    if ends.size:
        known[ends[0] :] = False
    return frequency[inside], np.where(known, np.abs(response)[inside], np.nan)


def _segment(samples: int, sample_rate: float) -> int:
    """Return the even length of a segment such that `_AVERAGES` of them, half overlapping, fit into the record."""
    # n segments that overlap by half span (n + 1) half segments.
    longest = 2 * (samples // (_AVERAGES + 1))
    if longest < _SHORTEST * sample_rate:
        needed = _SHORTEST * (_AVERAGES + 1) / 2
        raise InputError(f"the record lasts {samples / sample_rate:g} s; a transmissibility needs {needed:g} s or more")
    return min(longest, 2 * round(LONGEST * sample_rate / 2))


def _quotient(numerator: _Spectrum, power: Array) -> _Spectrum:
    """Return the quotient, shape (F,), where there is power, and NaN elsewhere."""
    undefined = np.full_like(numerator, np.nan)
    return np.divide(numerator, power, out=undefined, where=power > 0)
