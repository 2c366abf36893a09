"""Screening: the cost that a linear model predicts for each candidate, from its change of the outputs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence
from contextlib import suppress
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.deadline import OutOfTimeError
from seatsim.diagnosis.fit import solve_step
from seatsim.diagnosis.objective import AT_ONCE, Evaluation, Linearisation, Objective
from seatsim.diagnosis.parameters import Parameters

Array = NDArray[np.float64]


class Sensitivities(NamedTuple):
    """Candidates and what each changes, at its start, in the whitened outputs: `changes[run]`, (candidates, ...)."""

    candidates: Sequence[Candidate]
    changes: dict[str, Array]


class Prediction(NamedTuple):
    """The cost that a linear model predicts for the best multiple of a candidate's start, and that multiple."""

    cost: float
    factor: float


def measure_sensitivities(
    objective: Objective, calibrated: Evaluation, candidates: Sequence[Candidate]
) -> Sensitivities:
    """Return the change of the calibrated rig by each candidate at its start; unstable ones are dropped.

    At the deadline they are those of the candidates so far.
    """
    kept: list[Candidate] = []
    changes = {run: np.empty((len(candidates), *base.shape)) for run, base in calibrated.whitened.items()}
    with suppress(OutOfTimeError):
        for first in range(0, len(candidates), AT_ONCE):
            part = candidates[first : first + AT_ONCE]
            starts = objective.evaluate([calibrated.parameters.add(each, np.array(each.start)) for each in part])
            for candidate, start in zip(part, starts, strict=True):
                if np.isfinite(start.cost):
                    for run, base in calibrated.whitened.items():
                        np.subtract(base, start.whitened[run], out=changes[run][len(kept)])
                    kept.append(candidate)
    return Sensitivities(kept, {run: values[: len(kept)] for run, values in changes.items()})


def name_unstable(candidates: Sequence[Candidate], kept: Sequence[Candidate]) -> tuple[str, ...]:
    """Return a sentence on each effect of which starts were dropped, since the rig cannot be simulated with them."""
    offered = Counter(candidate.effect for candidate in candidates)
    left = offered - Counter(candidate.effect for candidate in kept)
    return tuple(
        f"{effect} could not be simulated from {count} of {offered[effect]} starts, which were dropped"
        for effect, count in left.items()
    )


def screen_candidates(
    objective: Objective, base: Evaluation, offered: Sensitivities, nuisances: Linearisation, bound: float, count: int
) -> list[Evaluation]:
    """Return the most promising starts of fits, with one candidate each added to a base.

    Args:
        objective: what is minimised.
        base: the fitted set to which a candidate is added.
        offered: sensitivities to the candidates; those of the effects of the base are left out.
        nuisances: linearisation of the nuisance parameters.
        bound: predicted cost from which a candidate is not tried.
        count: most candidates that are tried, each in one structure.
    """
    predicted = _predict(objective, base, offered, nuisances)
    first: dict[Hashable, int] = {}
    for k in sorted(predicted, key=lambda k: predicted[k].cost):
        if predicted[k].cost < bound:
            first.setdefault(offered.candidates[k].structure, k)
    shortlist = list(first.values())[:count]
    starts = [_starts_around(objective, base.parameters, offered.candidates[k], predicted[k].factor) for k in shortlist]
    evaluations = iter(objective.evaluate([parameters for several in starts for parameters in several]))
    return [min(islice(evaluations, len(several)), key=lambda each: each.cost) for several in starts]


def _predict(
    objective: Objective, base: Evaluation, offered: Sensitivities, nuisances: Linearisation
) -> dict[int, Prediction]:
    """Return the predicted cost of the best multiple of each candidate, for a rig that is linear in all parameters.

    Candidates are known by their place among those offered; those of the effects of the base are left out.
    """
    others = [k for k, each in enumerate(offered.candidates) if each.effect not in base.parameters.names]
    own = objective.linearise_effects(base)
    matrix, right, mixed, squares, slopes = (np.sum(parts, axis=0) for parts in zip(*(
        _multiply(np.vstack([nuisances.jacobian[run], own.jacobian[run]]), offered.changes[run], residuals.ravel())
        for run, residuals in base.whitened.items()
    ), strict=True))  # fmt: skip
    return {
        k: _predict_one(
            objective, base, offered.candidates[k],
            np.block([[matrix, mixed[k][:, None]], [mixed[k], squares[k]]]), np.append(right, slopes[k]),
        )
        for k in others
    }  # fmt: skip


def _multiply(jacobian: Array, changes: Array, residuals: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return the products of a run for the normal equations: of the Jacobian, of all changes at once, with each other.

    They are `J J'`, `J r`, `C J'`, the squares of the rows of C, and `C r`.
    """
    changes = changes.reshape(-1, residuals.size)
    squares = np.einsum("ij,ij->i", changes, changes)
    return jacobian @ jacobian.T, jacobian @ residuals, changes @ jacobian.T, squares, changes @ residuals


def _predict_one(
    objective: Objective, base: Evaluation, candidate: Candidate, matrix: Array, right: Array
) -> Prediction:
    """Return the prediction for a candidate, the last component of the normal equations."""
    vector, (low, high) = base.parameters.vector, base.parameters.limits
    count, stretch = len(base.parameters.deviations), objective.settings.selection.stretch
    ends = (np.array([candidate.low[0], candidate.high[0]]) - candidate.nominal) / (
        candidate.start[0] - candidate.nominal
    )
    low = np.append(low, 0.0 if ends.min() >= 0.0 else -stretch)
    high = np.append(high, stretch)
    step = solve_step(matrix, right, count, np.append(vector, 0.0), low, high, objective.settings.fit.prior_std)
    return Prediction(base.cost - 2.0 * float(step @ right) + float(step @ matrix @ step), float(step[-1]))


def _starts_around(
    objective: Objective, parameters: Parameters, candidate: Candidate, factor: float
) -> list[Parameters]:
    """Return the parameters with a candidate at its start, and with its first parameter scaled as predicted."""
    settings = objective.settings.selection
    if candidate.is_limit:
        # The action of a limit is not proportional to its size, so only the direction of the prediction is used.
        less = settings.limit_factors
        factors: tuple[float, ...] = less if factor < 1.0 else tuple(1.0 / each for each in less)
    else:
        factors = tuple(factor * each for each in settings.start_factors if abs(factor) > settings.least_factor)
    starts = np.tile(candidate.start, (1 + len(factors), 1))
    nominal = 0.0 if candidate.is_limit else candidate.nominal
    starts[1:, 0] = np.clip(nominal + (starts[1:, 0] - nominal) * factors, candidate.low[0], candidate.high[0])
    return [parameters.add(candidate, values) for values in starts]
