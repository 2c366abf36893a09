"""A second search where nominal parameters end at the bounds of their tolerance: these may go farther, once.

A nominal scenario that was fitted without an effect has absorbed part of it, and a tolerance that is stated too small
then forbids the truth: much stays unexplained, or a false effect beside the true one takes what the parameters may not.
The second search is stated only where it leaves clearly less than the first, or explains as much by fewer effects, so
that a right tolerance stays what it is.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.answer import list_calibrated
from seatsim.diagnosis.fit import refit
from seatsim.diagnosis.objective import Evaluation, Objective, Parameters
from seatsim.diagnosis.problem import DiagnosisProblem, OutOfTimeError, normalise_rms_errors
from seatsim.diagnosis.solution import Progress, Solution
from seatsim.diagnosis.solve import solve

_Search = Callable[[], Solution]
_THEIRS = {
    "plant.driver_mass": "driver.mass",
    "actuator.rate": "coil.lag",
    "actuator.max_current": "coil.current_limit",
    "damper.parameters.f0": "damper.gas_spring",
    "damper.parameters.k0": "damper.gas_spring",
}
"""Parameters that an effect continues beyond their tolerance, so that they end at a bound where it is at work."""


class _Wider(NamedTuple):
    """The first solution's best set, the same rig where parameters at their bounds may go farther, and its measure."""

    best: Evaluation
    start: Parameters
    judge: Objective

    def evaluate(self, solution: Solution) -> Evaluation:
        """Return what a solution leaves, by the weights of the first."""
        return self.judge.evaluate([solution.decision.chosen.parameters])[0]


def search_wider(first: Solution, without: Sequence[str], progress: Progress) -> tuple[Solution, list[str]]:
    """Return the solution to state, and sentences on parameters at their bounds and on what a second search found.

    Args:
        first: the solution within the stated tolerances.
        without: names of effects that are withheld from the library.
        progress: called with what is being done.
    """
    problem = first.objective.problem
    best = min(first.decision.chosen, first.selection.sets[-1][0], key=lambda each: each.excess)
    held = find_at_bound(problem, best.parameters)
    if not held:
        return first, []
    factor = problem.settings.widening.factor
    start, judge = _widen(first.objective, best.parameters, list(held))

    def search() -> Solution:
        progress("searching again with a wider tolerance of parameters at their bounds")
        return solve(judge.problem.as_recorded(), without, progress)

    attempt = _leave_less if best.excess > problem.settings.selection.nothing_left else _need_fewer
    notes = ["at the bound of their tolerance: " + ", ".join(held.values())]
    try:
        second, said = attempt(_Wider(best, start, judge), search, len(held))
    except OutOfTimeError:
        return first, notes
    if said:
        told = "this is stated here; check the nominal values, or state a wider tolerance"
        told = told if second else "the stated tolerance holds"
        notes.append(f"with {factor:g} times the tolerance of these parameters {said}: {told}")
    return second or first, notes


def _leave_less(wider: _Wider, search: _Search, held: int) -> tuple[Solution | None, str]:
    """Return the second solution where it leaves clearly less than the first, with words on what it leaves."""
    settings, second = wider.judge.settings.widening, None
    left = _share_left(wider, refit(wider.judge, wider.start))
    if left < settings.promising:
        second = search()
        left = _share_left(wider, wider.evaluate(second))
    said = f"{100.0 * left:.0f} % of the remainder stays"
    return (second, said) if left <= settings.clearly_less else (None, f"{said}, which is not clearly less")


def _need_fewer(wider: _Wider, search: _Search, held: int) -> tuple[Solution | None, str]:
    """Return the second solution where fewer effects leave nothing to explain, with words on that."""
    terms, little = wider.start.terms, wider.judge.settings.selection.nothing_left
    if len(terms) < 2 or held < wider.judge.settings.widening.strained:
        return None, ""
    smaller = [refit(wider.judge, wider.start.remove(term.effect)) for term in terms]
    if min(each.excess for each in smaller) > little:
        return None, "all effects found are needed"
    second = search()
    found = wider.evaluate(second)
    fewer = 0 < len(found.parameters.terms) < len(terms) and found.excess <= little
    return (second, "fewer effects explain as much") if fewer else (None, "fewer effects do not explain as much")


def find_at_bound(problem: DiagnosisProblem, parameters: Parameters) -> dict[int, str]:
    """Return a phrase on each nuisance parameter at its bound, with nominal value and bound, by its index.

    A parameter that an effect of the rig continues beyond its tolerance is left out.
    """
    listed = list_calibrated(problem.parameters, parameters.deviations, problem.settings.widening.at_bound)
    return {
        k: f"{each.name} {each.nominal:.4g} (fitted {each.value:.4g})"
        for k, each in enumerate(listed)
        if each.at_bound and _THEIRS.get(each.name) not in parameters.names
    }


def _widen(objective: Objective, parameters: Parameters, held: Sequence[int]) -> tuple[Parameters, Objective]:
    """Return the same rig where some parameters have a wider tolerance, and the objective with that tolerance."""
    problem = objective.problem
    factors = np.ones(len(problem.parameters))
    factors[list(held)] = problem.settings.widening.factor
    pairs = zip(problem.parameters, factors.tolist(), strict=True)
    wider = tuple(each._replace(tolerance=factor * each.tolerance) for each, factor in pairs)
    same = dataclasses.replace(parameters, deviations=parameters.deviations / factors)
    return same, Objective(dataclasses.replace(problem, parameters=wider), objective.weights)


def _share_left(wider: _Wider, second: Evaluation) -> float:
    """Return the share of what the first rig leaves that the second leaves: of the excess or of the gap, the larger."""
    both, problem = (wider.best, second), wider.judge.problem
    errors = [float(np.mean(normalise_rms_errors(problem, each.residuals) ** 2)) for each in both]
    return max(second.excess / wider.best.excess, errors[1] / errors[0])
