"""From the rows and responses of a damper to the tables of its bench day."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from seatsim.characterisation import sheet
from seatsim.characterisation.rows import WARMER, WINDOW, Row, group_rows, has_same_motion, is_alike, measure_forces
from seatsim.characterisation.steps import Response, find_crossing
from seatsim.metrics.motion import ratio
from seatsim.schema.arrays import Array
from seatsim.simulation.damper_bench import SineTest

_SAME_CURRENT, _SMALLEST_CURRENT = 0.02, 0.005
"""Relative difference, and difference in A, of currents that are the same."""
_FAR = 0.4
"""Largest distance from mid-stroke, over the stroke, at which reversals are far."""
_MANY = 20
"""Least cycles of a record that shows a fade by itself."""
_SETTLED = 0.05
"""Half width of the band, over the change of force, within which a response has settled."""


def make_sheet(rows: Sequence[Row], responses: Iterable[Response], window: float = WINDOW) -> sheet.BenchSheet:
    """Return the tables of a damper's rows and responses.

    With F+ and F- the means of the force in rebound and compression over `window` of the stroke about its middle,

        gas force = (F+ + F-) / 2,         friction = (F+ - F-) / 2                         of the slowest test,
        dynamic range = F_hard / F_soft,   linearity = (F - F_soft) / (F_hard - F_soft)     at one speed

    Rows of one current, temperature, amplitude and frequency are repeats. A fade is a straight line over temperatures.
    """
    steady = [row for row in rows if row.loop is not None and not row.ramps]
    groups = sorted(
        group_rows(steady, _is_repeat),
        key=lambda group: (group[0].temperature, round(group[0].peak_speed, 3), group[0].current),
    )
    peaks = [_measure_peak(group, window) for group in groups]
    slow = [min(alike, key=lambda pair: pair[1].speed) for alike in group_rows(zip(groups, peaks, strict=True), _slow)]
    families = group_rows(peaks, lambda a, b: is_alike(a.speed, b.speed) and _as_warm(a.temperature, b.temperature))
    ladders = [family for family in families if len(family) > 1]
    return sheet.BenchSheet(
        peak_forces=peaks,
        response=[_describe_step(each) for each in responses if each.time is not None and each.share is not None],
        gas_force=[_measure_gas(group, peak) for group, peak in slow],
        friction=[sheet.Friction(*peak[:3], _size(peak)) for _, peak in slow],
        dynamic_range=[_divide(peak, ladder[0]) for ladder in ladders for peak in ladder[-1:]],
        linearity=[_place(peak, ladder[0], ladder[-1]) for ladder in ladders for peak in ladder],
        hysteresis=[_measure_hysteresis(group, peak) for group, peak in zip(groups, peaks, strict=True)],
        energy=[_measure_energy(group) for group in groups],
        fade=[*_measure_fade(peaks), *(fade for row in steady for fade in _measure_warming(row))],
    )


def _measure_peak(rows: Sequence[Row], window: float) -> sheet.PeakForce:
    """Return the force at the peak speed of rows that are repeats, each with a loop."""
    forces = np.array([measure_forces(row.loop, window) for row in rows if row.loop is not None])
    rebound, compression = map(float, np.mean(forces, axis=0))
    spread = float(np.max(np.std(forces, axis=0, ddof=1))) if len(rows) > 1 else math.nan
    current, temperature, speed = (_average_of(rows, name) for name in ("current", "temperature", "peak_speed"))
    return sheet.PeakForce(current, temperature, speed, rebound, compression, len(rows), spread)


def _measure_gas(rows: Sequence[Row], peak: sheet.PeakForce) -> sheet.SlowForce:
    """Return the gas force of slow tests, with its slope where reversals are far: what both directions share there."""
    stiffness = float(np.mean([_measure_slope(row.loop) for row in rows if row.loop is not None]))
    return sheet.SlowForce(*peak[:3], 0.5 * (peak.rebound + peak.compression), stiffness)


def _measure_slope(loop: SineTest) -> float:
    """Return the slope over the stroke of the mean of both directions, at the same places of either."""
    x, order = loop.displacement, np.argsort(loop.displacement)
    half = _FAR * float(np.ptp(x))
    grid = 0.5 * (np.max(x) + np.min(x)) + np.linspace(-half, half, len(x) // 2)
    ways = (order[sign * loop.velocity[order] > 0.0] for sign in (1.0, -1.0))
    both = np.mean([np.interp(grid, x[way], loop.force[way]) for way in ways], axis=0)
    return float(np.polyfit(grid - grid[0], both, 1)[0])


def _forces(peak: sheet.PeakForce) -> tuple[float, float, float]:
    """Return the force of either direction, and half their difference."""
    return peak.rebound, peak.compression, _size(peak)


def _divide(peak: sheet.PeakForce, soft: sheet.PeakForce) -> sheet.Share:
    return sheet.Share(*peak[:3], *map(ratio, _forces(peak), _forces(soft)))


def _place(peak: sheet.PeakForce, soft: sheet.PeakForce, hard: sheet.PeakForce) -> sheet.Share:
    forces = zip(_forces(peak), _forces(soft), _forces(hard), strict=True)
    return sheet.Share(*peak[:3], *(ratio(force - low, high - low) for force, low, high in forces))


def _measure_hysteresis(rows: Sequence[Row], peak: sheet.PeakForce) -> sheet.Hysteresis:
    loops = [row.loop for row in rows if row.loop is not None]
    widths = [np.mean([_measure_width(loop, share) for loop in loops]) for share in (0.0, 0.5)]
    return sheet.Hysteresis(*peak[:3], *map(float, widths))


def _measure_width(loop: SineTest, share: float) -> float:
    """Return the largest difference of the forces at which the velocity passes a share of its peak, up and down."""
    v, force = loop.velocity[:-1], loop.force[:-1]
    widths = []
    for level in {share * float(np.max(v)), share * float(np.min(v))}:
        away = v - level
        k = np.flatnonzero(np.signbit(away) != np.signbit(np.roll(away, -1)))
        part = away[k] / (away[k] - np.roll(away, -1)[k])
        passed = force[k] + part * (np.roll(force, -1)[k] - force[k])
        widths.append(float(np.ptp(passed)) if len(k) > 1 else math.nan)
    return max(widths)


def _measure_energy(rows: Sequence[Row]) -> sheet.CycleEnergy:
    names = ("current", "temperature", "amplitude", "frequency", "peak_speed", "energy", "damping", "asymmetry")
    return sheet.CycleEnergy(*(_average_of(rows, name) for name in names))


def _measure_fade(peaks: Sequence[sheet.PeakForce]) -> list[sheet.Fade]:
    found = []
    for family in group_rows(peaks, lambda a, b: is_alike(a.speed, b.speed) and _same_current(a.current, b.current)):
        warmth, force = (np.array(part) for part in zip(*((p.temperature, _size(p)) for p in family), strict=True))
        if len(family) > 1 and np.ptp(warmth) >= WARMER:
            low, high = float(np.min(warmth)), float(np.max(warmth))
            found.append(sheet.Fade(family[0].current, family[0].speed, low, high, _find_slope(warmth, force)))
    return found


def _measure_warming(row: Row) -> list[sheet.Fade]:
    """Return the fade of a record of many cycles, where it warms in them."""
    values = row.cycle_values or {}
    if len(values.get("force", [])) < _MANY or not row.temperature_range >= WARMER:
        return []
    warmth, force = np.array(values["temperature"]), np.array(values["force"])
    low, high = float(np.min(warmth)), float(np.max(warmth))
    return [sheet.Fade(row.current, row.peak_speed, low, high, _find_slope(warmth, force), row.record)]


def _find_slope(cause: Array, force: Array) -> float:
    """Return the slope of a straight line over its value at the least cause."""
    slope, start = np.polyfit(cause - np.min(cause), force, 1)
    return float(slope / start)


def _size(peak: sheet.PeakForce) -> float:
    """Return half the difference of both directions, which has no gas force."""
    return 0.5 * (peak.rebound - peak.compression)


def _describe_step(found: Response) -> sheet.StepResponse:
    assert found.time is not None and found.share is not None
    start = found.current_t10 if math.isfinite(found.current_t10) else 0.0
    share = found.share
    t5, t10, t63, t90 = (
        find_crossing(found.time, share, level) - start for level in (0.05, 0.1, 1.0 - math.exp(-1.0), 0.9)
    )
    again = _find_last(found.time, share < 0.9) - start
    return sheet.StepResponse(
        found.before, found.after, found.speed, found.direction, t5, t10, t63, t90,
        settling=_find_last(found.time, np.abs(share - 1.0) > _SETTLED) - start,
        recovery=max(again - t90, 0.0), overshoot=max(float(np.max(share)) - 1.0, 0.0),
    )  # fmt: skip


def _find_last(time: Array, outside: NDArray[np.bool_]) -> float:
    """Return the instant from which on a curve is no longer outside."""
    rows = np.flatnonzero(outside)
    return float(time[min(int(rows[-1]) + 1, len(time) - 1)]) if rows.size else math.nan


def _is_repeat(a: Row, b: Row) -> bool:
    return has_same_motion(a, b) and _same_current(a.current, b.current) and _as_warm(a.temperature, b.temperature)


def _slow(a: tuple[Sequence[Row], sheet.PeakForce], b: tuple[Sequence[Row], sheet.PeakForce]) -> bool:
    return _same_current(a[1].current, b[1].current) and _as_warm(a[1].temperature, b[1].temperature)


def _same_current(a: float, b: float) -> bool:
    return abs(a - b) <= max(_SAME_CURRENT * abs(a), _SMALLEST_CURRENT)


def _as_warm(a: float, b: float) -> bool:
    return not abs(a - b) >= WARMER


def _average_of(rows: Sequence[Row], name: str) -> float:
    return float(np.mean([getattr(row, name) for row in rows]))
