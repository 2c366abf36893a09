"""The time of a group: from a column, from what its format states, or from a sample rate; and what is wrong with it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.importing.signals import Array

GAP = 1.5
"""A step of more median steps than this is a gap."""
EVEN = 0.5
"""Largest deviation from even spacing, in steps, that is one of the time stamps and not of the rows."""
WHOLE = 2e-6
"""Relative deviation from a whole number of Hz up to which a rate is that number: time stamps are rounded."""


class Axis(NamedTuple):
    """Times in s, shape (N,), with the rate of their usual step in Hz.

    `breaks` are the rows before which time jumps, repeats or runs back; `lost` is how many rows are missing there;
    `repeated` how many repeat a time. `is_even` where all other rows are evenly spaced.
    """

    times: Array
    rate: float
    breaks: NDArray[np.int_]
    lost: int
    repeated: int
    backwards: int
    is_even: bool


def even_axis(rows: int, rate: float, start: float = 0.0) -> Axis:
    """Return the axis of rows at a stated rate."""
    return unbroken(start + np.arange(rows) / rate, rate)


def unbroken(times: Array, rate: float, is_even: bool = True) -> Axis:
    """Return the axis of times without breaks."""
    return Axis(times, rate, np.empty(0, dtype=int), 0, 0, 0, is_even)


def measured_axis(times: Array) -> Axis | None:
    """Return the axis of a column of times in s, None where it does not rise."""
    steps = np.diff(times)
    rising = steps[steps > 0.0]
    if len(rising) < max(1, 0.5 * len(steps)):
        return None
    usual = float(np.median(rising))
    breaks = np.flatnonzero((steps > GAP * usual) | (steps <= 0.0)) + 1
    resolution = float(np.min(rising)) if len(rising) else usual
    if len(breaks) > 0.05 * len(steps) and not (steps < 0.0).any():
        return _coarse(times, resolution)
    parts = np.split(times, breaks)
    spans = np.array([part[-1] - part[0] for part in parts])
    counted = np.array([len(part) - 1 for part in parts])
    rate = whole_rate(float(np.sum(counted) / np.sum(spans)))
    off = max(float(np.max(np.abs(part - np.linspace(part[0], part[-1], len(part))))) for part in parts)
    jumps = steps[breaks - 1]
    lost = int(np.sum(np.round(jumps[jumps > 0.0] * rate) - 1))
    return Axis(times, rate, breaks, lost, int(np.sum(jumps == 0.0)), int(np.sum(jumps < 0.0)), off * rate <= EVEN)


def _coarse(times: Array, resolution: float) -> Axis:
    """Return the axis of times that are coarser than the rows, or that are irregular."""
    rows, span = len(times), float(times[-1] - times[0])
    rate = whole_rate((rows - 1) / span)
    off = float(np.max(np.abs(times - np.linspace(times[0], times[-1], rows))))
    return unbroken(times, rate, off <= max(EVEN / rate, resolution))


def whole_rate(rate: float) -> float:
    """Return a rate, or the whole number of Hz that it is apart from rounding."""
    return float(round(rate)) if round(rate) and abs(rate / round(rate) - 1.0) < WHOLE else float(f"{rate:.8g}")
