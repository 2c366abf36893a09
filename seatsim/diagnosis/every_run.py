"""Every run under the rigs that were fitted without the held-out one: gaps, their shrink, what the last rig leaves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.result import Gaps, RunGaps
from seatsim.recordings.gap import GapFigures, Signals, compare_signals, loud_channels
from seatsim.recordings.model_error import ModelError, measure_model_error
from seatsim.recordings.replay import replay
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError


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
    return [_measure_run(problem, run) for run in runs if loud_channels(problem.recording, run.measured)]


def measure_gaps(problem: DiagnosisProblem, run: ReplayedRun, spread: float) -> Gaps:
    """Return the gaps of the nominal, the calibrated and the augmented scenario on a run held out of the fits.

    Args:
        problem: the recording.
        run: the run, replayed with the three.
        spread: standard deviation of the shrink from run to run.

    Raises:
        InputError: no channel of the run stands above its noise.
    """
    names = loud_channels(problem.recording, run.measured)
    if not names:
        where = f"{problem.recording.folder}, run {run.name}"
        raise InputError(f"{where}: no recorded output stands above its noise; there is nothing to compare")
    found, loud = _measure_run(problem, run), {name: run.measured[name] for name in names}
    # A scenario left as it is shrinks no gap, on whatever data.
    interval = _bootstrap_shrink(problem, loud, run.simulated, found.shrink, spread) if found.shrink else (0.0, 0.0)
    return Gaps(found.before, found.calibrated, found.after, found.floor, found.shrink, interval)


def state_model_error(problem: DiagnosisProblem, runs: Sequence[ReplayedRun]) -> ModelError:
    """Return what the last scenario of each run leaves, by channel and frequency band."""
    noise = dict(zip(problem.channels, problem.noise.tolist(), strict=True))
    left = [(run.name, run.measured, run.simulated[-1]) for run in runs]
    return measure_model_error(left, noise, problem.rate, problem.settings.noise.highest_frequency)


def _measure_run(problem: DiagnosisProblem, run: ReplayedRun) -> RunGaps:
    measured = {name: run.measured[name] for name in loud_channels(problem.recording, run.measured)}
    gaps = [compare_signals(problem.recording, measured, simulated) for simulated in run.simulated]
    before, calibrated, after = (GapFigures(each.overall, each.channels) for each in gaps)
    return RunGaps(run.name, before, calibrated, after, gaps[0].floor, 1.0 - after.overall / before.overall)


def _bootstrap_shrink(
    problem: DiagnosisProblem, measured: Signals, simulated: Sequence[Signals], shrink: float, spread: float
) -> tuple[float, float]:
    """Return the block bootstrap interval of the shrink from the first rig to the last, widened by its spread."""
    settings = problem.settings.validation
    length = max(1, round(settings.block_length * problem.rate))
    count = max(1, len(next(iter(measured.values()))) // length)
    powers = np.array([
        [_block_powers((values - outputs[name]) / np.std(values), count, length) for name, values in measured.items()]
        for outputs in (simulated[0], simulated[-1])
    ])  # fmt: skip
    # The same draws for every recording: equal input gives equal output.
    rng = np.random.default_rng(0)
    drawn = powers[:, :, rng.integers(0, count, (settings.draws, count))].mean(axis=(1, 3))
    widened = np.hypot(settings.excitation_std, spread) * rng.standard_normal(settings.draws)
    samples = 1.0 - np.sqrt(drawn[1] / drawn[0]) + widened
    low, high = np.percentile(samples, settings.percentiles)
    return float(min(low, shrink)), float(min(1.0, max(high, shrink)))


def _block_powers(values: Array, count: int, length: int) -> Array:
    return np.asarray(np.mean(values[: count * length].reshape(count, -1) ** 2, axis=1))
