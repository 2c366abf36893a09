"""Fits of effects together with the nuisance parameters: Gauss-Newton steps under bounds.

The sensitivities of the nuisance parameters hardly change as effects are added, but cost most of a linearisation. A fit
therefore uses those that its caller passes in. Those of the effects are carried from step to step, corrected by what
the last step did, and computed anew where they lead no further: merely kept, they leave a stiff stop far from its
minimum.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from seatsim.diagnosis.objective import PRIOR_STD, Evaluation, Linearisation, Objective
from seatsim.diagnosis.problem import OutOfTimeError
from seatsim.schema.arrays import Array

_MOST_STEPS = 10
"""Most steps of a fit: with more of them hard fits end nearer their minimum, and take longer."""
_BACKTRACKING = (1.0, 0.4, 0.12)
"""Fractions of a step that are tried in turn."""
_SETTLED = 0.01
"""Share of the cost that a step must take off to be followed by another."""
_FAITHFUL = 0.1
"""Largest share of the power of a change that sensitivities may miss to be carried on."""


def fit(objective: Objective, start: Evaluation, nuisances: Linearisation, settled: float = _SETTLED) -> Evaluation:
    """Return the evaluation at the end of a fit from `start`, with the given sensitivities of the nuisances.

    It ends where a step by sensitivities measured at its beginning lowers the cost by less than the share `settled`, or
    after `_MOST_STEPS`. At the deadline it is the best so far.
    """
    evaluation, carried = start, dict[str, Array]()
    for _ in range(_MOST_STEPS):
        before = evaluation
        try:
            own = carried or objective.linearise_effects(before).jacobian
            rig, step = before.parameters, _find_step(before, nuisances, own)
            tries = (objective.evaluate([rig.move_to(rig.vector + part * step)])[0] for part in _BACKTRACKING)
            evaluation = next((tried for tried in tries if tried.cost < before.cost), before)
        except OutOfTimeError:
            break
        is_lower = evaluation.cost <= (1.0 - settled) * before.cost
        if not (is_lower or carried):
            break
        carried = _carry(own, nuisances, before, evaluation) if is_lower else {}
    return evaluation


def _carry(own: Mapping[str, Array], nuisances: Linearisation, old: Evaluation, new: Evaluation) -> dict[str, Array]:
    """Return the sensitivities to the effects' parameters at the end of a step, from those at its beginning.

    Of all that say what the step did, they are the nearest (Broyden's update), so that no rig is simulated for them.
    None are returned where those at its beginning told little of what it did.
    """
    shared, step = np.split(new.parameters.vector - old.parameters.vector, [len(old.parameters.deviations)])
    done = {run: (old.whitened[run] - new.whitened[run]).ravel() for run in own}
    missed = {run: change - shared @ nuisances.jacobian[run] - step @ own[run] for run, change in done.items()}
    power, wrong = (sum(float(each @ each) for each in changes.values()) for changes in (done, missed))
    size = float(step @ step)
    if not size or wrong > _FAITHFUL * power:
        return {}
    return {run: jacobian + np.outer(step / size, missed[run]) for run, jacobian in own.items()}


def refit_on(objective: Objective, rig: Linearisation, settled: float = _SETTLED) -> Evaluation:
    """Return the evaluation at the end of a fit on the runs of an objective, from a rig linearised over more runs."""
    return fit(objective, objective.weigh_again(rig.evaluation), rig, settled=settled)


def _find_step(evaluation: Evaluation, nuisances: Linearisation, own: Mapping[str, Array]) -> Array:
    """Return the Gauss-Newton step of the vector under its bounds, over the runs of `own`.

    `own` holds the sensitivities to the effects' free parameters by run.
    """
    parts = [nuisances.normal_equations(run, own[run], evaluation.whitened[run]) for run in own]
    matrix, right = (np.sum(part, axis=0) for part in zip(*parts, strict=True))
    rig = evaluation.parameters
    return solve_step(matrix, right, len(rig.deviations), rig.vector, *rig.limits)


def solve_step(matrix: Array, right: Array, count: int, vector: Array, low: Array, high: Array) -> Array:
    """Return the step s from a vector that minimises `s' matrix s - 2 right' s` with the prior, under bounds.

    Args:
        matrix: normal matrix of the data, shape (components, components).
        right: its right-hand side, shape (components,).
        count: how many of the first components have the prior, Gaussian about 0.
        vector: where the step starts, shape (components,).
        low: lower bounds of `vector + s`, shape (components,).
        high: upper bounds.
    """
    matrix, right = matrix.copy(), right.copy()
    index = np.arange(count)
    matrix[index, index] += PRIOR_STD**-2
    right[:count] -= vector[:count] / PRIOR_STD**2
    # Components differ in size, so they are scaled to a unit diagonal; a small ridge keeps collinear ones solvable.
    size = np.sqrt(np.maximum(np.diag(matrix), 1e-12))
    scaled = matrix / np.outer(size, size) + 1e-8 * np.eye(len(size))
    # A component beyond its bound by rounding keeps an empty interval about its place.
    room = np.minimum(low - vector, 0.0) * size, np.maximum(high - vector, 0.0) * size
    return _minimise_bounded(scaled, right / size, *room) / size


_PATIENCE = 3
"""Exchanges of whole blocks without fewer components out of place, after which one component at a time is exchanged."""
_ALLOWANCE = 1e-12
"""Violations of a bound and gradients below this, in units of the largest right-hand side, are rounding errors."""


def _minimise_bounded(matrix: Array, right: Array, low: Array, high: Array) -> Array:
    """Return the x that minimises `x' matrix x - 2 right' x` with `low <= x <= high`, by block principal pivoting.

    A bounded least-squares routine for tall matrices spends most of its time on factorising what is a matrix of some
    twenty rows here; a diagnosis solves about a thousand of these.

    Each component is free or at one of its bounds. The free ones are solved for; then all that are out of place change
    sides: free ones beyond a bound go to it, and those at a bound whose gradient points inwards become free. Where that
    stops making progress only the last of them changes, which ends after finitely many exchanges.

    Args:
        matrix: symmetric and positive definite, shape (components, components), of a diagonal near 1.
        right: shape (components,).
        low: lower bounds, shape (components,), not above `high`.
        high: upper bounds, shape (components,).

    Source: J. J. Judice and F. M. Pires, "A block principal pivoting algorithm for large-scale strictly monotone
    linear complementarity problems", Computers & Operations Research 21 (1994) 587-596 (recalled).
    """
    side = np.zeros(len(right), dtype=np.int8)
    fewest, patience = len(right) + 1, _PATIENCE
    allowed = _ALLOWANCE * max(1.0, float(np.abs(right).max(initial=0.0)))
    while True:
        x = np.where(side < 0, low, np.where(side > 0, high, 0.0))
        free = side == 0
        x[free] = np.linalg.solve(matrix[np.ix_(free, free)], right[free] - matrix[np.ix_(free, ~free)] @ x[~free])
        gradient = matrix @ x - right
        wanted = np.where(free, (x > high + allowed).astype(np.int8) - (x < low - allowed), side)
        wanted[(side != 0) & (side * gradient > allowed)] = 0
        misplaced = np.flatnonzero(wanted != side)
        if not len(misplaced):
            return np.clip(x, low, high)
        if len(misplaced) < fewest:
            fewest, patience = len(misplaced), _PATIENCE
        else:
            patience -= 1
        changed = misplaced if patience >= 0 else misplaced[-1:]
        side[changed] = wanted[changed]
