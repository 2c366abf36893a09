"""Cross-validation: which effects reduce the gap of runs left out of the fit, where no set explains the gap.

Where the structure of the nominal model is wrong at all frequencies, as with a real rig, even the best model leaves far
more than noise. Weights by noise then rank effects by what they improve at the frequencies with the weakest signals.
The gap is used instead: all frequencies weigh the same, and an effect is valued by how much it reduces the gap of runs
left out of its fit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.fit import find_step, fit
from seatsim.diagnosis.movement import is_material
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective, Parameters
from seatsim.diagnosis.problem import normalise_rms_errors
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.uncertainty import estimate_standard_deviations
from seatsim.schema.arrays import Array

_SETS_COMPARED = 8
"""Sets of each size that are cross-validated; more take more time."""
_FOLDS = 3
"""Parts of the runs that are left out in turn."""
_LAG, _SURE = "sensor.lag", 2.0
"""The lag of a sensor, and the standard deviations from which it is no chance."""
_DOUBTFUL = 1.5
"""Factor by which a run left out may get worse before the step of the other runs is checked and shortened."""


class _Supported(NamedTuple):
    """What runs left out support: a set, sets that help as much, and all sets tried, with the logarithm of the weight.

    That weight is of the square of the share of the gap that stays, pooled over the runs, of the rig without effects.
    """

    chosen: Evaluation
    equivalent: list[Evaluation]
    tried: list[tuple[Evaluation, float]]


def select_by_cross_validation(objective: Objective, selection: Selection) -> _Supported:
    """Return the smallest set of effects that no larger one improves on left-out runs, and sets that help as much.

    A larger set is chosen as long as its evidence is higher; one without the effect chosen so far, a rival explanation,
    only where the evidence decides: a tie goes to the simpler explanation.
    """
    settings, problem = objective.settings.cross_validation, objective.problem
    chosen, equivalent = selection.calibrated, list[Evaluation]()
    alone = cross_validate(objective, chosen, selection.nuisances)
    before = _charge(objective, chosen, 1.0)
    found = [(chosen, before)]
    for sets in selection.sets[1:]:
        compared = [
            each
            for each in sets[:_SETS_COMPARED]
            if is_material(problem, each) and _shows_lags(objective, each, selection.nuisances)
        ]
        tried = []
        for each in compared:
            after = cross_validate(objective, each, selection.nuisances)
            tried.append((each, _charge(objective, each, float(np.mean(after**2) / np.mean(alone**2)))))
        found += tried
        best = sorted(_list_equals(objective, tried), key=lambda each: (_count_sensors(each[0]), each[1]))
        if not best:
            break
        is_rival = not chosen.parameters.names <= best[0][0].parameters.names
        margin = math.log(settings.equivalent) if is_rival else 0.0
        # Sets that help as much are one answer, worth all of their evidence.
        weight = np.logaddexp.reduce([_weigh(objective, *each) for each in best])
        if weight < _weigh(objective, chosen, before) + margin:
            break
        (chosen, before), equivalent = best[0], [evaluation for evaluation, _ in best[1:]]
    return _Supported(chosen, equivalent, [(each, _weigh(objective, each, left)) for each, left in found])


def _shows_lags(objective: Objective, evaluation: Evaluation, nuisances: Linearisation) -> bool:
    """Whether a sensor's lag in a set is larger than chance and the errors of the rig's form make it.

    A small one stands in for whatever turns the phase of a loop that the rig lacks.
    """
    if _LAG not in evaluation.parameters.names:
        return True
    rig, deviations = evaluation.parameters, estimate_standard_deviations(objective, evaluation, nuisances)
    parts = zip(rig.terms, rig.values, rig.split(deviations), strict=True)
    term, values, chance = next(each for each in parts if each[0].effect == _LAG)
    sizes = np.abs(term.from_nominal(values.tolist()))
    return bool(np.any(sizes >= _SURE * (term.scale * chance)[: term.sizes]))


def _list_equals(objective: Objective, tried: Sequence[tuple[Evaluation, float]]) -> list[tuple[Evaluation, float]]:
    """Return the sets between which the evidence does not decide, either by what they leave or with the prior odds."""
    settings = objective.settings.cross_validation
    least = min((left for _, left in tried), default=0.0) * settings.equivalent ** (1.0 / settings.power)
    weights = [_weigh(objective, each, left) for each, left in tried]
    weight = max(weights, default=0.0) - math.log(settings.equivalent)
    return [pair for pair, own in zip(tried, weights, strict=True) if pair[1] < least or own > weight]


def _weigh(objective: Objective, evaluation: Evaluation, left: float) -> float:
    """Return the logarithm of a set's evidence, `prior_1 ... prior_n left^-power`.

    It is that of a model whose noise is known but for its level, tempered: of the many numbers that are compared only
    `2 power` count as independent, since what even a right set leaves is the error of an effect's form.
    """
    settings, sensors = objective.settings.cross_validation, _count_sensors(evaluation)
    others = len(evaluation.parameters.terms) - sensors
    priors = sensors * math.log(settings.prior_of_sensor) + others * math.log(settings.prior)
    return priors - settings.power * math.log(left)


def _charge(objective: Objective, evaluation: Evaluation, left: float) -> float:
    """Return what a set leaves, raised by as much as its parameters lower the evidence.

    Nuisance parameters cost their prior, further parameters of effects what the weights by the gap charge for them.
    """
    prior = objective.measure_prior(evaluation.parameters)
    return left * evaluation.charge * math.exp(0.5 * prior / objective.settings.cross_validation.power)


def _count_sensors(evaluation: Evaluation) -> int:
    """Return how many sensors err, which decides between equals: a change of the rig is a more useful answer."""
    return sum(term.block == "sensor" for term in evaluation.parameters.terms)


def cross_validate(objective: Objective, evaluation: Evaluation, nuisances: Linearisation) -> Array:
    """Return the gap of each run under a set of effects fitted without it, in standard deviations, shape (runs,).

    A fit over all runs moves by one Gauss-Newton step as a run is left out. `nuisances` are the sensitivities to the
    nuisance parameters over all runs.
    """
    problem = objective.problem
    if len(problem.runs) == 1:
        return normalise_rms_errors(problem, evaluation.residuals)
    own, residuals = objective.linearise_effects(evaluation).jacobian, dict[str, Array]()
    for k in range(min(_FOLDS, len(problem.runs))):
        left_out, others = problem.runs[k::_FOLDS], [run for j, run in enumerate(problem.runs) if j % _FOLDS != k]
        step = find_step(evaluation, nuisances, {run: own[run] for run in others})
        moved = evaluation.parameters.move_to(evaluation.parameters.vector + step)
        residuals |= _foresee(objective, evaluation, nuisances, left_out, moved)
    return normalise_rms_errors(problem, residuals)


def _foresee(
    objective: Objective, evaluation: Evaluation, nuisances: Linearisation, left_out: Sequence[str], moved: Parameters
) -> dict[str, Array]:
    """Return the residuals of runs left out of a fit, which `moved` is the result of to first order.

    Where a law is far from linear, as with free play, that whole step may raise even what the other runs leave. Runs
    that it makes much worse are foreseen again with a step that was shortened until the others agree.
    """
    there = objective.on_runs(left_out)
    found = there.evaluate([moved])[0]
    if found.cost <= _DOUBTFUL * there.weigh_again(evaluation).cost:
        return found.residuals
    part = objective.on_runs([run for run in objective.problem.runs if run not in left_out])
    shortened = fit(part, part.weigh_again(evaluation), nuisances, steps=1)
    return there.evaluate([shortened.parameters])[0].residuals
