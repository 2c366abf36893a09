"""Steps of a current: where it rests, where it leaves one level for another."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from seatsim.schema.arrays import Array

LEAST_RANGE = 0.02
"""A; a current that varies less has no steps."""
FLAT = 0.02
"""Standard deviation, over the range of the current, within a window at rest."""
WINDOW = 0.004
"""Seconds of the window in which a current has to rest, five rows at least."""
APART = 0.1
"""Difference of two levels over the range of the current that makes a step."""
LEFT = 0.05
"""Share of a step that has been covered where it begins."""
TO_DEVIATION = 0.6745 * 6.0**0.5
"""Median magnitude of the second differences of white noise over its standard deviation."""


class Plateau(NamedTuple):
    """Rows `first` to `last` (excluded) of a current that rests at a level in A."""

    first: int
    last: int
    level: float


class CurrentStep(NamedTuple):
    """A step of current: the row (with fraction) at which it begins, and the levels before and after it."""

    row: float
    before: Plateau
    after: Plateau

    @property
    def rises(self) -> bool:
        """Whether the current rises."""
        return self.after.level > self.before.level


def find_steps(current: Array, rate: float, commanded: bool) -> list[CurrentStep]:
    """Return the steps of a current in A, shape (N,), at `rate` Hz, in their order.

    A step leads from one level at which the current rests to another. It begins at the row at which 5 % of it is
    covered: a command holds from its row on; between the rows of a measured current it is interpolated.
    """
    rests = find_plateaus(current, rate)
    return [CurrentStep(_onset(current, a, b, commanded), a, b) for a, b in pairwise(rests)]


def find_plateaus(current: Array, rate: float) -> list[Plateau]:
    """Return the stretches over which a current in A, shape (N,), at `rate` Hz rests, in their order.

    None where it varies by less than `LEAST_RANGE` in all. A current rests where its standard deviation within
    `WINDOW` is small; the level is the median of the later half, neighbours of the same level are one.
    """
    span = float(np.ptp(current))
    window = max(5, round(WINDOW * rate))
    if span < LEAST_RANGE or len(current) < 4 * window:
        return []
    spread = np.std(np.lib.stride_tricks.sliding_window_view(current, window), axis=1)
    noise = float(np.median(np.abs(np.diff(current, 2)))) / TO_DEVIATION
    flat = spread <= FLAT * span + 2.0 * noise
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flat.astype(int), [0]])))
    found: list[Plateau] = []
    for first, after in edges.reshape(-1, 2):
        last = int(after) - 1 + window
        level = float(np.median(current[(first + last) // 2 : last]))
        begin = int(first)
        if found and abs(level - found[-1].level) < APART * span:
            begin = found.pop().first
        found.append(Plateau(begin, last, level))
    return found


def _onset(current: Array, before: Plateau, after: Plateau, commanded: bool) -> float:
    covered = (current - before.level) / (after.level - before.level)
    start = max(before.first, min(before.last, after.first) - 1)
    half = start + int(np.argmax(covered[start : after.last] >= 0.5))
    low = half
    while low > before.first and covered[low - 1] > LEFT:
        low -= 1
    if commanded or low == 0 or covered[low] == covered[low - 1]:
        return float(low)
    return low - 1 + float(np.clip((LEFT - covered[low - 1]) / (covered[low] - covered[low - 1]), 0.0, 1.0))
