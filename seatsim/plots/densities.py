"""Power spectral densities as pictures show them, and what is said of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from matplotlib.axes import Axes

from seatsim.metrics.spectra import FIRST_LINE, LEAST_SAMPLES, PER_OCTAVE
from seatsim.plots import style
from seatsim.plots.style import Entry
from seatsim.schema.arrays import Array

DECADES = 5.0
"""Decades below the highest density, of the motion of a seat."""
_Densities: TypeAlias = Sequence[tuple[Array, Array]]
"""Frequencies in Hz and power spectral densities of some lines, shape (F,) each."""


def find_first(densities: _Densities) -> float:
    """Return the highest frequency in Hz at which one of some densities begins, infinite where none has lines."""
    return max((float(frequency[0]) for frequency, _ in densities if len(frequency)), default=np.inf)


def state_method(first: float) -> str:
    """Return how a picture's densities were estimated that begin at `first` Hz; no other line shares its band."""
    lines = f"lines up to {first / FIRST_LINE:.2g} Hz apart, " * bool(np.isfinite(first))
    return f"Welch's method, {lines}averaged over 1/{PER_OCTAVE} octave, without the mean."


def find_problem(densities: _Densities, highest: float) -> str:
    """Return why nothing is drawn of densities up to a highest frequency in Hz, empty where something is."""
    if not any(len(frequency) for frequency, _ in densities):
        return f"too short for a spectrum, which takes {LEAST_SAMPLES} samples"
    return "" if any(np.any(power[frequency <= highest]) for frequency, power in densities) else "at rest"


def draw_densities(
    axes: Axes, densities: _Densities, looks: Sequence[Entry], highest: float = np.inf, decades: float = DECADES
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
    low, _ = axes.get_ylim()
    style.scale_log(axes, "y", max(low, largest / 10**decades), 2.0 * largest)
