"""Whether the accelerometer of the floor follows the floor, decided from its record alone.

A smooth motion turns at any value, so the time that its slope spends within its noise is about that just beside it:

    stillness = 2 T(|d| < 2 s) / T(2 s <= |d| < 6 s),      s = noise_rms sqrt(12 / rows),

with d the fitted rise over the rows of a window and T the time, is near 1. A sensor that moves in steps or with play
stands still where the floor does not. Near zero the floor may be at rest too, so values there are left out. Extremes
are examined separately: a sensor at its limit shows that value more often than the values next to it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from seatsim.recordings.quality.issue import Issue
from seatsim.recordings.quality.run_under_test import RunUnderTest, is_at_rest
from seatsim.recordings.recording import Recording
from seatsim.schema.arrays import Array

FLOOR = "floor_acceleration"
"""Channel of the floor's accelerometer, whose error acts like a motion of the floor."""
WINDOW, FEWEST = 0.032, 6
"""Seconds over which a slope is fitted, and least rows."""
STILL = 3.0
"""Stillness above which a sensor does not follow the floor; faultless ones have 0.9 to 2."""
FINE = 32
"""Points between two rows at which slopes are taken, so that a sine is sampled at many phases."""
FASTEST = 0.98
"""Share of rises below the one that has to stand out from the noise, lest the floor is too slow to tell."""
NEAR = 0.1
"""Share of its standard deviation within which a record is near zero."""
BIN, BESIDE = 7.0, 3
"""Width in noise of the bins in which values at an extreme, and in that many bins beside it, are counted."""
LEAST = 1e-9
"""m/s^2 of noise that a record has at least."""
PILED, FEW = 5.0, 12
"""Ratio of rows at an extreme to rows in a bin beside it above which it is a limit, and least rows at a limit."""


def check_floor_sensor(run: RunUnderTest) -> Iterator[Issue]:
    """Report an accelerometer of the floor that stands still while the floor moves."""
    if FLOOR in run.table:
        for kind, text in _faults(run.table[FLOOR], run.noise(FLOOR), run.rate):
            yield run.issue("warning", kind, text, FLOOR)


def follows_floor(recording: Recording) -> bool:
    """Say whether the accelerometer of the floor follows it in every run."""
    noise, rate = recording.channels[FLOOR].noise_rms, recording.header.sample_rate
    return not any(_faults(recording.table(run)[FLOOR], noise, rate) for run in recording.runs)


def _faults(values: Array, noise: float, rate: float) -> list[tuple[str, str]]:
    """Return kind and text of the issues of a record; nothing where the floor is at rest."""
    noise = max(noise, LEAST)
    if is_at_rest(values, noise):
        return []
    if _stillness(values, noise, max(FEWEST, round(WINDOW * rate))) > STILL:
        return [("steps", "stands still at values other than zero, as a sensor does that has steps or play; repair it")]
    limits = _limits(values, noise)
    return [("limit", f"stands still about its extreme {at:.4g}; it is clipped: widen its range") for at in limits]


def _limits(values: Array, noise: float) -> list[float]:
    """Return the extremes that values pile up at."""
    piled = []
    for sign in (1.0, -1.0):
        extreme = float(np.max(sign * values))
        edges = extreme - BIN * noise * np.arange(BESIDE + 1, -1, -1)
        *beside, at = np.histogram(sign * values, edges)[0]
        if at >= max(FEW, PILED * np.mean(beside)):
            piled.append(sign * extreme)
    return piled


def _stillness(values: Array, noise: float, rows: int) -> float:
    time = np.arange(rows) - (rows - 1) / 2.0
    windows = sliding_window_view(values, rows)
    rises = windows @ time * rows / (time @ time)
    between = np.linspace(0.0, len(rises) - 1.0, FINE * len(rises))
    means, room = windows.mean(axis=1), BIN * noise
    within = (means > np.min(values) + room) & (means < np.max(values) - room)
    counted = np.repeat(within & (np.abs(means) > NEAR * np.std(values)), FINE)
    unit = 2.0 * noise * np.sqrt(12.0 / rows)
    if np.quantile(np.abs(rises), FASTEST) < 3.0 * unit:
        return 0.0
    size = np.abs(np.interp(between, np.arange(len(rises)), rises))[counted]
    still, beside = np.sum(size < unit), np.sum((size >= unit) & (size < 3.0 * unit))
    return float(2.0 * still / max(beside, FINE))
