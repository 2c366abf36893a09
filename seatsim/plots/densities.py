"""Power spectral densities as pictures and reports show them: Welch's method, averaged over narrow bands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from matplotlib.axes import Axes

from seatsim.metrics.spectra import LONGEST, power_spectral_density
from seatsim.plots import style
from seatsim.plots.style import Entry
from seatsim.schema.arrays import Array

LOWEST = 0.1
"""Hz from which on a density is drawn: the distance of the lines of the longest segment."""
PER_OCTAVE = 12
"""Bands in an octave, finer than the resonance of a seat is wide."""
DECADES = 5.0
"""Decades below the highest density, of the motion of a seat."""
SHORTEST = 64
"""Samples from which on a signal has a spectrum."""
Densities: TypeAlias = Sequence[tuple[Array, Array]]
"""Frequencies in Hz and power spectral densities of some lines, shape (F,) each."""
SEGMENTS = 4
"""Least number of half-overlapping segments: half of what a coherence needs, for lines half as far apart.

What is lost in averages comes back where bands hold several lines.
"""
METHOD = (
    f"Welch's method, {SEGMENTS} half-overlapping segments or more of {LONGEST:g} s at most, averaged over"
    f" 1/{PER_OCTAVE} octave."
)


def estimate_density(step: float, signals: Sequence[Array]) -> tuple[Array, Array]:
    """Return frequency in Hz and power spectral density, the mean over the signals of several runs, shape (F,) each.

    step: interval of the samples in s. Signals, shape (N,) each, that are too short give none.
    """
    shortest = min(map(len, signals))
    if shortest < SHORTEST:
        return np.empty(0), np.empty(0)
    length = min(round(LONGEST / step), 2 * (shortest // (SEGMENTS + 1)))
    found = [power_spectral_density(values, 1 / step, length) for values in signals]
    return average_bands(found[0][0], np.mean([power for _, power in found], axis=0))


def find_resolution(densities: Densities) -> float:
    """Return the largest distance in Hz between the lines of some densities, infinite where none has lines."""
    # The first line is as far from 0 as the next one is from it, and no other shares its band.
    return max((float(frequency[0]) for frequency, _ in densities if len(frequency)), default=np.inf)


def state_method(resolution: float) -> str:
    """Return how a picture's densities were estimated, whose lines are `resolution` Hz apart."""
    lines = f"lines up to {resolution:.2g} Hz apart, " * bool(np.isfinite(resolution))
    return f"Welch's method, {lines}averaged over 1/{PER_OCTAVE} octave."


def find_problem(densities: Densities, highest: float) -> str:
    """Return why nothing is drawn of densities up to a highest frequency in Hz, empty where something is."""
    if not any(len(frequency) for frequency, _ in densities):
        return f"too short for a spectrum, which takes {SHORTEST} samples"
    return "" if any(np.any(power[frequency <= highest]) for frequency, power in densities) else "at rest"


def draw_densities(
    axes: Axes, densities: Densities, looks: Sequence[Entry], highest: float = np.inf, decades: float = DECADES
) -> None:
    """Draw densities, as frequency and power, up to a highest frequency in Hz; say so where nothing has power.

    decades: below the highest density that are shown.
    """
    if problem := find_problem(densities, highest):
        return style.explain_empty(axes, problem)
    inside = [(frequency[frequency <= highest], power[frequency <= highest]) for frequency, power in densities]
    largest = max(float(np.max(power, initial=0.0)) for _, power in inside)
    axes.set_yscale("log")
    for (frequency, power), look in zip(inside, looks, strict=True):
        style.draw_line(axes, frequency, np.where(power > 0, power, np.nan), look)
    low, high = axes.get_ylim()
    style.scale_log(axes, "y", max(low, largest / 10**decades), high)


def average_bands(frequency: Array, power: Array, lowest: float = LOWEST) -> tuple[Array, Array]:
    """Return mean frequency and mean density of bands of equal width on a logarithmic axis.

    Otherwise the many lines of the high decades would make the drawn line thick and noisy.
    """
    # Segments have their means removed, so that the first line holds nothing.
    inside = frequency >= max(lowest, frequency[1])
    band = np.floor(PER_OCTAVE * np.log2(frequency[inside] / lowest) + 1e-9).astype(int)
    _, index, count = np.unique(band, return_inverse=True, return_counts=True)
    return np.bincount(index, frequency[inside]) / count, np.bincount(index, power[inside]) / count
