"""Hold-out validation: how far the gap shrinks on a run that took no part in the fit, and what every run shows."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.fit import refit_on
from seatsim.diagnosis.movement import measure_movements
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective, Parameters
from seatsim.diagnosis.problem import DiagnosisProblem, normalise_rms_errors
from seatsim.diagnosis.result import Gaps, RunGaps
from seatsim.effects.base import replace_effects
from seatsim.recordings.gap import GapFigures, Signals, compare_signals, loud_channels
from seatsim.recordings.model_error import ModelError, measure_model_error
from seatsim.recordings.nuisance import vary
from seatsim.recordings.replay import replay
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError


def shrink_by_run(problem: DiagnosisProblem, nominal: Evaluation, chosen: Evaluation) -> Array:
    """Return by how much the gap shrinks in each run from one rig to another, shape (runs,)."""
    after, before = (normalise_rms_errors(problem, each.residuals) for each in (chosen, nominal))
    return 1.0 - after / before


def choose_held_out_run(problem: DiagnosisProblem, chosen: Evaluation, shrink: Array, quantile: float) -> str:
    """Return the run to hold out: one that the effects move about as much as others, at a quantile of shrink.

    The gap of a new excitation shrinks less than that of the runs in which the effect was found, hence a low quantile.
    """
    if not chosen.parameters.terms or len(problem.runs) < 2:
        return problem.runs[-1]
    share = _share_movements(problem, chosen)
    spared = _spare(problem, share)
    moved = spared & (share.min(axis=1) > problem.settings.validation.least_share)
    suitable = sorted(np.flatnonzero(moved if moved.any() else spared), key=lambda k: shrink[k])
    return problem.runs[suitable[int(quantile * (len(suitable) - 1))]]


def choose_typical_run(problem: DiagnosisProblem, nominal: Evaluation, chosen: Evaluation) -> str:
    """Return the run to hold out whose gap shrinks most nearly as much as that of all runs together."""
    if not chosen.parameters.terms or len(problem.runs) < 2:
        return problem.runs[-1]
    after, before = (normalise_rms_errors(problem, each.residuals) for each in (chosen, nominal))
    overall = 1.0 - float(np.linalg.norm(after) / np.linalg.norm(before))
    spared = np.flatnonzero(_spare(problem, _share_movements(problem, chosen)))
    return problem.runs[min(spared, key=lambda k: abs(1.0 - after[k] / before[k] - overall))]


def _share_movements(problem: DiagnosisProblem, chosen: Evaluation) -> Array:
    """Return each run's share of what each effect moves in all runs, shape (runs, effects)."""
    moves = [measure_movements(problem.on_runs([run]), chosen) for run in problem.runs]
    shares = np.array([[float(np.mean(move**2)) for move in of_run] for of_run in moves])
    return np.asarray(shares / np.maximum(np.sum(shares, axis=0), 1e-12))


def _spare(problem: DiagnosisProblem, share: Array) -> NDArray[np.bool_]:
    """Return which runs a fit can do without.

    Where every run has more than the permitted share of some effect, the one with the least is held out.
    """
    largest = share.max(axis=1)
    return np.asarray(largest < max(problem.settings.validation.most_share, 1.001 * largest.min()))


def refit_without(
    objective: Objective, calibrated: Linearisation, chosen: Linearisation, run: str
) -> tuple[Evaluation, Evaluation]:
    """Return the calibrated and the augmented rig, both fitted without a run, from rigs fitted with it."""
    others = tuple(name for name in objective.problem.runs if name != run) or objective.problem.runs
    part = objective.on_runs(others)
    without = refit_on(part, calibrated)
    return without, refit_closely(part, chosen) if chosen.evaluation.parameters.terms else without


def refit_closely(objective: Objective, rig: Linearisation) -> Evaluation:
    """Return a refit that ends where steps change the estimate by less than its standard deviation."""
    problem, settings = objective.problem, objective.settings
    closer = settings._replace(fit=settings.fit._replace(settled=settings.validation.settled))
    return refit_on(dataclasses.replace(objective, problem=dataclasses.replace(problem, settings=closer)), rig)


def make_scenario(problem: DiagnosisProblem, nominal: Scenario, parameters: Parameters) -> Scenario:
    """Return the nominal scenario with some parameters and effects."""
    varied = vary(nominal, problem.parameters, parameters.deviations)
    return dataclasses.replace(varied, effects=replace_effects(nominal.effects, parameters.effects))


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
    powers = np.array(
        [
            [
                _block_powers((values - outputs[name]) / np.std(values), count, length)
                for name, values in measured.items()
            ]
            for outputs in (simulated[0], simulated[-1])
        ]
    )
    # The same draws for every recording: equal input gives equal output.
    rng = np.random.default_rng(0)
    drawn = powers[:, :, rng.integers(0, count, (settings.draws, count))].mean(axis=(1, 3))
    widened = np.hypot(settings.excitation_std, spread) * rng.standard_normal(settings.draws)
    samples = 1.0 - np.sqrt(drawn[1] / drawn[0]) + widened
    low, high = np.percentile(samples, settings.percentiles)
    return float(min(low, shrink)), float(min(1.0, max(high, shrink)))


def _block_powers(values: Array, count: int, length: int) -> Array:
    return np.asarray(np.mean(values[: count * length].reshape(count, -1) ** 2, axis=1))
