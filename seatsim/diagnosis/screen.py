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


class Sensitivity(NamedTuple):
    """A candidate and what it changes, at its start, in the whitened outputs of each run, shape (channels, rows)."""

    candidate: Candidate
    changes: dict[str, Array]


class Prediction(NamedTuple):
    """The cost that a linear model predicts for the best multiple of a candidate's start, and that multiple."""

    cost: float
    factor: float


def measure_sensitivities(
    objective: Objective, calibrated: Evaluation, candidates: Sequence[Candidate]
) -> list[Sensitivity]:
    """Return the change of the calibrated rig by each candidate at its start; unstable ones are dropped.

    At the deadline they are those of the candidates so far.
    """
    starts: list[Evaluation] = []
    with suppress(OutOfTimeError):
        for first in range(0, len(candidates), AT_ONCE):
            part = candidates[first : first + AT_ONCE]
            starts += objective.evaluate([calibrated.parameters.add(each, np.array(each.start)) for each in part])
    return [
        Sensitivity(candidate, {run: base - start.whitened[run] for run, base in calibrated.whitened.items()})
        for candidate, start in zip(candidates, starts, strict=False) if np.isfinite(start.cost)
    ]  # fmt: skip


def name_unstable(candidates: Sequence[Candidate], kept: Sequence[Sensitivity]) -> tuple[str, ...]:
    """Return a sentence on each effect of which starts were dropped, since the rig cannot be simulated with them."""
    offered = Counter(candidate.effect for candidate in candidates)
    left = offered - Counter(each.candidate.effect for each in kept)
    return tuple(
        f"{effect} could not be simulated from {count} of {offered[effect]} starts, which were dropped"
        for effect, count in left.items()
    )


def screen_candidates(
    objective: Objective, base: Evaluation, offered: Sequence[Sensitivity], nuisances: Linearisation, bound: float,
    count: int,
) -> list[Evaluation]:  # fmt: skip
    """Return the most promising starts of fits, with one candidate each added to a base.

    Args:
        objective: what is minimised.
        base: the fitted set to which a candidate is added.
        offered: candidates with their sensitivities.
        nuisances: linearisation of the nuisance parameters.
        bound: predicted cost from which a candidate is not tried.
        count: most candidates that are tried, each in one structure.
    """
    own = objective.linearise_effects(base)
    predicted = list(objective.problem.pool.map(lambda each: _predict(objective, base, each, nuisances, own), offered))
    first: dict[Hashable, int] = {}
    for k in sorted(range(len(offered)), key=lambda k: predicted[k].cost):
        if predicted[k].cost < bound:
            first.setdefault(offered[k].candidate.structure, k)
    shortlist = list(first.values())[:count]
    starts = [_starts_around(objective, base.parameters, offered[k].candidate, predicted[k].factor) for k in shortlist]
    evaluations = iter(objective.evaluate([parameters for several in starts for parameters in several]))
    return [min(islice(evaluations, len(several)), key=lambda each: each.cost) for several in starts]


def _predict(
    objective: Objective, base: Evaluation, sensitivity: Sensitivity, nuisances: Linearisation, own: Linearisation
) -> Prediction:
    """Return the predicted cost of the best multiple of a candidate, for a rig that is linear in all parameters."""
    candidate, changes = sensitivity
    vector, (low, high) = base.parameters.vector, base.parameters.limits
    parts = [
        nuisances.normal_equations(run, np.vstack([own.jacobian[run], changes[run].ravel()]), residuals)
        for run, residuals in base.whitened.items()
    ]
    matrix, right = np.sum([part[0] for part in parts], axis=0), np.sum([part[1] for part in parts], axis=0)
    count, stretch = len(base.parameters.deviations), objective.settings.selection.stretch
    ends = (np.array([candidate.low[0], candidate.high[0]]) - candidate.nominal) / (
        candidate.start[0] - candidate.nominal
    )
    low = np.append(low, 0.0 if ends.min() >= 0.0 else -stretch)
    high = np.append(high, stretch)
    prior_std = objective.settings.fit.prior_std
    step = solve_step(matrix, right, count, np.append(vector, 0.0), low, high, prior_std)
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
