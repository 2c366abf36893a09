"""Faults of whole runs: their clock, their length, repetitions, and the noise and units stated for all."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from seatsim.recordings.compared import LEAST_ROWS, LEFT_OUT
from seatsim.recordings.quality.gravity import check_constants
from seatsim.recordings.quality.issue import Issue, Severity, issue_in_all_runs
from seatsim.recordings.quality.noise_level import check_noise
from seatsim.recordings.quality.residual import filter_band, find_delay
from seatsim.recordings.quality.rows import check_stated
from seatsim.recordings.quality.run_under_test import LATE, MOTION, RunUnderTest
from seatsim.rig.temperature import Thermal
from seatsim.schema.tables import numbers, read_table

SLOWEST, FASTEST = 10.0, 200_000.0
"""Hz; rates of loggers of vibration lie between: below, nothing of a seat's resonances is left."""
SHORTEST, SHORT = 4.0, 10.0
"""s; compared time of all runs together below which nothing can be diagnosed, or not well."""


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
    if not SLOWEST <= run.rate <= FASTEST:
        apart = f"rows are {interval:.5g} s apart, {run.rate:.5g} Hz, which no logger of a seat has"
        yield run.issue("error", "rate", f"{apart}; is the time in ms? state its unit and import again", "time")
    elif not (abs(typical - 1.0) <= 0.3 and abs(mean - 1.0) <= 0.005):
        apart = f"rows are {typical * interval:.5g} s apart where sample_rate {run.rate:g} means {interval:.5g} s"
        yield run.issue("error", "rate", f"{apart}; resample the run or correct the rate", "time")
    elif jumps.size:
        lost = float(np.sum(np.abs(steps[jumps] - 1.0))) * interval
        first = f"{jumps.size} jumps, the first at {time[jumps[0]]:.3f} s (line {jumps[0] + 3})"
        text = f"{first}; rows are missing: fill them or cut the run there"
        yield run.issue("warning" if lost <= LATE else "error", "jump", text, "time")


def check_all_runs(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    """Report faults that need all runs together."""
    for check in (_length, _duplicates, _repeats, _at_rest, check_noise, check_constants, check_stated, _fahrenheit):
        yield from check(runs)


def _length(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    seconds = [run.rows / run.rate - LEFT_OUT for run in runs]
    for run, left in zip(runs, seconds, strict=True):
        if left * run.rate < LEAST_ROWS:
            text = f"lasts {left + LEFT_OUT:.3g} s and its first second is left out; remove or record anew"
            yield run.issue("error", "short", text)
    total = sum(seconds)
    if total < SHORT:
        text = f"{total:.3g} s remain to compare, at least {SHORT:g} s are wanted; record more"
        yield issue_in_all_runs("warning" if total >= SHORTEST else "error", "short", text)
    if len(runs) == 1:
        text = "is the only run, so that no other excitation checks the verdict; record a second run"
        yield runs[0].issue("warning", "single", text)


def _duplicates(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    for first, second in itertools.combinations(runs, 2):
        rows = min(first.rows, second.rows)
        if np.mean([np.mean(first.table[c][:rows] == second.table[c][:rows]) for c in first.table]) > 0.9:
            text = f"holds the same rows as {first.name}, so that it checks nothing; remove one of them"
            yield second.issue("error", "duplicate", text)


def _repeats(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    named = {run.name: run for run in runs}
    for run in runs:
        other = run.recording.runs[run.name].repeat_of
        if other is not None and other in named and not _is_repeat(run, named[other]):
            yield run.issue("error", "repeat", f"is no repeat of {other}, their excitations differ; remove repeat_of")


def _is_repeat(run: RunUnderTest, other: RunUnderTest) -> bool:
    """Say whether two runs have the same excitation, up to a shift of a second."""
    first, second = (filter_band(r, r.table[r.driver]) for r in (run, other))
    rows = min(len(first), len(second))
    return find_delay(first[:rows], second[:rows], round(run.rate))[1] > 0.8


def _at_rest(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    still = [run for run in runs if run.is_still(run.driver)]
    resting: Severity = "error" if len(still) == len(runs) else "warning"
    for run in still:
        moving = [channel for channel in MOTION if channel in run.table and not run.is_still(channel)]
        if moving:
            text = f"does not move while {moving[0]} does; check its cable and its scale"
            yield run.issue("error", "still", text, run.driver)
        else:
            yield run.issue(resting, "still", "nothing moves by more than three times its stated noise; remove the run")


def _fahrenheit(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    """Report a lowest temperature that, read as degF, is the one that the nominal scenario states."""
    channel, nominal = "damper_temperature", runs[0].nominal.temperature
    stated = nominal.start if isinstance(nominal, Thermal) else nominal
    low = min((float(np.min(run.table[channel])) for run in runs if channel in run.table), default=stated)
    if abs(low - stated) > 20.0 and abs((low - 32.0) / 1.8 - stated) < 2.5:
        text = f"is never below {low:.3g} degC where the nominal scenario states {stated:g} degC"
        yield issue_in_all_runs("warning", "unit", f"{text}; if it is in degF, convert it", channel)
