"""The search for the causes of a gap: noise, selection, decision, localisation; repeated where noise was missed."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import ParamSpec, TypeVar

import numpy as np

from seatsim.diagnosis.candidates import list_candidates
from seatsim.diagnosis.decide import Decision, call_unknown, decide_beside_unknown, decide_verdict
from seatsim.diagnosis.fit import refit_on
from seatsim.diagnosis.localise.discrepancy import describe_discrepancy
from seatsim.diagnosis.localise.disturbance import find_disturbance, put_beside
from seatsim.diagnosis.localise.localisation import localise_remainder, share_gap
from seatsim.diagnosis.movement import measure_gap_taken
from seatsim.diagnosis.noise import differ_materially, measure_broadband, weigh_gap, weigh_noise
from seatsim.diagnosis.objective import Objective
from seatsim.diagnosis.problem import DiagnosisProblem, OutOfTimeError
from seatsim.diagnosis.result import Share
from seatsim.diagnosis.score import Search
from seatsim.diagnosis.select import select_effects
from seatsim.diagnosis.solution import Progress, SearchTask, Solution, search
from seatsim.effects.base import EFFECTS

P = ParamSpec("P")
Found = TypeVar("Found")
_LARGEST_BY_GAP = 2
"""Most effects of a set that is sought under uniform weights."""


def solve(problem: DiagnosisProblem, without: Sequence[str], progress: Progress) -> Solution:
    """Search for the causes; where a random signal may hide them, search beside it too.

    What repeats differ by counts as noise. Where it is material a random effect may make it, which is sought first, and
    where nothing else is found it is itself the gap.

    Args:
        problem: a recording beside its nominal scenario.
        without: names of effects that are withheld from the library.
        progress: called with what is being done.
    """
    differ = differ_materially(problem)
    task, objective = pose_search(problem, without, progress, repeats=not differ)
    found, decided = search_causes(task, objective, without)
    if differ and not (decided.stochastic or problem.deadline.is_past):
        others, second = search_causes(*pose_search(problem, without, progress), without)
        if second.decision.verdict != "none":
            found, decided = others, second
    if decided.decision.verdict != "none" and not is_explained(found, decided.decision):
        # A random signal takes nothing off the gap, however right it is.
        left = decided if decided.stochastic else _call_unknown(decided)
        decided = _in_time(_explain_by_gap, task, found) or left
    # A random signal, and what stands beside an unknown cause, have their blocks already.
    return decided if decided.where else _localise(task, decided)


def search_causes(task: SearchTask, objective: Objective, without: Sequence[str]) -> tuple[Solution, Solution]:
    """Return what is found under the weights of an objective, and beside a broadband residual and a random signal.

    The second solution is decided on all of it.
    """
    found = search(task, objective)
    if found.decision.verdict == "unknown":
        found = _in_time(_search_beyond_broadband, task, found) or found
    if found.decision.verdict == "none" or objective.problem.bench:
        return found, found
    found = found._replace(beside=_in_time(_search_beside_disturbance, task, found, without))
    return found, _decide(task, found) if found.beside else found


def pose_search(
    problem: DiagnosisProblem, without: Sequence[str], progress: Progress, repeats: bool = True
) -> tuple[SearchTask, Objective]:
    """Return the first search of a problem: what is sought, and the weights by noise, with or without `repeats`."""
    effects = [name for name in EFFECTS.names() if name not in without]
    task = SearchTask(list_candidates(problem, without), effects, progress)
    progress("weighing the channels")
    return task, Objective(problem, weigh_noise(problem, repeats))


def _in_time(stage: Callable[P, Found], *arguments: P.args, **named: P.kwargs) -> Found | None:
    """Return what a stage finds, None where the deadline ends it: what was found before it then stands."""
    try:
        return stage(*arguments, **named)
    except OutOfTimeError:
        return None


def is_explained(found: Solution, decision: Decision) -> bool:
    """Whether a set is known, and takes enough of the gap, nominal and calibrated, to be its causes.

    Weights by noise value what an effect improves where signals are weak, which may be next to nothing of the gap.
    """
    objective, selection = found.objective, found.selection
    if decision.verdict == "unknown":
        return False
    taken = [measure_gap_taken(objective, rig, decision.chosen) for rig in (selection.nominal, selection.calibrated)]
    return min(taken) >= objective.settings.decision.least_taken


def _search_beyond_broadband(task: SearchTask, first: Solution) -> Solution:
    """Search again with the broadband residual added to the noise, where most of the remainder is broadband."""
    problem, best = first.objective.problem, first.selection.sets[-1][0]
    errors, weights = measure_broadband(problem, best.residuals), first.objective.weights.weights
    broadband = sum(float(np.sum(power * weights[run] ** 2)) for run, power in errors.items())
    if broadband < problem.settings.noise.broadband_share * best.excess * best.rows:
        return first
    task.progress("counting a broadband residual as noise")
    louder = Objective(problem, first.objective.weights.add(errors))
    second = search(task, louder, first.selection.weigh_again(first.objective, louder))
    return second if second.decision.verdict in ("known", "ambiguous") else first


def _explain_by_gap(task: SearchTask, found: Solution) -> Solution:
    """Return the solution with the sets that a search under uniform weights proposes, or the remainder beside one.

    Where weak signals weigh most a fit may end far from the set that takes all of the gap, so that what is found under
    uniform weights is fitted and judged under those of the noise. Where it does not explain the gap either, its
    likeliest effects are stated beside the unexplained remainder.
    """
    found, uniform = search_by_gap(task, found)
    decided = _decide(task, found)
    if decided.stochastic or is_explained(found, decided.decision):
        return decided
    return _state_beside_unknown(task, _call_unknown(decided), uniform)


def search_by_gap(task: SearchTask, found: Solution) -> tuple[Solution, Search]:
    """Return a search under uniform weights, by which all of the gap counts, and before it the solution with its sets.

    The best of those are fitted again under the weights of the solution.
    """
    task.progress("weighing the gap alone")
    objective, known = found.objective, found.selection
    uniform = Objective(objective.problem, weigh_gap(objective.problem, known.calibrated.residuals))
    rig = known.weigh_again(objective, uniform)
    others = select_effects(uniform, task.candidates, task.progress, _LARGEST_BY_GAP, rig)
    best = others.list_finalists(objective.settings.selection.finalists)
    proposed = [refit_on(objective, known.linearise(each)) for each in best if each.parameters.terms]
    return found._replace(selection=known.propose(proposed)), Search(uniform, others)


def _call_unknown(solution: Solution) -> Solution:
    settings = solution.objective.settings.decision
    return solution._replace(decision=call_unknown(settings, solution.decision))


def _state_beside_unknown(task: SearchTask, first: Solution, search: Search) -> Solution:
    """Return the unexplained remainder with the effects of a search under uniform weights that stand beside it."""
    decision = decide_beside_unknown(first.objective, first.decision, search)
    refitted = refit_on(first.objective, first.selection.linearise(decision.chosen))
    localised = _localise(task, first._replace(decision=dataclasses.replace(decision, chosen=refitted)))
    # The effects are stated as fitted under uniform weights, by which they were found to take the gap.
    return localised._replace(objective=search.objective, selection=search.selection, decision=decision)


def _localise(task: SearchTask, solution: Solution) -> Solution:
    """Return the solution with the blocks that the gap lies in, and the signal of what is unexplained.

    Every answer needs them, so that no deadline ends this stage.
    """
    objective, decision = solution.objective.unhurried, solution.decision
    problem = objective.problem
    if decision.verdict == "none":
        return solution
    if decision.verdict != "unknown":
        return solution._replace(where=share_gap(objective, decision.chosen, None))
    if problem.bench:
        # On a bench only the damper lies between the prescribed motion and the load cell.
        return solution._replace(where=[Share("damper", 1.0)])
    task.progress("asking which block could hold the remainder")
    selection = solution.selection
    remainder = localise_remainder(objective, selection.linearise(decision.chosen))
    found = describe_discrepancy(problem, decision.chosen.parameters, remainder.block, remainder.likeliest)
    return solution._replace(where=share_gap(objective, decision.chosen, remainder), discrepancy=found)


def _search_beside_disturbance(task: SearchTask, first: Solution, without: Sequence[str]) -> Search | None:
    """Return the search beside the disturbance that the sets of a solution may leave; none if it is one `without`."""
    task.progress("asking whether a disturbance hides the effects")
    chosen = None if first.decision.verdict == "unknown" else first.decision.chosen
    disturbance = find_disturbance(first.objective, first.selection, chosen)
    if disturbance is None or disturbance.effect in without:
        return None
    task.progress(f"searching beside {disturbance.effect}")
    beside = put_beside(first.objective, disturbance)
    others = [each for each in task.candidates if each.effect != disturbance.effect]
    rig = first.selection.weigh_again(first.objective, beside)
    rig = rig._replace(sensitivities=rig.sensitivities.without(disturbance.effect))
    return Search(beside, select_effects(beside, others, task.progress, rig=rig), disturbance)


def _decide(task: SearchTask, solution: Solution) -> Solution:
    """Return the solution decided anew on all its sets, those beside a disturbance among them."""
    decision = decide_verdict(solution.searches, task.effects)
    objective, selection, disturbance = decision.search or solution.searches[0]
    if decision.verdict == "unknown" or disturbance is None:
        return solution._replace(decision=decision)
    moved = {disturbance.effect.partition(".")[0]: disturbance.measure_movements(objective.problem)}
    where = share_gap(objective, decision.chosen, None, moved)
    return Solution(objective, selection, decision, where, disturbance.found, disturbance.effect)
