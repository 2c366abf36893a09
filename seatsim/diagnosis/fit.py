"""Fits of effects together with the nuisance parameters, by Gauss-Newton steps under bounds.

The sensitivities of the nuisance parameters hardly change as effects are added, but cost most of a linearisation. A fit
therefore uses those that its caller passes in, and recomputes those of the effects at every step.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from seatsim.diagnosis.bounded import minimise_bounded
from seatsim.diagnosis.deadline import OutOfTimeError
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective
from seatsim.diagnosis.parameters import Parameters
from seatsim.schema.arrays import Array


def fit(objective: Objective, start: Evaluation, nuisances: Linearisation, steps: int | None = None) -> Evaluation:
    """Return the evaluation at the end of a fit from `start`, with the given sensitivities of the nuisances.

    At the deadline it is the best so far.
    """
    evaluation = start
    for _ in range(objective.settings.fit.most_steps if steps is None else steps):
        before = evaluation.cost
        try:
            evaluation = _step_down(objective, evaluation, nuisances)
        except OutOfTimeError:
            break
        if evaluation.cost > (1.0 - objective.settings.fit.settled) * before:
            break
    return evaluation


def _step_down(objective: Objective, evaluation: Evaluation, nuisances: Linearisation) -> Evaluation:
    """Return the evaluation after one step, the whole or a fraction of it; the one given where none lowers the cost."""
    step = find_step(objective, evaluation, nuisances, objective.linearise_effects(evaluation).jacobian)
    for fraction in objective.settings.fit.backtracking:
        moved = evaluation.parameters.move_to(evaluation.parameters.vector + fraction * step)
        tried = objective.evaluate([moved])[0]
        if tried.cost < evaluation.cost:
            return tried
    return evaluation


def refit(objective: Objective, parameters: Parameters) -> Evaluation:
    """Return the evaluation at the end of a fit from some parameters, linearised there."""
    start = objective.evaluate([parameters])[0]
    return fit(objective, start, objective.linearise_nuisances(start))


def find_step(
    objective: Objective, evaluation: Evaluation, nuisances: Linearisation, own: Mapping[str, Array]
) -> Array:
    """Return the Gauss-Newton step of the vector under its bounds, over the runs of `own`.

    `own` holds the sensitivities to the effects' free parameters by run.
    """
    parts = [nuisances.normal_equations(run, own[run], evaluation.whitened[run]) for run in own]
    low, high = evaluation.parameters.limits
    matrix, right = np.sum([part[0] for part in parts], axis=0), np.sum([part[1] for part in parts], axis=0)
    count, prior_std = len(evaluation.parameters.deviations), objective.settings.fit.prior_std
    return solve_step(matrix, right, count, evaluation.parameters.vector, low, high, prior_std)


def solve_step(
    matrix: Array, right: Array, count: int, vector: Array, low: Array, high: Array, prior_std: float
) -> Array:
    """Return the step s from a vector that minimises `s' matrix s - 2 right' s` with the prior, under bounds.

    Args:
        matrix: normal matrix of the data, shape (components, components).
        right: its right-hand side, shape (components,).
        count: how many of the first components have the prior, Gaussian about 0.
        vector: where the step starts, shape (components,).
        low: lower bounds of `vector + s`, shape (components,).
        high: upper bounds.
        prior_std: standard deviation of the prior.
    """
    matrix, right = matrix.copy(), right.copy()
    index = np.arange(count)
    matrix[index, index] += prior_std**-2
    right[:count] -= vector[:count] / prior_std**2
    # Components differ in size, so they are scaled to a unit diagonal; a small ridge keeps collinear ones solvable.
    size = np.sqrt(np.maximum(np.diag(matrix), 1e-12))
    scaled = matrix / np.outer(size, size) + 1e-8 * np.eye(len(size))
    # A component beyond its bound by rounding keeps an empty interval about its place.
    room = np.minimum(low - vector, 0.0) * size, np.maximum(high - vector, 0.0) * size
    return minimise_bounded(scaled, right / size, *room) / size
