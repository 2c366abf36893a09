"""The time of a group: from a column, from what its format states, or from a sample rate; and what is wrong with it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.arrays import Array

GAP = 1.5
"""A step of more median steps than this is a gap."""
EVEN = 0.5
"""Largest deviation from even spacing, in steps, that is one of the time stamps and not of the rows."""
IRREGULAR = 8
"""Steps that differ from the usual one, from which rounding can be told from rows that were lost or written twice."""
ROUNDED, SHARED = 1.05, 2.0
"""Deviation from even spacing, in steps of the stamps, that is one of rounding; and where rows share a stamp."""
WHOLE = 2e-6
"""Relative deviation from a whole number of Hz up to which a rate is that number: time stamps are rounded."""


class Axis(NamedTuple):
    """Times in s, shape (N,), with the rate of their usual step in Hz.

    `breaks` are the rows before which time jumps, repeats or runs back; `lost` is how many rows are missing there;
    `repeated` how many repeat a time. `is_even` where all other rows are evenly spaced. `resolution` is the step in s
    of time stamps that are about as coarse as the rows or coarser, 0 for finer ones: then the rate is an estimate.
    """

    times: Array
    rate: float
    breaks: NDArray[np.int_]
    lost: int
    repeated: int
    backwards: int
    is_even: bool
    resolution: float = 0.0


def even_axis(rows: int, rate: float, start: float) -> Axis:
    """Return the axis of rows at a stated rate."""
    return unbroken(start + np.arange(rows) / rate, rate)


def unbroken(times: Array, rate: float, is_even: bool = True, resolution: float = 0.0) -> Axis:
    """Return the axis of times without breaks."""
    return Axis(times, rate, np.empty(0, dtype=int), 0, 0, 0, is_even, resolution)


def measured_axis(times: Array) -> Axis | None:
    """Return the axis of a column of times in s, None where it does not rise."""
    steps = np.diff(times)
    rising = steps[steps > 0.0]
    if len(rising) < 2:
        return None
    rounded = None if (steps < 0.0).any() else _rounded_axis(times, steps)
    if rounded is not None or len(rising) < 0.5 * len(steps):
        return rounded
    usual = float(np.median(rising))
    breaks = np.flatnonzero((steps > GAP * usual) | (steps <= 0.0)) + 1
    if len(breaks) > 0.05 * len(steps) and not (steps < 0.0).any():
        return unbroken(times, _whole_rate((len(times) - 1) / float(times[-1] - times[0])), is_even=False)
    parts = np.split(times, breaks)
    spans = np.array([part[-1] - part[0] for part in parts])
    counted = np.array([len(part) - 1 for part in parts])
    rate = _whole_rate(float(np.sum(counted) / np.sum(spans)))
    off = max(float(np.max(np.abs(part - np.linspace(part[0], part[-1], len(part))))) for part in parts)
    jumps = steps[breaks - 1]
    lost = int(np.sum(np.round(jumps[jumps > 0.0] * rate) - 1))
    return Axis(times, rate, breaks, lost, int(np.sum(jumps == 0.0)), int(np.sum(jumps < 0.0)), off * rate <= EVEN)


def _rounded_axis(times: Array, steps: Array) -> Axis | None:
    """Return the axis of rows whose stamps are rounded to about a row or more, None where they are finer.

    Rounding leaves every stamp within one of its steps from evenly spaced times; a row that was lost or written twice
    moves all that follow. Where several rows share a stamp and it is further off, the axis is not even.
    """
    usual = float(np.median(steps))
    is_shared = usual == 0.0
    if not is_shared and np.sum(np.abs(steps - usual) > EVEN * usual) < IRREGULAR:
        return None
    resolution = _resolution(times, steps)
    rows = np.arange(len(times))
    changes = np.flatnonzero(steps > 0.0) + 1
    first, last = changes[0], changes[-1]
    slopes = ((times[last] - times[first]) / (last - first), float(np.polyfit(rows, times - times[0], 1)[0]))
    off, slope = min((float(np.ptp(times - each * rows)), each) for each in slopes)
    if off <= (SHARED if is_shared else ROUNDED) * resolution:
        rate = _whole_rate(1.0 / slope, 1.0 / len(rows))
        return unbroken(times[first] + (rows - first) / rate, rate, resolution=resolution)
    return unbroken(times, 1.0 / slope, is_even=False, resolution=resolution) if is_shared else None


def _resolution(times: Array, steps: Array) -> float:
    """Return the step in s of which all steps of time stamps are multiples, apart from the digits of a number."""
    digits = int(np.floor(-np.log10(16.0 * np.spacing(np.max(np.abs(times)) + 1e-300))))
    different = np.unique(np.round(steps, min(digits, 12)))
    return float(np.min(np.diff(different))) if len(different) > 1 else float(different[0])


def _whole_rate(rate: float, near: float = WHOLE) -> float:
    """Return a rate, or the whole number of Hz that it is apart from rounding."""
    return float(round(rate)) if round(rate) and abs(rate / round(rate) - 1.0) < near else float(f"{rate:.8g}")
