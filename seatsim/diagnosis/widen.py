"""A second search where nominal parameters end at the bounds of their tolerance: these may go farther, once.

A nominal scenario that was fitted without an effect has absorbed part of it, and a tolerance that is stated too small
then forbids the truth: much stays unexplained, or a false effect beside the true one takes what the parameters may not.
The second search is stated only where it leaves clearly less than the first, so that a right tolerance stays what it
is.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from seatsim.diagnosis.answer import list_calibrated
from seatsim.diagnosis.fit import refit
from seatsim.diagnosis.objective import Evaluation, Objective, Parameters
from seatsim.diagnosis.problem import DiagnosisProblem, OutOfTimeError, normalise_rms_errors
from seatsim.diagnosis.solution import Progress, Solution
from seatsim.diagnosis.solve import solve

_THEIRS = {
    "plant.driver_mass": "driver.mass",
    "actuator.rate": "coil.lag",
    "actuator.max_current": "coil.current_limit",
    "damper.parameters.f0": "damper.gas_spring",
    "damper.parameters.k0": "damper.gas_spring",
}
"""Parameters that an effect continues beyond their tolerance, so that they end at a bound where it is at work."""


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
    notes = ["at the bound of their tolerance: " + ", ".join(held.values())]
    settings = problem.settings.widening
    if best.excess <= problem.settings.selection.nothing_left:
        return first, notes
    start, judge = _widen(first.objective, best.parameters, list(held))
    stated = first
    try:
        left = _share_left(problem, best, refit(judge, start))
        if left <= settings.clearly_less:
            progress("searching again with a wider tolerance of parameters at their bounds")
            second = solve(judge.problem.as_recorded(), without, progress)
            left = _share_left(problem, best, judge.evaluate([second.decision.chosen.parameters])[0])
            stated = second if left <= settings.clearly_less else first
    except OutOfTimeError:
        return first, notes
    told = "which is not clearly less: the stated tolerance holds"
    if stated is not first:
        told = "as is stated here; check the nominal values, or state a wider tolerance"
    said = f"{100.0 * left:.0f} % of the remainder stays"
    return stated, [*notes, f"with {settings.factor:g} times the tolerance of these parameters {said}, {told}"]


def find_at_bound(problem: DiagnosisProblem, parameters: Parameters) -> dict[int, str]:
    """Return a phrase on each nuisance parameter at its bound, with nominal value and bound, by its index.

    A parameter that an effect of the rig continues beyond its tolerance is left out.
    """
    listed = list_calibrated(problem.parameters, parameters.deviations)
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


def _share_left(problem: DiagnosisProblem, first: Evaluation, second: Evaluation) -> float:
    """Return the share of what the first rig leaves that the second leaves: of the excess or of the gap, the larger."""
    errors = [float(np.mean(normalise_rms_errors(problem, each.residuals) ** 2)) for each in (first, second)]
    return max(second.excess / first.excess, errors[1] / errors[0])
