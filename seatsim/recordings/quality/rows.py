"""Rows that were doubled or lost, and what is not recorded: seen in the channels, where no column of time tells."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from seatsim.recordings.quality.damage import ALONE, AROUND
from seatsim.recordings.quality.issue import Issue, Severity, issue_in_all_runs
from seatsim.recordings.quality.run_under_test import LATE, MOTION, RunUnderTest
from seatsim.recordings.quality.shapes import measure_level
from seatsim.schema.arrays import Array

LEAST_FINE = 2
"""Channels with noise finer than their resolution from which on no two rows are alike by chance."""
LEAST_REPEATED = 4
"""Rows written twice from which on they are said: fewer shift no signal by more than a few milliseconds."""
BEYOND_CHANCE = 5.0
"""Ratio to the number of rows that channels repeat together by chance from which rows were written twice."""
NOISY = 1e-4
"""Noise as a share of the swing above which it is that of a sensor, and not of arithmetic."""
NOTHING = np.empty(0)
STEP = 16.0
"""A step of the travel over lost rows is so many times as large as what its steps usually differ by."""


def check_rows(run: RunUnderTest) -> Iterator[Issue]:
    """Report rows that are there twice, and steps of the travel that no inertia permits."""
    yield from _doubled(run)
    travel = "suspension_displacement" if "suspension_displacement" in run.table else "displacement"
    if travel in run.table:
        steps = find_steps(run.table[travel])
        if len(steps):
            text = (
                f"steps at {steps[0] / run.rate:.4g} s (row {steps[0] + 1}), where no inertia lets it; rows were lost"
            )
            more = f", and in {len(steps) - 1} more places" * (len(steps) > 1)
            yield run.issue("warning", "lost", f"{text} there{more}: cut the run there, or record anew", travel)


def _doubled(run: RunUnderTest) -> Iterator[Issue]:
    if sum(run.is_fine(channel) for channel in MOTION if channel in run.table) < LEAST_FINE:
        return
    again = find_repeated_rows(np.array([values for values in run.table.values() if np.ptp(values) > 0.0]))
    if len(again):
        severity: Severity = "warning" if len(again) / run.rate <= LATE else "error"
        text = f"{len(again)} rows hold in every channel what a row before holds, the first is row {again[0] + 1}"
        yield run.issue(severity, "doubled", f"{text}; they were written twice: remove them")


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
    for distance in distances[counts >= np.maximum(distances, LEAST_REPEATED)]:
        equal, by_chance = (marks[lag:] == marks[:-lag] for lag in (distance, distance + 1))
        alone = (values[:, distance:] == values[:, :-distance]) & ~equal
        together = np.sum(np.prod(uniform_filter1d(alone.astype(float), AROUND, axis=1), axis=0))
        if np.sum(equal) >= LEAST_REPEATED + 2 * np.sum(by_chance) + BEYOND_CHANCE * together:
            ends = np.flatnonzero(np.diff(np.concatenate([[False], equal, [False]])))
            blocks = zip(ends[::2], ends[1::2], strict=True)
            rows = [np.arange(first, end) + distance for first, end in blocks if end - first >= distance]
            found += rows if sum(map(len, rows)) >= LEAST_REPEATED else []
    return np.unique(np.concatenate(found))


def find_steps(values: Array) -> Array:
    """Return the rows after which values step by far more than the steps before and after let expect."""
    steps = np.diff(values)
    if len(steps) < 3:
        return np.empty(0)
    excess = np.abs(steps[1:-1] - 0.5 * (steps[:-2] + steps[2:]))
    usual = 1.4826 * float(np.median(excess)) + 1e-9 * float(np.ptp(values))
    rows = np.flatnonzero(excess > STEP * usual)
    return np.array([row + 1 for row in rows if _stands_alone(excess, steps, int(row))])


def _stands_alone(excess: Array, steps: Array, row: int) -> bool:
    """Say whether one step is alone: the steps beside it agree, and nothing near differs nearly as much."""
    before, at, after = steps[row : row + 3]
    agree = abs(after - before) < 0.3 * min(abs(at - before), abs(at - after))
    near = np.concatenate([excess[max(0, row - AROUND) : max(0, row - 1)], excess[row + 2 : row + AROUND]])
    return bool(agree and excess[row] > ALONE * float(np.max(near, initial=0.0)))


def check_stated(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    """Report that nothing states the current, or that no noise is stated of any channel."""
    recording, nominal = runs[0].recording, runs[0].nominal
    source = nominal.source
    stated = source.data.get("controller") if source else None
    if (
        recording.header.rig == "seat"
        and not {"current_command", "coil_current"} & set(recording.channels)
        and isinstance(stated, dict)
        and stated.get("law") == "replay"
        and "current" not in stated
    ):
        text = "neither current_command nor coil_current is recorded, and the nominal scenario states no current"
        yield issue_in_all_runs(
            "warning", "current", f"{text}; 0 A is taken: write controller.current", "current_command"
        )
    command = [run.table.get("current_command", NOTHING) for run in runs]
    flowing = [run.table.get("coil_current", NOTHING) for run in runs]
    if (
        any(each.size for each in command)
        and not any(map(np.any, command))
        and any(each.size and np.ptp(each) > 0.0 for each in flowing)
    ):
        text = "is 0 throughout while coil_current changes; log the command, or remove the channel"
        yield issue_in_all_runs("warning", "current", text, "current_command")
    channel = next((name for name in MOTION if name in recording.channels), "")
    seen = measure_level(runs[0].table[channel], runs[0].rate).fourth if channel else 0.0
    is_noisy = NOISY * np.std(runs[0].table[channel]) < seen < np.inf if channel else False
    if is_noisy and not any(entry.noise_rms for entry in recording.channels.values()):
        text = "no noise_rms is stated, of this channel or any other"
        yield issue_in_all_runs("note", "noise", f"{text}; thresholds hang on it: state that of each sensor", channel)
