"""A second search where nominal parameters end at the bounds of their tolerance: these may go farther, once.

A nominal scenario that was fitted without an effect has absorbed part of it, and a tolerance that is stated too small
then forbids the truth. The second search is stated only where it leaves clearly less than the first, so that a right
tolerance stays what it is.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np

from seatsim.diagnosis.fit import refit
from seatsim.diagnosis.nuisance import Nuisance
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.parameters import Parameters
from seatsim.diagnosis.problem import DiagnosisProblem, normalise_rms_errors
from seatsim.diagnosis.solve import Method, Solution, solve


def search_wider(
    first: Solution, without: Sequence[str], progress: Callable[[str], object], method: Method
) -> tuple[Solution, list[str]]:
    """Return the solution to state, and sentences on parameters at their bounds and on what a second search found.

    Args:
        first: the solution within the stated tolerances.
        without: names of effects that are withheld from the library.
        progress: called with what is being done.
        method: the stages of the search.
    """
    problem, best = first.objective.problem, _find_best(first)
    held = find_at_bound(problem, best.parameters)
    if not held:
        return first, []
    notes = ["at the bound of their tolerance: " + ", ".join(held.values())]
    settings = problem.settings.widening
    if best.excess < problem.settings.selection.nothing_left:
        return first, notes
    wider, start = _widen(problem, best.parameters, list(held))
    judge = Objective(wider, first.objective.weights)
    left, second = _share_left(judge, best, refit(judge, start)), None
    if left < settings.promising:
        progress("searching again with a wider tolerance of parameters at their bounds")
        second = solve(wider, without, progress, method)
        left = _share_left(judge, best, judge.evaluate([second.decision.chosen.parameters])[0])
    said = (
        f"with {settings.factor:g} times the tolerance of these parameters {100.0 * left:.0f} % of the remainder stays"
    )
    if second is None or left > settings.clearly_less:
        return first, [*notes, f"{said}, which is not clearly less: the stated tolerance holds"]
    return second, [*notes, f"{said}, which is stated here; check the nominal values, or state a wider tolerance"]


def find_at_bound(problem: DiagnosisProblem, parameters: Parameters) -> dict[int, str]:
    """Return a phrase on each nuisance parameter at its bound, with nominal value, value and bound, by its index."""
    found = {}
    for k, deviation in enumerate(parameters.deviations):
        if abs(deviation) >= problem.settings.widening.at_bound:
            each = problem.parameters[k]
            bound = each.at(float(np.sign(deviation)))
            found[k] = f"{each.key} {each.nominal:.4g} (fitted {each.at(deviation):.4g}, bound {bound:.4g})"
    return found


def _find_best(first: Solution) -> Evaluation:
    """Return the set that leaves least, whether it was chosen or its effects were not supported by runs left out."""
    return min(first.decision.chosen, first.selection.sets[-1][0], key=lambda each: each.excess)


def _widen(
    problem: DiagnosisProblem, parameters: Parameters, held: Sequence[int]
) -> tuple[DiagnosisProblem, Parameters]:
    """Return the problem with a wider tolerance of some parameters, and the same rig in it."""
    factors = np.ones(len(problem.parameters))
    factors[list(held)] = problem.settings.widening.factor
    wider: list[Nuisance] = [
        each._replace(tolerance=factor * each.tolerance)
        for each, factor in zip(problem.parameters, factors, strict=True)
    ]
    same = dataclasses.replace(parameters, deviations=parameters.deviations / factors)
    return dataclasses.replace(problem, parameters=tuple(wider)), same


def _share_left(judge: Objective, first: Evaluation, second: Evaluation) -> float:
    """Return the share of what the first rig leaves that the second leaves: of the excess or of the gap, the larger."""
    errors = [float(np.mean(normalise_rms_errors(judge.problem, each.residuals) ** 2)) for each in (first, second)]
    return max(second.excess / first.excess, errors[1] / errors[0])
