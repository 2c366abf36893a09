"""Pattern search: descent in the parameters of one effect where the cost jumps, so that no sensitivity leads downwards.

All neighbours of the best point, a step away in one parameter or in two at once, are evaluated together; the best of
them is moved to if it costs less, or else the step becomes smaller (direct search: Kolda, Lewis and Torczon, 2003).
A point that was evaluated before is not evaluated again, since it costs no less than the best.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.parameters import Parameters
from seatsim.schema.arrays import Array

DECIMALS = 9
"""Decimals, in natural sizes of the parameters, to which two points have to agree to be the same."""


def search_pattern(objective: Objective, start: Evaluation) -> Evaluation:
    """Return the evaluation that no step in the free parameters of the last effect improves any more.

    Args:
        objective: what is minimised; its settings hold the steps, in natural sizes of the parameters.
        start: evaluation of the rig at which the search starts.

    Raises:
        OutOfTimeError: the deadline of the problem is past.
    """
    best, directions = start, list_directions(len(start.parameters.terms[-1].free))
    known = {_locate(start.parameters)}
    for step in objective.settings.fit.pattern_steps:
        while True:
            vector = best.parameters.vector
            moves = np.tile(vector, (len(directions), 1))
            moves[:, len(vector) - directions.shape[1] :] += step * directions
            neighbours = {_locate(each): each for each in map(best.parameters.move_to, moves)}
            untried = [neighbours[place] for place in neighbours if place not in known]
            known.update(neighbours)
            least = min([best, *objective.evaluate(untried)], key=lambda each: each.cost)
            if least is best:
                break
            best = least
    return best


def _locate(parameters: Parameters) -> bytes:
    """Return the key of a point: its vector without the rounding errors of the way that led there."""
    return (np.round(parameters.vector, DECIMALS) + 0.0).tobytes()


def list_directions(count: int) -> Array:
    """Return the directions along one parameter or the diagonals of two of `count`, shape (directions, count)."""
    steps = product((-1.0, 0.0, 1.0), repeat=count)
    return np.array([step for step in steps if np.count_nonzero(step) in (1, 2)])
