"""Steps of a current, and the response times that measured records show while the motion goes on."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from seatsim.characterisation.response import LEAST_RANGE, Response, StepEnsemble, estimate_response, find_crossing
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.schema.arrays import Array

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


_LONGEST = 0.5
"""Seconds after a step that are looked at."""
_LENGTHS = (_LONGEST, 0.3, 0.2, 0.12, 0.08, 0.05, 0.04, 0.025)
"""Seconds after a step that are tried, the longest with enough steps first."""
_ENOUGH = 12
"""Steps that are wanted for the longest of the lengths."""
_LEAD = 0.015
"""Seconds before a step in which the current has to rest."""
_SAME_LEVEL = 0.05
"""Difference of two levels of a current, over its range, up to which they are the same."""
_LEVEL_GRID = 0.1
"""Grid of levels, over the range of the current, by which steps are put into pairs."""
_SPEED_HELD = 0.1
"""Largest change of a speed that counts as constant, relative."""
_SLOWEST = 0.1
"""Least speed of a stretch at constant speed, over the record's largest."""
_SETTLING = 0.03
"""Seconds after a step from which on, at the earliest, the force counts as settled."""
_SMOOTHING = 0.001
"""Seconds over which a demodulated response is smoothed."""
_KNEES = (0.05, 0.2, 0.6)
"""Speeds over the RMS speed at which the steady force may bend."""
_LAGS = (0.0, 0.002, 0.005, 0.01)
"""Seconds by which the steady force may lag behind the velocity."""
_UNSURE = 0.1
"""Largest error of the steady forces, over their difference and over the root of the number of steps."""


def measure_responses(record: BenchRecord) -> list[Response]:
    """Return the response of a record's force to the steps of its current, one for each pair of levels.

    At constant speed the force before and after the step is what stands there, less a spring over the stroke. Where the
    speed varies, the steady force at either level is a least-squares fit to the settled rows,

        F_level = sum c_k f_k,  f = 1, x, v, dv/dt, tanh(v(t - lag) / (q v_rms)),

    and the response is demodulated by it (`estimate_response`). A pair of levels that allows neither has a note that
    says why.
    """
    steps = find_steps(record.current, record.rate, record.commanded)
    if not steps:
        return []
    unit = _LEVEL_GRID * float(np.ptp(record.current))
    pairs: dict[tuple[int, int], list[_CurrentStep]] = {}
    for step in steps:
        pairs.setdefault((round(step.before.level / unit), round(step.after.level / unit)), []).append(step)
    return [_of_pair(record, chosen, steps) for chosen in pairs.values()]


def _of_pair(record: BenchRecord, steps: Sequence[_CurrentStep], every: Sequence[_CurrentStep]) -> Response:
    before, after = (float(np.median([p.level for p in ps])) for ps in zip(*(s[1:] for s in steps), strict=True))
    blank = Response(record.name, before, after, len(steps), "")
    # A constant speed needs no model of the steady force, so it counts first where half of the steps have one.
    even = [found for step in steps if (found := _constant_speed_rows(record, step)) is not None]
    answer = _at_constant_speed(record, even, blank) if 2 * len(even) >= len(steps) else blank
    if not answer.method:
        answer = _demodulated(record, steps, every, answer)
    if not answer.method and 0 < 2 * len(even) < len(steps):
        answer = _at_constant_speed(record, even, blank)
    if record.commanded:
        return answer
    t10, t95, overshoot = _of_current(record, steps)
    return answer._replace(current_t10=t10, current_t95=t95, current_overshoot=overshoot)


def _constant_speed_rows(record: BenchRecord, step: _CurrentStep) -> tuple[_CurrentStep, int, int] | None:
    """Return the rows before and after a step over which the speed is constant, None where these are too few."""
    k, v = round(step.row), record.velocity
    here = float(np.median(v[max(0, k - 3) : k + 4]))
    if abs(here) < _SLOWEST * float(np.percentile(np.abs(v), 98)) or here == 0.0:
        return None
    uneven = np.abs(v - here) > _SPEED_HELD * abs(here)
    behind, ahead = np.flatnonzero(uneven[:k]), np.flatnonzero(uneven[k:])
    first = max(step.before.first, int(behind[-1]) + 1 if behind.size else 0)
    last = min(step.after.last, k + int(ahead[0]) if ahead.size else len(v), k + round(_LONGEST * record.rate))
    if k - first < max(5, _LEAD * record.rate) or last - k < max(10, _LENGTHS[-1] * record.rate):
        return None
    return step, k - first, last - k


def _at_constant_speed(
    record: BenchRecord, found: Sequence[tuple[_CurrentStep, int, int]], blank: Response
) -> Response:
    after = int(np.median([length for *_, length in found]))
    chosen = [one for one in found if one[2] >= after]
    before = min(*(one[1] for one in chosen), round(0.05 * record.rate))
    force, x = (_about(y, [step for step, *_ in chosen], before, after) for y in (record.force, record.displacement))
    force = force - _slope_at_rest(force, x, before, after // 5) * (x - x[:, before : before + 1])
    off = np.median(force[:, :before], axis=1, keepdims=True)
    on = np.median(force[:, -(after // 5) :], axis=1, keepdims=True)
    noise = float(np.mean(np.std(force[:, :before], axis=1)))
    speeds = [float(record.velocity[round(step.row)]) for step, *_ in chosen]
    ways = {"rebound" if speed > 0.0 else "compression" for speed in speeds}
    way, speed = ways.pop() if len(ways) == 1 else "both", float(np.mean(np.abs(speeds)))
    blank = blank._replace(steps=len(chosen), method="constant speed", speed=speed, direction=way)
    if float(np.min(np.abs(on - off))) < 5.0 * noise:
        return blank._replace(method="", note="the force changes by less than five times its noise")
    levels = np.broadcast_to(off, force.shape), np.broadcast_to(on, force.shape)
    instants = np.array([round(step.row) - step.row for step, *_ in chosen]) / record.rate
    return estimate_response(StepEnsemble(force, *levels, instants, before, record.rate), blank)


def _slope_at_rest(force: Array, x: Array, before: int, last: int) -> float:
    """Return the slope in N/m of the force over the stroke, as of a gas spring, while the current rests."""
    parts = [(y[:, rows] - np.mean(y[:, rows], axis=1, keepdims=True) for y in (force, x))
             for rows in (slice(before), slice(-last, None))]  # fmt: skip
    away, moved = (np.concatenate([each.ravel() for each in sides]) for sides in zip(*parts, strict=True))
    return float(away @ moved / (moved @ moved)) if np.any(moved) else 0.0


def _demodulated(
    record: BenchRecord, steps: Sequence[_CurrentStep], every: Sequence[_CurrentStep], blank: Response
) -> Response:
    rate = record.rate
    led = [s for s in steps if s.row - s.before.first >= _LEAD * rate]
    lengths = [s.after.last - s.row for s in led]
    after = next((n for n in _LENGTHS if sum(m >= n * rate for m in lengths) >= min(_ENOUGH, max(1, len(led)))), 0.0)
    chosen = [step for step, length in zip(led, lengths, strict=True) if length >= after * rate]
    if not after or not chosen:
        return blank._replace(note=f"the current never rests for {1e3 * _LENGTHS[-1]:g} ms after a step")
    basis = _basis(record)
    steady = [_steady(record, basis, every, level) for level in (blank.before, blank.after)]
    if any(fit is None for fit in steady):
        return blank._replace(note="too few settled rows at one of the currents to know its steady force")
    (off, error_off), (on, error_on) = (fit for fit in steady if fit is not None)
    before, rows = max(2, round(0.005 * rate)), int(after * rate) - 1
    force, off, on = (_about(y, chosen, before, rows) for y in (record.force, off, on))
    apart = math.sqrt(float(np.mean((on - off) ** 2)))
    blank = blank._replace(steps=len(chosen), method="demodulated")
    if max(error_off, error_on) > _UNSURE * apart * math.sqrt(len(chosen)):
        return blank._replace(method="", note="the speed varies, and the steady forces are not known well enough")
    window = max(3, 2 * round(0.5 * _SMOOTHING * rate) + 1)
    instants = np.array([round(step.row) - step.row for step in chosen]) / rate
    return estimate_response(StepEnsemble(force, off, on, instants, before, rate), blank, window)


def _basis(record: BenchRecord) -> Array:
    v = record.velocity
    parts = [np.ones(len(v)), record.displacement, v, np.gradient(v) * record.rate]
    knees = np.array(_KNEES) * max(float(np.sqrt(np.mean(v**2))), 1e-12)
    parts += [np.tanh(np.roll(v, round(lag * record.rate)) / knee) for lag in _LAGS for knee in knees]
    basis = np.column_stack(parts)
    size: Array = np.sqrt(np.mean(basis**2, axis=0))
    return basis / np.maximum(size, 1e-12)


def _steady(
    record: BenchRecord, basis: Array, every: Sequence[_CurrentStep], level: float
) -> tuple[Array, float] | None:
    """Return the steady force at a level, shape (N,), and its RMS error over the settled rows."""
    near = _SAME_LEVEL * float(np.ptp(record.current))
    settled = np.zeros(len(basis), dtype=bool)
    for step in every:
        rest = step.after
        if abs(rest.level - level) <= near:
            settled[int(step.row + max(_SETTLING * record.rate, 0.5 * (rest.last - step.row))) : rest.last] = True
        if abs(step.before.level - level) <= near and step.before.first == 0:
            settled[step.before.last // 2 : step.before.last] = True
    if np.count_nonzero(settled) < 10 * basis.shape[1]:
        return None
    # Terms that this motion does not tell apart are dropped, not given huge weights of opposite signs.
    weights, *_ = np.linalg.lstsq(basis[settled], record.force[settled], rcond=1e-8)
    force = basis @ weights
    return force, math.sqrt(float(np.mean((record.force - force)[settled] ** 2)))


def _of_current(record: BenchRecord, steps: Sequence[_CurrentStep]) -> tuple[float, float, float]:
    """Return the times in which the mean of the steps of a measured current covers 10 and 95 %, and its overshoot."""
    usual = np.median([step.after.last - round(step.row) for step in steps])
    chosen = [step for step in steps if step.after.last - round(step.row) >= usual]
    rows = min(int(usual), round(_LONGEST * record.rate))
    before, after = (np.array([[rest.level] for rest in rests]) for rests in zip(*(s[1:] for s in chosen), strict=True))
    share = np.mean((_about(record.current, chosen, 0, rows) - before) / (after - before), axis=0)
    late = float(np.mean([round(step.row) - step.row for step in chosen]))
    time = np.asarray((np.arange(rows) + late) / record.rate, dtype=float)
    t10, t95 = (find_crossing(time, share, level) for level in (0.1, 0.95))
    return t10, t95, max(float(np.max(share)) - 1.0, 0.0)


def _about(values: Array, steps: Sequence[_CurrentStep], before: int, after: int) -> Array:
    return np.array([values[round(s.row) - before : round(s.row) + after] for s in steps])
