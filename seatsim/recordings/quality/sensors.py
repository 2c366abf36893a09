"""Constants of accelerometers: gravity, which is taken out, and offsets, which are said.

What is shaken about a place has no mean acceleration: a sensor with a mean has an offset, and one whose mean is about
9.81 m/s^2, of either sign, reads gravity, which the equations of motion about static equilibrium do not hold. Left in,
the gravity of the floor's accelerometer would pull the simulated suspension down by decimetres.
"""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from seatsim.recordings.header import RunEntry
from seatsim.recordings.quality.damage import SILENT, Level, measure_level, quantum
from seatsim.recordings.quality.issue import Issue, RunUnderTest, Table, is_at_rest, issue_in_all_runs
from seatsim.recordings.recording import ACCELEROMETERS, Recording
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.units import STANDARD_GRAVITY

_NEAR_GRAVITY = 0.05
"""Share by which a mean may differ from gravity: tilt of the sensor, error of its scale, and its own offset."""
_OFFSET = 0.2
"""m/s^2; mean from which an offset is said: a motion of 24 s that has it ends at 5 m/s."""
_DISPLACED = 1.0
"""Mean over half the range from the 1st to the 99th percentile above which a channel hardly passes through zero."""
_ABOUT_ZERO = ("suspension_displacement", "displacement", "velocity", "damper_force")
"""Other channels that swing about zero, or not far from it."""
_NOISE_OFF = 3.0
"""Factor by which the noise may differ from what is stated."""
_WHITE = 0.9
"""Share of the level of third differences that fourth ones have at least where both are of white noise."""
_GROWS = 1.5
"""Ratio of the levels in the liveliest and the calmest fifth of windows above which it grows with the motion."""
_REPEATS = 0.67
"""Share of the level seen that the difference of two repeats has at most where what is seen repeats itself."""
FLOOR = "floor_acceleration"
"""Channel of the floor's accelerometer, whose error acts like a motion of the floor."""
_WINDOW, _FEWEST = 0.032, 6
"""Seconds over which a slope is fitted, and least rows."""
_STILL = 3.0
"""Stillness above which a sensor does not follow the floor; faultless ones have 0.9 to 2."""
_FINE = 32
"""Points between two rows at which slopes are taken, so that a sine is sampled at many phases."""
_FASTEST = 0.98
"""Share of rises below the one that has to stand out from the noise, lest the floor is too slow to tell."""
_NEAR_ZERO = 0.1
"""Share of its standard deviation within which a record is near zero."""
_BIN, _BESIDE = 7.0, 3
"""Width in noise of the bins in which values at an extreme, and in that many bins beside it, are counted."""
_LEAST = 1e-9
"""m/s^2 of noise that a record has at least."""
_PILED, _FEW = 5.0, 12
"""Ratio of rows at an extreme to rows in a bin beside it above which it is a limit, and least rows at a limit."""


def without_gravity(recording: Recording) -> Recording:
    """Return the recording whose tables have the mean of each accelerometer that reads gravity taken out.

    It states these constants in `removed`. A table that cannot be read is left to the examination.
    """
    try:
        tables = [recording.table(run) for run in recording.runs]
    except InputError:
        return recording
    recorded = [name for name in ACCELEROMETERS if name in recording.channels]
    means = {name: float(np.mean(np.concatenate([table[name] for table in tables]))) for name in recorded}
    found = {name: mean for name, mean in means.items() if abs(abs(mean) / STANDARD_GRAVITY - 1.0) <= _NEAR_GRAVITY}
    return dataclasses.replace(recording, removed=MappingProxyType(found)) if found else recording


def check_constants(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    """Say which accelerometers read gravity, which was taken out, and which channels have an offset."""
    for channel, mean in runs[0].recording.removed.items():
        yield issue_in_all_runs("gravity_removed", channel, mean=mean)
    for channel in (name for name in (*ACCELEROMETERS, *_ABOUT_ZERO) if name in runs[0].table):
        values, unit = np.concatenate([run.table[channel] for run in runs]), runs[0].recording.channels[channel].unit
        low, high = np.quantile(values, (0.01, 0.99))
        mean, swing = float(np.mean(values)), 0.5 * float(high - low)
        if channel in ACCELEROMETERS and abs(mean) > _OFFSET:
            yield issue_in_all_runs("accelerometer_offset", channel, mean=mean, unit=unit)
        elif channel not in ACCELEROMETERS and abs(mean) > _DISPLACED * swing > 0.0:
            yield issue_in_all_runs("zero_off", channel, mean=mean, unit=unit, share=abs(mean) / swing)


def check_noise(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    """Compare the stated noise with the least white noise seen in any run."""
    recording, tables = runs[0].recording, {run.name: run.table for run in runs}
    for channel, entry in recording.channels.items():
        stated = entry.noise_rms
        seen = min((measure_level(run.table[channel], run.rate) for run in runs), key=lambda level: level.fourth)
        if channel == "current_command" or stated == 0.0 or not 0.0 < seen.fourth < np.inf:
            continue
        repeated = _list_unrepeated(recording.runs, tables, channel)
        all_of = min((float(np.std(values)) for values in repeated), default=np.nan)
        is_too_small = seen.third > _NOISE_OFF * stated and seen.fourth > _WHITE * seen.third
        levels = (measure_level(values, runs[0].rate).fourth for values in repeated)
        reason = ""
        if is_too_small and seen.lively > _GROWS * seen.calm:
            reason = "grows with the motion"
        elif is_too_small and any(level < _REPEATS * seen.fourth for level in levels):
            reason = "comes again when the excitation is repeated"
        if reason:
            yield issue_in_all_runs("noise_of_motion", channel, stated=stated, seen=seen.fourth, reason=reason)
        elif is_too_small:
            yield issue_in_all_runs("more_noise", channel, stated=stated, seen=seen.fourth)
        elif all_of < stated / _NOISE_OFF:
            yield issue_in_all_runs("less_noise", channel, stated=stated, seen=all_of)
        elif seen.fourth < stated / _NOISE_OFF and not all_of >= stated / _NOISE_OFF:
            yield _less_is_seen(runs, channel, seen, stated)


def _less_is_seen(runs: Sequence[RunUnderTest], channel: str, seen: Level, stated: float) -> Issue:
    """Return what less noise at high frequencies than is stated means: nothing where a filter took it."""
    values = np.concatenate([run.table[channel] for run in runs])
    least = max(SILENT * 0.5 * float(np.ptp(values)), quantum(values) / 12**0.5)
    if seen.fourth < max(least, _WHITE * seen.third):
        return issue_in_all_runs("filtered", channel, stated=stated)
    return issue_in_all_runs("less_at_high_frequencies", channel, stated=stated, seen=seen.fourth)


def _list_unrepeated(entries: Mapping[str, RunEntry], tables: Mapping[str, Table], channel: str) -> list[Array]:
    """Return what does not come again of each pair of repeats: their difference over the root of 2, shape (N,)."""
    found = []
    for run, entry in entries.items():
        if entry.repeat_of is not None:
            first, second = (tables[name][channel] for name in (run, entry.repeat_of))
            rows = min(len(first), len(second))
            found.append((first[:rows] - second[:rows]) / np.sqrt(2.0))
    return found


def check_floor_sensor(run: RunUnderTest) -> Iterator[Issue]:
    """Report an accelerometer of the floor that stands still while the floor moves."""
    if FLOOR in run.table:
        for name, extreme in _faults(run.table[FLOOR], run.noise(FLOOR), run.rate):
            yield run.issue(name, FLOOR, extreme=extreme)


def follows_floor(recording: Recording) -> bool:
    """Say whether the accelerometer of the floor follows it in every run."""
    noise, rate = recording.channels[FLOOR].noise_rms, recording.header.sample_rate
    return not any(_faults(recording.table(run)[FLOOR], noise, rate) for run in recording.runs)


def _faults(values: Array, noise: float, rate: float) -> list[tuple[str, float]]:
    """Return the findings of a record, each with the extreme that it is at; nothing where the floor is at rest."""
    noise = max(noise, _LEAST)
    if is_at_rest(values, noise):
        return []
    if _stillness(values, noise, max(_FEWEST, round(_WINDOW * rate))) > _STILL:
        return [("steps", np.nan)]
    return [("limit", extreme) for extreme in _limits(values, noise)]


def _limits(values: Array, noise: float) -> list[float]:
    """Return the extremes that values pile up at."""
    piled = []
    for sign in (1.0, -1.0):
        extreme = float(np.max(sign * values))
        edges = extreme - _BIN * noise * np.arange(_BESIDE + 1, -1, -1)
        *beside, at = np.histogram(sign * values, edges)[0]
        if at >= max(_FEW, _PILED * np.mean(beside)):
            piled.append(sign * extreme)
    return piled


def _stillness(values: Array, noise: float, rows: int) -> float:
    time = np.arange(rows) - (rows - 1) / 2.0
    windows = sliding_window_view(values, rows)
    rises = windows @ time * rows / (time @ time)
    between = np.linspace(0.0, len(rises) - 1.0, _FINE * len(rises))
    means, room = windows.mean(axis=1), _BIN * noise
    within = (means > np.min(values) + room) & (means < np.max(values) - room)
    counted = np.repeat(within & (np.abs(means) > _NEAR_ZERO * np.std(values)), _FINE)
    unit = 2.0 * noise * np.sqrt(12.0 / rows)
    if np.quantile(np.abs(rises), _FASTEST) < 3.0 * unit:
        return 0.0
    size = np.abs(np.interp(between, np.arange(len(rises)), rises))[counted]
    still, beside = np.sum(size < unit), np.sum((size >= unit) & (size < 3.0 * unit))
    return float(2.0 * still / max(beside, _FINE))
