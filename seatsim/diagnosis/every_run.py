"""Every run under the rigs that were fitted without the held-out one: gaps, and what the augmented scenario leaves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.result import GapFigures, RunGaps
from seatsim.recordings.gap import compare_signals, loud_channels
from seatsim.recordings.model_error import ModelError, measure_model_error
from seatsim.recordings.replay import replay
from seatsim.scenario.scenario import Scenario

Array = NDArray[np.float64]


class ReplayedRun(NamedTuple):
    """A run: its recorded channels that are compared, and the same simulated with each of several scenarios."""

    name: str
    measured: dict[str, Array]
    simulated: list[dict[str, Array]]


def replay_runs(problem: DiagnosisProblem, scenarios: Sequence[Scenario]) -> list[ReplayedRun]:
    """Return every run, replayed with some scenarios on all cores."""
    jobs = [(scenario, run) for run in problem.runs for scenario in scenarios]
    found = list(problem.pool.map(lambda job: replay(job[0], problem.recording, job[1]), jobs))
    count = len(scenarios)
    return [
        ReplayedRun(run, found[k * count][0], [simulated for _, simulated in found[k * count : (k + 1) * count]])
        for k, run in enumerate(problem.runs)
    ]


def list_gaps(problem: DiagnosisProblem, runs: Sequence[ReplayedRun]) -> list[RunGaps]:
    """Return the gaps of every run with a channel above its noise, replayed as nominal, calibrated and augmented."""
    found = []
    for run in runs:
        names = loud_channels(problem.recording, run.measured)
        if names:
            measured = {name: run.measured[name] for name in names}
            gaps = [compare_signals(problem.recording, measured, simulated) for simulated in run.simulated]
            before, calibrated, after = (GapFigures(each.overall, each.channels) for each in gaps)
            floor = GapFigures(gaps[0].floor["overall"], gaps[0].floor["channels"])
            found.append(RunGaps(run.name, before, calibrated, after, floor, 1.0 - after.overall / before.overall))
    return found


def state_model_error(problem: DiagnosisProblem, runs: Sequence[ReplayedRun]) -> ModelError:
    """Return what the last scenario of each run leaves, by channel and frequency band."""
    noise = dict(zip(problem.channels, problem.noise.tolist(), strict=True))
    left = [(run.name, run.measured, run.simulated[-1]) for run in runs]
    return measure_model_error(left, noise, problem.rate, problem.settings.noise.highest_frequency)
