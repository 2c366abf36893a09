"""Screening: the cost that a linear model predicts for each candidate, from its change of the outputs."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Hashable, Sequence
from contextlib import suppress
from itertools import islice
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.fit import solve_step
from seatsim.diagnosis.objective import AT_ONCE, Evaluation, Linearisation, Objective, Parameters
from seatsim.diagnosis.problem import OutOfTimeError
from seatsim.schema.arrays import Array

_STRETCH = 6.0
"""Largest factor by which the screening enlarges the start of a candidate; a linear model holds no farther."""
_LIMIT_FACTORS = (1.08, 1.16, 1.27)
"""Factors that are tried on a limit that acts too much, and their inverses where it acts too little.

A limit acts by what exceeds it, so that fits from fewer places end in a wrong minimum.
"""


_LEAST_FACTOR = 1e-3
"""Factor on a start below which the data do not show the candidate at all."""
_SCREENED, _FEWEST = 0.5, 2
"""Share of the runs, and least number, in which starts are simulated for the screening, which only ranks them."""


class Sensitivities(NamedTuple):
    """Candidates and what each size of theirs changes alone, at its start, in the whitened outputs of some runs.

    `changes[run]` has one entry for each size, shape (sizes of all candidates, ...); those of a candidate follow each
    other, in the order of the candidates.
    """

    candidates: Sequence[Candidate]
    changes: dict[str, Array]

    @property
    def entries(self) -> list[slice]:
        """Where the entries of each candidate are."""
        ends = np.cumsum([candidate.sizes for candidate in self.candidates]).tolist()
        return [slice(end - each.sizes, end) for end, each in zip(ends, self.candidates, strict=True)]

    def without(self, effect: str) -> Sensitivities:
        """Return those of the other effects."""
        kept = [candidate.effect != effect for candidate in self.candidates]
        rows = np.repeat(kept, [candidate.sizes for candidate in self.candidates])
        others = [candidate for candidate, is_kept in zip(self.candidates, kept, strict=True) if is_kept]
        return Sensitivities(others, {run: each[rows] for run, each in self.changes.items()})


class _Prediction(NamedTuple):
    """The least cost that a linear model predicts with a candidate, the step of the base there, and the multiples.

    Those are of the candidate's sizes.
    """

    cost: float
    step: Array
    factors: Array


def measure_sensitivities(
    objective: Objective, calibrated: Evaluation, candidates: Sequence[Candidate]
) -> Sensitivities:
    """Return the changes of the calibrated rig by each candidate at its start; unstable ones are dropped.

    They are those in the runs that show most of the gap. At the deadline they are those of the candidates so far.
    """
    kept, filled = list[Candidate](), 0
    count, runs = sum(candidate.sizes for candidate in candidates), _choose_runs(objective, calibrated)
    part, changes = objective.on_runs(runs), {run: np.empty((count, *calibrated.whitened[run].shape)) for run in runs}
    with suppress(OutOfTimeError):
        for first in range(0, len(candidates), AT_ONCE):
            several = candidates[first : first + AT_ONCE]
            starts = [calibrated.parameters.add(each, values) for each in several for values in each.alone]
            evaluations = iter(part.evaluate(starts))
            for candidate in several:
                moved = list(islice(evaluations, candidate.sizes))
                if not all(np.isfinite(each.cost) for each in moved):
                    continue
                for each in moved:
                    for run in runs:
                        np.subtract(calibrated.whitened[run], each.whitened[run], out=changes[run][filled])
                    filled += 1
                kept.append(candidate)
    return Sensitivities(kept, {run: values[:filled] for run, values in changes.items()})


def _choose_runs(objective: Objective, calibrated: Evaluation) -> list[str]:
    """Return the runs that leave most beyond noise, in their order; what repeats one of them says no more."""
    problem = objective.problem
    repeated = {run for _, run in problem.repeats}
    left = {
        run: float(np.sum(each**2)) - calibrated.independent * each.size for run, each in calibrated.whitened.items()
    }
    ranked = sorted(problem.runs, key=lambda run: (run in repeated, -left[run]))
    kept = ranked[: max(_FEWEST, math.ceil(_SCREENED * len(ranked)))]
    return [run for run in problem.runs if run in kept]


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
    best_starts: dict[Hashable, int] = {}
    for k in sorted(predicted, key=lambda k: predicted[k].cost):
        if predicted[k].cost < bound:
            best_starts.setdefault(offered.candidates[k].structure, k)
    shortlist = list(best_starts.values())[:count]
    several = [_starts_around(base.parameters, offered.candidates[k], predicted[k]) for k in shortlist]
    best = objective.evaluate_best(several)
    # Where the prediction fails, a fit begins at the candidate's own start.
    failed = [k for k, each in enumerate(best) if each.cost >= base.cost]
    own = [(offered.candidates[shortlist[k]], np.array(offered.candidates[shortlist[k]].start)) for k in failed]
    for k, start in zip(failed, objective.evaluate([base.parameters.add(*each) for each in own]), strict=True):
        best[k] = min(best[k], start, key=lambda each: each.cost)
    return [each for each in best if np.isfinite(each.cost)]


def _predict(
    objective: Objective, base: Evaluation, offered: Sensitivities, nuisances: Linearisation
) -> dict[int, _Prediction]:
    """Return the prediction for the best multiple of each candidate, for a rig that is linear in all parameters.

    The screened runs stand for all. Candidates are known by their place among those offered; those of the effects of
    the base are left out.
    """
    others = [k for k, each in enumerate(offered.candidates) if each.effect not in base.parameters.names]
    part = objective.on_runs(list(offered.changes))
    screened = part.weigh_again(base)
    own, entries, whole = part.linearise_effects(screened), offered.entries, base.rows / screened.rows
    matrix, right, mixed, slopes = (np.sum(parts, axis=0) for parts in zip(*(
        _multiply(np.vstack([nuisances.jacobian[run], own.jacobian[run]]), changes, base.whitened[run].ravel())
        for run, changes in offered.changes.items()
    ), strict=True))  # fmt: skip
    found = {}
    for k in others:
        changes = [each[entries[k]].reshape(offered.candidates[k].sizes, -1) for each in offered.changes.values()]
        squares = np.sum([each @ each.T for each in changes], axis=0)
        normal = whole * np.block([[matrix, mixed[entries[k]].T], [mixed[entries[k]], squares]])
        slope = whole * np.append(right, slopes[entries[k]])
        found[k] = _predict_one(base, offered.candidates[k], normal, slope)
    return found


def _multiply(jacobian: Array, changes: Array, residuals: Array) -> tuple[Array, Array, Array, Array]:
    """Return the products of a run for the normal equations: of the Jacobian, of all changes at once, with each other.

    They are `J J'`, `J r`, `C J'` and `C r`.
    """
    changes = changes.reshape(-1, residuals.size)
    return jacobian @ jacobian.T, jacobian @ residuals, changes @ jacobian.T, changes @ residuals


def _predict_one(base: Evaluation, candidate: Candidate, matrix: Array, right: Array) -> _Prediction:
    """Return the prediction for a candidate, whose sizes are the last components of the normal equations."""
    vector, (low, high) = base.parameters.vector, base.parameters.limits
    count = len(base.parameters.deviations)
    least, most = (candidate.from_nominal(each) for each in (candidate.low, candidate.high))
    size = candidate.from_nominal(candidate.start)
    turns = np.where(size > 0.0, least, -most) < 0.0
    low = np.append(low, np.where(turns, -_STRETCH, 0.0))
    high = np.append(high, np.full(candidate.sizes, _STRETCH))
    start = np.append(vector, np.zeros(candidate.sizes))
    step = solve_step(matrix, right, count, start, low, high)
    cost = base.cost - 2.0 * float(step @ right) + float(step @ matrix @ step)
    return _Prediction(cost, step[: -candidate.sizes], step[-candidate.sizes :])


def _starts_around(base: Parameters, candidate: Candidate, predicted: _Prediction) -> list[Parameters]:
    """Return a base with a candidate where the prediction has its least cost, a limit a little to either side."""
    start, factors = np.array(candidate.start), predicted.factors
    if candidate.is_limit:
        # The action of a limit is not proportional to its size, so only the direction of the prediction is used.
        scaled = [start[:1] * (each if factors[0] < 1.0 else 1.0 / each) for each in _LIMIT_FACTORS]
        starts = [start, *(np.concatenate([sizes, start[1:]]) for sizes in scaled)]
        return [base.add(candidate, np.clip(each, candidate.low, candidate.high)) for each in starts]
    if np.max(np.abs(factors)) <= _LEAST_FACTOR:
        return [base.add(candidate, start)]
    sizes = start[: candidate.sizes] + (factors - 1.0) * candidate.from_nominal(candidate.start)
    there = np.clip(np.concatenate([sizes, start[len(sizes) :]]), candidate.low, candidate.high)
    return [base.move_to(base.vector + predicted.step).add(candidate, there)]
