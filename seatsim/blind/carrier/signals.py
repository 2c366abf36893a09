"""Arithmetic on recorded signals: shifts, low-passes, velocities, and forces that depend on a recorded motion."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter, savgol_filter

from seatsim.schema.arrays import Array

SMOOTHING = 0.02
"""s; window of the polynomial whose slope is the velocity."""


def slope(values: Array, step: float) -> Array:
    """Return the time derivative of a recorded signal, shape (N,), by a sliding cubic (Savitzky and Golay 1964)."""
    window = max(5, 2 * round(0.5 * SMOOTHING / step) + 1)
    return np.asarray(savgol_filter(values, min(window, len(values) // 2 * 2 - 1), 3, deriv=1, delta=step))


def shifted(values: Array, late: Array | float, step: float) -> Array:
    """Return the signal of `late` seconds ago, linear between rows, held at the ends."""
    time = np.arange(len(values)) * step
    late_values: Array = np.interp(time - late, time, values)
    return late_values


def shifted_rows(values: Array, late: int) -> Array:
    """Return a signal that holds between rows, `late` rows later (negative: earlier), held at the ends."""
    rows = np.clip(np.arange(len(values)) - late, 0, len(values) - 1)
    return values[rows]


def low_pass(values: Array, time: float, step: float) -> Array:
    """Return the exact first-order response with time constant `time` [s] to a signal held between rows' midpoints."""
    a = float(np.exp(-step / time)) if time > 0.0 else 0.0
    half = float(np.exp(-0.5 * step / time)) if time > 0.0 else 0.0
    response = lfilter([1.0 - half, half - a], [1.0, -a], values - values[0])
    return np.asarray(response + values[0])


def slide(x: Array, travel: float) -> Array:
    """Return the Jenkins element of a motion: -1 to 1, stiff over half of `travel` [m], then sliding; shape (N,)."""
    found, anchor, half = np.empty_like(x), float(x[0]), 0.5 * travel
    for k, here in enumerate(x):
        anchor = min(max(anchor, here - half), here + half)
        found[k] = (here - anchor) / half
    return found
