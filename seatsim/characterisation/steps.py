"""Steps of a current, and the response times that measured records show while the motion goes on."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from seatsim.recordings.bench_tables import BenchRecord
from seatsim.schema.arrays import Array

LEAST_RANGE = 0.02
"""A; a current that varies less is constant."""
_FLAT = 0.02
"""Standard deviation, over the range of the current, within a window at rest."""
_WINDOW = 0.004
"""Seconds of the window in which a current has to rest, five rows at least."""
_APART = 0.1
"""Difference of two levels over the range of the current that makes a step."""
_LEFT = 0.05
"""Share of a step that has been covered where it begins."""
_TO_DEVIATION = 0.6745 * 6.0**0.5
"""Median magnitude of the second differences of white noise over its standard deviation."""


class _Plateau(NamedTuple):
    """Rows `first` to `last` (excluded) of a current that rests at a level in A."""

    first: int
    last: int
    level: float


class _CurrentStep(NamedTuple):
    """A step of current: the row (with fraction) at which it begins, and the levels before and after it."""

    row: float
    before: _Plateau
    after: _Plateau


def find_steps(current: Array, rate: float, commanded: bool) -> list[_CurrentStep]:
    """Return the steps of a current in A, shape (N,), at `rate` Hz, in their order.

    A step leads from one level at which the current rests to another. It begins at the row at which 5 % of it is
    covered: a command holds from its row on; between the rows of a measured current it is interpolated.
    """
    rests = find_plateaus(current, rate)
    return [_CurrentStep(_onset(current, a, b, commanded), a, b) for a, b in pairwise(rests)]


def find_plateaus(current: Array, rate: float) -> list[_Plateau]:
    """Return the stretches over which a current in A, shape (N,), at `rate` Hz rests, in their order.

    None where it varies by less than `LEAST_RANGE` in all. A current rests where its standard deviation within
    `_WINDOW` is small; the level is the median of the later half, neighbours of the same level are one.
    """
    span = float(np.ptp(current))
    window = max(5, round(_WINDOW * rate))
    if span < LEAST_RANGE or len(current) < 4 * window:
        return []
    mean, square = (_average_windows((current - current[0]) ** power, window) for power in (1, 2))
    spread = np.sqrt(np.maximum(square - mean**2, 0.0))
    noise = float(np.median(np.abs(np.diff(current, 2)))) / _TO_DEVIATION
    flat = spread <= _FLAT * span + 2.0 * noise
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flat.astype(int), [0]])))
    found: list[_Plateau] = []
    for first, after in edges.reshape(-1, 2):
        last = int(after) - 1 + window
        level = float(np.median(current[(first + last) // 2 : last]))
        begin = int(first)
        if found and abs(level - found[-1].level) < _APART * span:
            begin = found.pop().first
        found.append(_Plateau(begin, last, level))
    return found


def _average_windows(values: Array, window: int) -> Array:
    """Return the mean of every window of so many rows."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray((total[window:] - total[:-window]) / window, dtype=float)


def _onset(current: Array, before: _Plateau, after: _Plateau, commanded: bool) -> float:
    covered = (current - before.level) / (after.level - before.level)
    start = max(before.first, min(before.last, after.first) - 1)
    half = start + int(np.argmax(covered[start : after.last] >= 0.5))
    low = half
    while low > before.first and covered[low - 1] > _LEFT:
        low -= 1
    if commanded or low == 0 or covered[low] == covered[low - 1]:
        return float(low)
    return low - 1 + float(np.clip((_LEFT - covered[low - 1]) / (covered[low] - covered[low - 1]), 0.0, 1.0))


_LONGEST, _SHORTEST = 0.5, 0.025
"""Most and least seconds after a step that are looked at."""
_LEAD = 0.015
"""Seconds before a step in which the current has to rest."""
_LEVEL_GRID = 0.1
"""Grid of levels, over the range of the current, by which steps are put into pairs."""
_SPEED_HELD = 0.1
"""Largest change of a speed that counts as constant, relative."""
_SLOWEST = 0.1
"""Least speed of a stretch at constant speed, over the record's largest."""
_SETTLED_BY = 0.1
"""Largest difference of the curve's last but one fifth from 1, for a response that has settled."""


class Response(NamedTuple):
    """How a force follows steps of the current between two levels, A.

    speed: of the motion, in m/s. direction: rebound, compression or both. time, share: the share of the change that is
    covered over the time in s from the step, shape (N,); None where the response cannot be determined, and then `note`
    says why. current_t10: time in which the current itself covers 10 %, where it was measured.
    """

    record: str
    before: float
    after: float
    note: str = ""
    speed: float = math.nan
    direction: str = "both"
    time: Array | None = None
    share: Array | None = None
    current_t10: float = math.nan

    @property
    def rises(self) -> bool:
        """Whether the current rises."""
        return self.after > self.before


class _Stretch(NamedTuple):
    """A step with the rows before and after it over which the speed is constant."""

    step: _CurrentStep
    before: int
    after: int


def measure_responses(record: BenchRecord) -> list[Response]:
    """Return the response of a record's force to the steps of its current, one for each pair of levels.

    It is determined from the steps at constant speed, where the force before and after the step is what stands there,
    less a spring over the stroke. A pair of levels without such a step has a note that says why.
    """
    steps = find_steps(record.current, record.rate, record.commanded)
    unit = _LEVEL_GRID * float(np.ptp(record.current))
    pairs: dict[tuple[int, int], list[_CurrentStep]] = {}
    for step in steps:
        pairs.setdefault((round(step.before.level / unit), round(step.after.level / unit)), []).append(step)
    return [_of_pair(record, chosen) for chosen in pairs.values()]


def _of_pair(record: BenchRecord, steps: Sequence[_CurrentStep]) -> Response:
    before, after = (float(np.median([p.level for p in ps])) for ps in zip(*(s[1:] for s in steps), strict=True))
    blank = Response(record.name, before, after)
    even = [found for step in steps if (found := _find_constant_speed(record, step)) is not None]
    answer = _estimate_response(record, even, blank)
    if record.commanded:
        return answer
    return answer._replace(current_t10=_time_of_current(record, steps))


def _find_constant_speed(record: BenchRecord, step: _CurrentStep) -> _Stretch | None:
    """Return the rows about a step over which the speed is constant, None where these are too few."""
    k, v = round(step.row), record.velocity
    here = float(np.median(v[max(0, k - 3) : k + 4]))
    if abs(here) < _SLOWEST * float(np.percentile(np.abs(v), 98)) or here == 0.0:
        return None
    uneven = np.abs(v - here) > _SPEED_HELD * abs(here)
    behind, ahead = np.flatnonzero(uneven[:k]), np.flatnonzero(uneven[k:])
    first = max(step.before.first, int(behind[-1]) + 1 if behind.size else 0)
    last = min(step.after.last, k + int(ahead[0]) if ahead.size else len(v), k + round(_LONGEST * record.rate))
    if k - first < max(5, _LEAD * record.rate) or last - k < max(10, _SHORTEST * record.rate):
        return None
    return _Stretch(step, k - first, last - k)


def _estimate_response(record: BenchRecord, found: Sequence[_Stretch], blank: Response) -> Response:
    """Return the response: the share of the new level that fits all steps best, at each instant.

        s(t) = sum (F - F_off) (F_on - F_off) / sum (F_on - F_off)^2

    over the steps, then counted from its mean before the step and to that of its end, so that a step that follows
    another before the force has settled does no harm to a first-order lag.
    """
    if not found:
        return blank._replace(note=f"the speed is not constant about a step for {1e3 * _SHORTEST:g} ms")
    after = int(np.median([each.after for each in found]))
    chosen = [each for each in found if each.after >= after]
    before = min(*(each.before for each in chosen), round(0.05 * record.rate))
    steps = [each.step for each in chosen]
    force, x = (_about(y, steps, before, after) for y in (record.force, record.displacement))
    force = force - _slope_at_rest(force, x, before, after // 5) * (x - x[:, before : before + 1])
    off = np.median(force[:, :before], axis=1, keepdims=True)
    wanted = np.median(force[:, -(after // 5) :], axis=1, keepdims=True) - off
    noise = float(np.mean(np.std(force[:, :before], axis=1)))
    speeds = [float(record.velocity[round(step.row)]) for step in steps]
    ways = {"rebound" if speed > 0.0 else "compression" for speed in speeds}
    way, speed = ways.pop() if len(ways) == 1 else "both", float(np.mean(np.abs(speeds)))
    blank = blank._replace(speed=speed, direction=way)
    if float(np.min(np.abs(wanted))) < 5.0 * noise:
        return blank._replace(note="the force changes by less than five times its noise")
    instants = np.array([round(step.row) - step.row for step in steps]) / record.rate
    time = (np.arange(force.shape[1]) - before) / record.rate + float(np.mean(instants))
    share = np.sum((force - off) * wanted, axis=0) / np.maximum(np.sum(wanted * wanted, axis=0), 1e-300)
    start, fifth = float(np.mean(share[time < 0.0])), max(1, len(time[time > 0.0]) // 5)
    span = float(np.mean(share[-fifth:])) - start
    curve = np.asarray((share - start) / max(span, 1e-300))
    if not abs(float(np.mean(curve[-2 * fifth : -fifth])) - 1.0) <= _SETTLED_BY:
        return blank._replace(note=f"the force has not settled within {1e3 * time[-1]:.0f} ms of a step")
    return blank._replace(time=time, share=curve)


def find_crossing(time: Array, share: Array, level: float) -> float:
    """Return the first instant from 0 on at which a curve reaches a level, interpolated; NaN where it never does."""
    after = np.flatnonzero((time >= 0.0) & (share >= level))
    if not after.size:
        return math.nan
    k = int(after[0])
    if k == 0 or share[k - 1] >= level or time[k - 1] < 0.0:
        return float(time[k])
    return float(np.interp(level, share[k - 1 : k + 1], time[k - 1 : k + 1]))


def _slope_at_rest(force: Array, x: Array, before: int, last: int) -> float:
    """Return the slope in N/m of the force over the stroke, as of a gas spring, while the current rests."""
    parts = [(y[:, rows] - np.mean(y[:, rows], axis=1, keepdims=True) for y in (force, x))
             for rows in (slice(before), slice(-last, None))]  # fmt: skip
    away, moved = (np.concatenate([each.ravel() for each in sides]) for sides in zip(*parts, strict=True))
    return float(away @ moved / (moved @ moved)) if np.any(moved) else 0.0


def _time_of_current(record: BenchRecord, steps: Sequence[_CurrentStep]) -> float:
    """Return the time in which the mean of the steps of a measured current covers 10 %."""
    usual = np.median([step.after.last - round(step.row) for step in steps])
    chosen = [step for step in steps if step.after.last - round(step.row) >= usual]
    rows = min(int(usual), round(_LONGEST * record.rate))
    before, after = (np.array([[rest.level] for rest in rests]) for rests in zip(*(s[1:] for s in chosen), strict=True))
    share = np.mean((_about(record.current, chosen, 0, rows) - before) / (after - before), axis=0)
    late = float(np.mean([round(step.row) - step.row for step in chosen]))
    time = np.asarray((np.arange(rows) + late) / record.rate, dtype=float)
    return find_crossing(time, share, 0.1)


def _about(values: Array, steps: Sequence[_CurrentStep], before: int, after: int) -> Array:
    return np.array([values[round(s.row) - before : round(s.row) + after] for s in steps])
