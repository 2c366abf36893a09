"""Rows that were doubled or lost, and what is not recorded: seen in the channels, where no column of time tells."""

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from seatsim.recordings.quality.damage import find_spikes, is_fine, measure_level
from seatsim.recordings.quality.issue import LATE, Issue, RunUnderTest, Severity, issue_in_all_runs
from seatsim.recordings.quality.relations import filter_band, find_delay
from seatsim.recordings.quality.sensors import check_constants, check_noise
from seatsim.recordings.recording import CURRENTS, MOTION
from seatsim.recordings.replay import LEAST_ROWS, LEFT_OUT
from seatsim.rig.temperature import Thermal
from seatsim.schema.arrays import Array
from seatsim.schema.tables import numbers, read_table

_LEAST_FINE = 2
"""Channels with noise finer than their resolution from which on no two rows are alike by chance."""
_LEAST_REPEATED = 4
"""Rows written twice from which on they are said: fewer shift no signal by more than a few milliseconds."""
_BEYOND_CHANCE = 5.0
"""Ratio to the number of rows that channels repeat together by chance from which rows were written twice."""
_AROUND = 25
"""Rows about one over which chance is counted."""
_NOISY = 1e-4
"""Noise as a share of the swing above which it is that of a sensor, and not of arithmetic."""
_STEP = 16.0
"""A step of the travel over lost rows is so many times as large as what its steps usually differ by."""
_SLOWEST, _FASTEST = 10.0, 200_000.0
"""Hz; rates of loggers of vibration lie between: below, nothing of a seat's resonances is left."""
_SHORTEST, _SHORT = 4.0, 10.0
"""s; compared time of all runs together below which nothing can be diagnosed, or not well."""


def check_rows(run: RunUnderTest) -> Iterator[Issue]:
    """Report rows that are there twice, and steps of the travel that no inertia permits."""
    yield from _doubled(run)
    travel = "suspension_displacement" if "suspension_displacement" in run.table else "displacement"
    if travel in run.table:
        steps = find_spikes(np.diff(run.table[travel]), _STEP)
        if len(steps):
            more = f", and in {len(steps) - 1} more places" * (len(steps) > 1)
            yield run.issue("steps_of_travel", travel, first=steps[0] / run.rate, row=steps[0] + 1, more=more)


def _doubled(run: RunUnderTest) -> Iterator[Issue]:
    if sum(is_fine(run, channel) for channel in MOTION if channel in run.table) < _LEAST_FINE:
        return
    again = find_repeated_rows(np.array([values for values in run.table.values() if np.ptp(values) > 0.0]))
    if len(again):
        severity: Severity = "warning" if len(again) / run.rate <= LATE else "error"
        yield run.issue("doubled", None, severity, rows=len(again), first=again[0] + 1)


def find_repeated_rows(channels: Array) -> NDArray[np.intp]:
    """Return the rows of blocks that follow themselves at once: single rows written twice, or a whole buffer.

    channels: shape (channels, N), or (N,). Equal rows far apart are no fault: a periodic motion measured with coarse
    converters has them by chance. So has a rig at rest, where rows equal the last but one as often as the last, and
    channels so coarse that each repeats itself often: they do so together as often as the product of their shares says.
    """
    values = np.atleast_2d(channels)
    # Equal rows have equal sums, and others differ, but for chances of one in 10^12.
    marks = np.random.default_rng(0).random(len(values)) @ (values / np.std(values, axis=1, keepdims=True))
    order = np.argsort(marks, kind="stable")
    distances, counts = np.unique(np.diff(order)[np.diff(marks[order]) == 0.0], return_counts=True)
    found = [np.empty(0, dtype=np.intp)]
    for distance in distances[counts >= np.maximum(distances, _LEAST_REPEATED)]:
        equal, by_chance = (marks[lag:] == marks[:-lag] for lag in (distance, distance + 1))
        alone = (values[:, distance:] == values[:, :-distance]) & ~equal
        together = np.sum(np.prod(uniform_filter1d(alone.astype(float), _AROUND, axis=1), axis=0))
        if np.sum(equal) >= _LEAST_REPEATED + 2 * np.sum(by_chance) + _BEYOND_CHANCE * together:
            ends = np.flatnonzero(np.diff(np.concatenate([[False], equal, [False]])))
            blocks = zip(ends[::2], ends[1::2], strict=True)
            rows = [np.arange(first, end) + distance for first, end in blocks if end - first >= distance]
            found += rows if sum(map(len, rows)) >= _LEAST_REPEATED else []
    return np.unique(np.concatenate(found))


def _check_stated(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    """Report that nothing states the current, or that no noise is stated of any channel."""
    recording, source = runs[0].recording, runs[0].nominal.source
    stated = source.data.get("controller") if source else None
    if (
        recording.header.rig == "seat"
        and set(CURRENTS).isdisjoint(recording.channels)
        and isinstance(stated, dict)
        and stated.get("law") == "replay"
        and "current" not in stated
    ):
        yield issue_in_all_runs("no_current", "current_command")
    command = [run.table["current_command"] for run in runs if "current_command" in run.table]
    flowing = [run.table["coil_current"] for run in runs if "coil_current" in run.table]
    if command and not any(map(np.any, command)) and any(np.ptp(each) > 0.0 for each in flowing):
        yield issue_in_all_runs("no_command", "current_command")
    channel = next((name for name in MOTION if name in recording.channels), "")
    seen = measure_level(runs[0].table[channel], runs[0].rate).fourth if channel else 0.0
    is_noisy = _NOISY * np.std(runs[0].table[channel]) < seen < np.inf if channel else False
    if is_noisy and not any(entry.noise_rms for entry in recording.channels.values()):
        yield issue_in_all_runs("no_noise_stated", channel)


def check_clock(run: RunUnderTest) -> Iterator[Issue]:
    """Compare the column `time` of a run, where there is one, with the stated sample rate."""
    path, interval = run.recording.folder / run.recording.runs[run.name].file, 1.0 / run.rate
    frame = read_table(path)
    if "time" not in frame:
        return
    time, _ = numbers(frame, "time")
    steps = np.diff(time) / interval
    is_even = np.abs(steps - 1.0) <= 0.75
    jumps = np.flatnonzero(~is_even)
    mean = float(np.mean(steps[is_even])) if is_even.any() else 0.0
    typical = float(np.median(steps))
    if not _SLOWEST <= run.rate <= _FASTEST:
        yield run.issue("no_logger", "time", apart=interval, rate=run.rate)
    elif not (abs(typical - 1.0) <= 0.3 and abs(mean - 1.0) <= 0.005):
        yield run.issue("other_rate", "time", apart=typical * interval, rate=run.rate, stated=interval)
    elif jumps.size:
        lost = float(np.sum(np.abs(steps[jumps] - 1.0))) * interval
        severity: Severity = "warning" if lost <= LATE else "error"
        yield run.issue("jumps", "time", severity, count=jumps.size, first=time[jumps[0]], line=jumps[0] + 3)


def check_all_runs(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    """Report faults that need all runs together."""
    for check in (_length, _duplicates, _repeats, _at_rest, check_noise, check_constants, _check_stated, _fahrenheit):
        yield from check(runs)


def _length(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    seconds = [run.rows / run.rate - LEFT_OUT for run in runs]
    for run, left in zip(runs, seconds, strict=True):
        if left * run.rate < LEAST_ROWS:
            yield run.issue("short_run", seconds=left + LEFT_OUT)
    total = sum(seconds)
    if total < _SHORT:
        severity: Severity = "warning" if total >= _SHORTEST else "error"
        yield issue_in_all_runs("short", None, severity, seconds=total, least=_SHORT)
    if len(runs) == 1:
        yield runs[0].issue("single")


def _duplicates(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    for first, second in itertools.combinations(runs, 2):
        rows = min(first.rows, second.rows)
        if np.mean([np.mean(first.table[c][:rows] == second.table[c][:rows]) for c in first.table]) > 0.9:
            yield second.issue("same_run", other=first.name)


def _repeats(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    """Report repeats whose excitation is another one, up to a shift of a second."""
    named = {run.name: run for run in runs}
    for run in runs:
        other = named.get(run.recording.runs[run.name].repeat_of or "")
        if other is not None:
            first, second = (filter_band(each, each.table[each.driver]) for each in (run, other))
            rows = min(len(first), len(second))
            if find_delay(first[:rows], second[:rows], round(run.rate))[1] <= 0.8:
                yield run.issue("no_repeat", other=other.name)


def _at_rest(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    still = [run for run in runs if run.is_still(run.driver)]
    resting: Severity = "error" if len(still) == len(runs) else "warning"
    for run in still:
        moving = [channel for channel in MOTION if channel in run.table and not run.is_still(channel)]
        if moving:
            yield run.issue("driver_still", run.driver, other=moving[0])
        else:
            yield run.issue("all_still", None, resting)


def _fahrenheit(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    """Report a lowest temperature that, read as degF, is the one that the nominal scenario states."""
    channel, nominal = "damper_temperature", runs[0].nominal.temperature
    stated = nominal.start if isinstance(nominal, Thermal) else nominal
    low = min((float(np.min(run.table[channel])) for run in runs if channel in run.table), default=stated)
    if abs(low - stated) > 20.0 and abs((low - 32.0) / 1.8 - stated) < 2.5:
        yield issue_in_all_runs("degF", channel, low=low, stated=stated)
