"""Cross-validation: which effects reduce the gap of runs left out of the fit, where no set explains the gap.

Where the structure of the nominal model is wrong at all frequencies, as with a real rig, even the best model leaves far
more than noise. Weights by noise then rank effects by what they improve at the frequencies with the weakest signals.
The gap is used instead: all frequencies weigh the same, and an effect is valued by how much it reduces the gap of runs
left out of its fit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.fit import fit
from seatsim.diagnosis.movement import is_material
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective
from seatsim.diagnosis.problem import normalise_rms_errors
from seatsim.diagnosis.select import Selection

Array = NDArray[np.float64]


class Supported(NamedTuple):
    """What runs left out support: a set, sets that help as much, and all sets tried, with what they leave.

    That is the square of the share of the gap that stays, mean over the runs, of the rig without effects.
    """

    chosen: Evaluation
    equivalent: list[Evaluation]
    tried: list[tuple[Evaluation, float]]


def select_by_cross_validation(objective: Objective, selection: Selection) -> Supported:
    """Return the smallest set of effects that no larger one improves on left-out runs, and sets that help as much."""
    settings, problem = objective.settings.cross_validation, objective.problem
    chosen, equivalent = selection.calibrated, list[Evaluation]()
    alone = before = cross_validate(objective, chosen, selection.linearise_nuisances(objective, chosen))
    found = [(chosen, 1.0)]
    for sets in selection.sets[1:]:
        compared = sets[: settings.sets_compared]
        nuisances = selection.linearise_nuisances(objective, sets[0])
        tried = [(each, cross_validate(objective, each, nuisances)) for each in compared if is_material(problem, each)]
        found += [(each, float(np.mean(after / alone) ** 2)) for each, after in tried]
        gains = [float(np.mean(1.0 - after / before)) for _, after in tried]
        if max(gains, default=0.0) < settings.least_gain:
            break
        best = [each for each, gain in zip(tried, gains, strict=True) if gain > max(gains) - settings.equivalent]
        best.sort(key=lambda each: _complexity(each[0]))
        (chosen, before), equivalent = best[0], [evaluation for evaluation, _ in best[1:]]
    return Supported(chosen, equivalent, found)


def _complexity(evaluation: Evaluation) -> tuple[int, int]:
    """Return what decides between sets that help equally: how many sensors err, and how many parameters are free.

    A change of the rig is a more useful answer than a wrong sensor, and a law with fewer parameters a likelier one.
    """
    terms = evaluation.parameters.terms
    return sum(term.block == "sensor" for term in terms), sum(len(term.free) for term in terms)


def cross_validate(objective: Objective, evaluation: Evaluation, nuisances: Linearisation) -> Array:
    """Return the gap of each run under a set of effects fitted without it, in standard deviations, shape (runs,).

    `nuisances` are the sensitivities to the nuisance parameters over all runs; those of a fit are of its own runs.
    """
    problem = objective.problem
    if len(problem.runs) == 1:
        return normalise_rms_errors(problem, evaluation.residuals)
    errors = np.zeros(len(problem.runs))
    folds = objective.settings.cross_validation.folds
    for k in range(min(folds, len(problem.runs))):
        others = [run for j, run in enumerate(problem.runs) if j % folds != k]
        part = objective.on_runs(others)
        fitted = fit(part, part.evaluate([evaluation.parameters])[0], nuisances)
        left_out = objective.evaluate([fitted.parameters])[0]
        errors[k::folds] = normalise_rms_errors(problem, left_out.residuals)[k::folds]
    return errors
