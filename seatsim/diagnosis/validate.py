"""Hold-out validation: how far the gap shrinks on a run that took no part in the fit, and what every run shows."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.decide import call_unknown, give_up_effects
from seatsim.diagnosis.fit import refit_on
from seatsim.diagnosis.movement import measure_movements, share_removable
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective, Parameters
from seatsim.diagnosis.problem import DiagnosisProblem, normalise_rms_errors
from seatsim.diagnosis.result import Gaps, RunGaps
from seatsim.diagnosis.solution import Solution
from seatsim.diagnosis.uncertainty import BLOCK_LENGTH
from seatsim.recordings.gap import GapFigures, Signals, compare_signals, loud_channels
from seatsim.recordings.model_error import ModelError, measure_model_error
from seatsim.recordings.replay import replay
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, RunError

_CLOSELY_SETTLED = 1e-5
"""The stated fit ends where a step lowers its cost by less than this share."""
_DRAWS = 400
"""Samples of the bootstrap."""
_PERCENTILES = 5.0, 95.0
"""Ends of the interval of the shrink, in %."""


def choose_held_out_run(problem: DiagnosisProblem, nominal: Evaluation, chosen: Evaluation) -> str:
    """Return the run to hold out: that whose gap shrinks most nearly as much as that of all runs together.

    A run that has more than the permitted share of what some effect moves in all runs is not held out, since the fit
    needs it; where every run has more, the run with the smallest share is held out.
    """
    if not chosen.parameters.terms or len(problem.runs) < 2:
        return problem.runs[-1]
    after, before = (normalise_rms_errors(problem, each.residuals) for each in (chosen, nominal))
    moves = [measure_movements(problem.on_runs([run]), chosen) for run in problem.runs]
    powers = np.array([[float(np.mean(move**2)) for move in of_run] for of_run in moves])
    largest = np.max(powers / np.maximum(np.sum(powers, axis=0), 1e-12), axis=1)
    spared = largest < max(problem.settings.validation.most_share, 1.001 * largest.min())
    apart = np.abs(after / before - np.linalg.norm(after) / np.linalg.norm(before))
    return problem.runs[min(np.flatnonzero(spared), key=lambda k: apart[k])]


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
    return refit_on(objective, rig, _CLOSELY_SETTLED)


class ReplayedRun(NamedTuple):
    """A run: its recorded channels that are compared, and the same simulated with each of several scenarios."""

    name: str
    measured: dict[str, Array]
    simulated: list[dict[str, Array]]


def replay_runs(problem: DiagnosisProblem, scenarios: Sequence[Scenario]) -> list[ReplayedRun]:
    """Return every run, replayed with some scenarios on all cores."""
    jobs = [(scenario, run) for run in problem.runs for scenario in scenarios]
    found = list(problem.pool.map(lambda job: replay(job[0], problem.recording, job[1]), jobs))
    by_run = [found[k : k + len(scenarios)] for k in range(0, len(found), len(scenarios))]
    pairs = zip(problem.runs, by_run, strict=True)
    return [ReplayedRun(run, of_run[0][0], [simulated for _, simulated in of_run]) for run, of_run in pairs]


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
    length = max(1, round(BLOCK_LENGTH * problem.rate))
    count = max(1, len(next(iter(measured.values()))) // length)

    def measure_powers(outputs: Signals) -> list[Array]:
        errors = [(values - outputs[name]) / np.std(values) for name, values in measured.items()]
        return [np.mean(each[: count * length].reshape(count, -1) ** 2, axis=1) for each in errors]

    powers = np.array([measure_powers(simulated[0]), measure_powers(simulated[-1])])
    # The same draws for every recording: equal input gives equal output.
    rng = np.random.default_rng(0)
    drawn = powers[:, :, rng.integers(0, count, (_DRAWS, count))].mean(axis=(1, 3))
    widened = np.hypot(problem.settings.validation.excitation_std, spread) * rng.standard_normal(_DRAWS)
    samples = 1.0 - np.sqrt(drawn[1] / drawn[0]) + widened
    low, high = np.percentile(samples, _PERCENTILES)
    return float(min(low, shrink)), float(min(1.0, max(high, shrink)))


@dataclasses.dataclass(frozen=True)
class Validation:
    """A solution on a run held out of its fits: the rigs fitted without the run, and the gaps that they leave on it.

    `scenarios` are those of the nominal, the calibrated and the augmented rig, with which `runs` holds every run
    replayed.
    `found` is the rig of the solution, fitted to all runs, with its sensitivities to the nuisance parameters.
    """

    solution: Solution
    found: Linearisation
    run: str
    calibrated: Evaluation
    augmented: Evaluation
    scenarios: Sequence[Scenario]
    runs: Sequence[ReplayedRun]
    gaps: Gaps

    @property
    def fitted(self) -> Parameters:
        """Parameters of the augmented rig, of the calibrated one where no effect is stated."""
        return (self.augmented if self.augmented.parameters.terms else self.calibrated).parameters


def validate_on_held_out(solution: Solution) -> Validation:
    """Return a solution assessed on a held-out run; effects that fail there beside an unknown cause are dropped."""
    objective, decision, selection = solution.objective, solution.decision, solution.selection
    problem, chosen = objective.problem, decision.chosen
    run = choose_held_out_run(problem, selection.nominal, chosen)
    found = objective.linearise_nuisances(chosen) if chosen.parameters.terms else selection.nuisances
    calibrated, augmented = refit_without(objective, selection.nuisances, found, run)
    if decision.verdict == "unknown" and not chosen.parameters.terms:
        augmented = selection.nominal
    rigs = Parameters(problem.nominal), calibrated.parameters, augmented.parameters
    scenarios = [problem.augmented(rig.deviations, rig.effects, problem.recording.nominal) for rig in rigs]
    try:
        runs = replay_runs(problem, scenarios)
    except RunError:
        if not chosen.parameters.terms:
            raise
        return validate_on_held_out(_give_up(solution, f"cannot be simulated as fitted without {run}"))
    # A single run has no spread: its standard deviation with n - 1 degrees of freedom would be NaN.
    after, before = (normalise_rms_errors(problem, each.residuals) for each in (chosen, selection.nominal))
    spread = float(np.std(after / before, ddof=min(1, len(before) - 1)))
    gaps = measure_gaps(problem, next(each for each in runs if each.name == run), spread)
    gaps = dataclasses.replace(gaps, by_run=list_gaps(problem, runs))
    raised = _name_raised_gap(gaps, run)
    if decision.verdict == "unknown" and chosen.parameters.terms and raised:
        return validate_on_held_out(_give_up(solution, f"raises {raised} as fitted without {run}"))
    if not solution.stochastic and decision.verdict in ("known", "ambiguous"):
        taken = share_removable(objective.on_runs([run]), gaps.before.overall, gaps.after.overall)
        if taken < problem.settings.decision.least_taken:
            solution = solution._replace(decision=call_unknown(problem.settings.decision, decision))
    return Validation(solution, found, run, calibrated, augmented, scenarios, runs, gaps)


def _name_raised_gap(gaps: Gaps, held_out: str) -> str:
    """Return which gap the augmented scenario raises above the nominal's, in words; an empty word for none."""
    if gaps.after.overall >= gaps.before.overall:
        return f"the gap of {held_out}"
    raised = sum(run.after.overall**2 for run in gaps.by_run) > sum(run.before.overall**2 for run in gaps.by_run)
    return "the gap of all runs" if raised else ""


def _give_up(solution: Solution, reason: str) -> Solution:
    """Return the solution without its effects; a note names them with the reason."""
    selection, names = solution.selection, sorted(solution.decision.chosen.parameters.names)
    note = f"{' with '.join(names)} was given up, since it {reason}"
    left = give_up_effects(solution.objective.problem, solution.decision, selection.calibrated)
    noted, where = dataclasses.replace(selection, notes=(*selection.notes, note)), solution.where
    return solution._replace(selection=noted, decision=left, where=() if left.verdict == "none" else where)
