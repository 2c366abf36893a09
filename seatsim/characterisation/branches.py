"""Hysteresis in the current: the force at one current where it rises, against that where it falls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatsim.characterisation.response import LEAST_RANGE
from seatsim.characterisation.rows import Row, group_rows, has_same_motion
from seatsim.characterisation.sheet import CurrentHysteresis
from seatsim.schema.arrays import Array

_LEVELS = 24
"""Parts of the range of a current in each of which the cycles are averaged."""
_EDGE = 0.25
"""Part of a level by which its edges are moved: no ladder of fewer than 32 equal steps then has a step at an edge."""


def measure_current_hysteresis(rows: Sequence[Row]) -> list[CurrentHysteresis]:
    """Return the widths of records whose current rises and falls slowly, in a ramp or in steps, under one motion.

        width(i) = F_falling(i) - F_rising(i)

    of the force at the peak speed, each the mean over the cycles of a twenty-fourth of the range of the current, the
    falling one interpolated to the current of the rising one. Where the current turns both are one: no width is stated.
    """
    known = [row for row in rows if row.cycle_values and row.test]
    tests = group_rows(known, lambda a, b: (a.file, a.test) == (b.file, b.test) and has_same_motion(a, b))
    return [width for test in tests for width in _measure_test(test)]


def _measure_test(rows: Sequence[Row]) -> list[CurrentHysteresis]:
    current, force = (np.concatenate([(row.cycle_values or {})[name] for row in rows]) for name in ("current", "force"))
    span = float(np.ptp(current))
    if span < LEAST_RANGE:
        return []
    level = (current - np.min(current)) * _LEVELS / span
    ways, turns = _follow(level)
    branches = [_average(current[ways == way], force[ways == way], level[ways == way]) for way in (1.0, -1.0)]
    if not all(len(branch[0]) for branch in branches):
        return []
    (rising, pushed), (falling, pulled) = branches
    near = 0.5 * span / _LEVELS
    compared = (rising >= falling[0] - near) & (rising <= falling[-1] + near)
    compared &= np.min(np.abs(rising[:, None] - current[turns]), axis=1) > near
    pairs = zip(rising[compared], pushed[compared], np.interp(rising, falling, pulled)[compared], strict=True)
    speed = float(np.mean([row.peak_speed for row in rows]))
    found = (tuple(map(float, pair)) for pair in pairs)
    return [CurrentHysteresis(rows[0].test, i, speed, up, down, down - up) for i, up, down in found]


def _follow(level: Array) -> tuple[Array, list[int]]:
    """Return 1 for each cycle at which a current rises and -1 where it falls, and the cycles at which it turns.

    A change of less than one level is none.
    """
    ways, turns, farthest, way = np.zeros(len(level)), list[int](), 0, 0.0
    for k in range(len(level)):
        moved = level[k] - level[farthest]
        if way * moved > 0.0:
            farthest = k
        elif abs(moved) > 1.0:
            turns += [farthest] if way else []
            way = float(np.sign(moved))
            ways[farthest:k] = way
            farthest = k
        ways[k] = way
    return ways, turns


def _average(current: Array, force: Array, level: Array) -> tuple[Array, Array]:
    """Return the mean current and force of each level, in rising order."""
    _, place = np.unique(np.floor(level + _EDGE), return_inverse=True)
    count = np.bincount(place)
    return np.bincount(place, current) / count, np.bincount(place, force) / count
