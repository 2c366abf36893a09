"""Power spectral densities as reports draw them: by Welch's method, averaged over narrow bands."""

from __future__ import annotations

import numpy as np

from seatsim.metrics.spectra import power_spectral_density
from seatsim.plots.averaging import average_bands
from seatsim.schema.arrays import Array

SEGMENT = 4.0
"""Longest segment in s: its lines are 0.25 Hz apart."""
AVERAGES = 4
"""Fewest half-overlapping segments."""
LOWEST = 0.25
"""Hz from which on a spectrum is drawn."""
PER_OCTAVE = 12
SHORTEST = 64
"""Samples from which on a signal has a spectrum."""
METHOD = f"Spectra: Welch's method in segments of at most {SEGMENT:g} s, averaged over 1/{PER_OCTAVE} octave."


def estimate_spectrum(time: Array, values: Array, highest: float = np.inf) -> tuple[Array, Array] | None:
    """Return frequency in Hz and power spectral density up to `highest`; None where the signal is too short.

    Args:
        time: in s, equally spaced, shape (N,).
        values: the signal, shape (N,).
        highest: frequency in Hz.
    """
    if len(values) < SHORTEST:
        return None
    rate = (len(time) - 1) / float(time[-1] - time[0])
    length = max(8, min(round(SEGMENT * rate), 2 * len(values) // (AVERAGES + 1)))
    frequency, power = power_spectral_density(values, rate, min(length, len(values)))
    inside = frequency <= highest
    centres, density, _ = average_bands(frequency[inside], power[inside], LOWEST, PER_OCTAVE)
    return centres, density
