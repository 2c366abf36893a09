"""Hold-out validation: how far the gap shrinks on a run that took no part in the fit."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.fit import refit
from seatsim.diagnosis.movement import measure_movements
from seatsim.diagnosis.nuisance import vary
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.parameters import Parameters
from seatsim.diagnosis.problem import DiagnosisProblem, normalise_rms_errors
from seatsim.effects.base import replace_effects
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array


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


def refit_without(objective: Objective, evaluation: Evaluation, run: str) -> tuple[Evaluation, Evaluation]:
    """Return the calibrated and the augmented rig, both fitted without a run."""
    others = tuple(name for name in objective.problem.runs if name != run) or objective.problem.runs
    part = objective.on_runs(others)
    calibrated = refit(part, Parameters(objective.problem.nominal))
    return calibrated, refit_closely(part, evaluation.parameters) if evaluation.parameters.terms else calibrated


def refit_closely(objective: Objective, parameters: Parameters) -> Evaluation:
    """Return a refit that ends where steps change the estimate by less than its standard deviation."""
    problem, settings = objective.problem, objective.settings
    closer = settings._replace(fit=settings.fit._replace(settled=settings.validation.settled))
    return refit(dataclasses.replace(objective, problem=dataclasses.replace(problem, settings=closer)), parameters)


def make_scenario(problem: DiagnosisProblem, nominal: Scenario, parameters: Parameters) -> Scenario:
    """Return the nominal scenario with some parameters and effects."""
    varied = vary(nominal, problem.parameters, parameters.deviations)
    return dataclasses.replace(varied, effects=replace_effects(nominal.effects, parameters.effects))
