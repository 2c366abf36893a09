"""A search for effects, the solution that it returns, and its decision revised by what is found later."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import softmax

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.decide import Decision, decide_verdict
from seatsim.diagnosis.localise.discrepancy import Discrepancy
from seatsim.diagnosis.movement import group_equivalent, measure_remainders
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.result import Share
from seatsim.diagnosis.score import Search
from seatsim.diagnosis.select import LinearisedRig, Selection, select_effects
from seatsim.diagnosis.settings.judging import DecisionSettings

Progress = Callable[[str], object]


class SearchTask(NamedTuple):
    """Inputs of a search: the candidates, the names of all effects, and the progress callback."""

    candidates: Sequence[Candidate]
    effects: Sequence[str]
    progress: Progress


class Solution(NamedTuple):
    """A selection with its decision, the blocks that the gap lies in, and the discrepancy, if anything is unexplained.

    `stochastic` is the effect, if any, whose signal is that discrepancy; `beside` holds the searches beside a
    disturbance.
    """

    objective: Objective
    selection: Selection
    decision: Decision
    where: Sequence[Share] = ()
    discrepancy: Discrepancy | None = None
    stochastic: str = ""
    beside: Sequence[Search] = ()


def search(task: SearchTask, objective: Objective, rig: LinearisedRig | None = None) -> Solution:
    """Select effects under the weights of an objective and decide; `rig` is the linearised rig where it is known."""
    selection = select_effects(objective, task.candidates, task.progress, rig=rig)
    decision = decide_verdict([Search(objective, selection)], task.effects)
    return Solution(objective, selection, decision)


def call_unknown(settings: DecisionSettings, decision: Decision) -> Decision:
    """Return a decision whose effects stay, but take too little of the gap to be its causes alone."""
    return dataclasses.replace(decision, verdict="unknown", unknown=max(decision.unknown, settings.unknown_if_unknown))


def decide_beside_unknown(
    settings: DecisionSettings,
    decision: Decision,
    chosen: Evaluation,
    equivalent: Sequence[Evaluation] = (),
    tried: Sequence[tuple[Evaluation, float]] = (),
) -> Decision:
    """Return the decision `unknown` with another set of effects stated beside the unknown cause.

    Args:
        settings: thresholds.
        decision: the decision so far.
        chosen: the set to be stated, possibly none.
        equivalent: sets that do as well.
        tried: sets with the logarithm of the weight that runs left out of its fit give each.
    """
    # Where no effect helps enough to be stated, the single ones are still ranked by how much they help.
    size = max(1, len(chosen.parameters.terms))
    compared = [(each.parameters.names, weight) for each, weight in tried if len(each.parameters.terms) <= size]
    probabilities = weigh_effects(compared, list(decision.probabilities))
    groups = group_equivalent(chosen.parameters.names, [each.parameters.names for each in equivalent])
    stated = dataclasses.replace(decision, chosen=chosen, groups=groups, probabilities=probabilities)
    return call_unknown(settings, stated)


def weigh_effects(sets: Sequence[tuple[frozenset[str], float]], effects: Sequence[str]) -> dict[str, float]:
    """Return the probability of each effect, from the names of sets with the logarithm of the weight of each."""
    weights = softmax([log for _, log in sets]).tolist() if sets else []
    known = [(names, weight) for (names, _), weight in zip(sets, weights, strict=True)]
    return {name: sum(weight for names, weight in known if name in names) for name in effects}


def give_up_effects(problem: DiagnosisProblem, decision: Decision, calibrated: Evaluation) -> Decision:
    """Return the decision without its effects: `unknown`, or `none` where the calibrated rig leaves no material gap."""
    settings, given_up = problem.settings.decision, decision.chosen.parameters.names
    probabilities = {name: 0.0 if name in given_up else value for name, value in decision.probabilities.items()}
    left = dataclasses.replace(decision, chosen=calibrated, groups=[], probabilities=probabilities)
    if np.any(measure_remainders(problem, calibrated) >= settings.material):
        return call_unknown(settings, left)
    return dataclasses.replace(left, verdict="none", none=settings.none_if_none)
