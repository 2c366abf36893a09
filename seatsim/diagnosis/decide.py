"""From fitted sets of effects to a verdict: none, known, ambiguous or unknown, with probabilities.

There is no gap where nothing material is left. Of a gap every hypothesis has a probability (see
`seatsim.diagnosis.score`); that of an effect is the sum over the sets with it. The verdict is the answer that is worth
most on average: a right one is worth 1; each further name that is given beside the likeliest, since either may be
right, takes its cost off, and so does a set that is wrong.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence
from typing import Literal

import numpy as np

from seatsim.diagnosis.fit import fit
from seatsim.diagnosis.movement import group_equivalent, is_material, measure_remainders
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.score import Hypothesis, Search, list_hypotheses, weigh_hypotheses
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.settings.judging import DecisionSettings

Verdict = Literal["none", "known", "ambiguous", "unknown"]
_Answers = Sequence[tuple[Hypothesis, float]]
"""Hypotheses with their probabilities, the likeliest first."""


@dataclasses.dataclass(frozen=True)
class Decision:
    """The verdict with the chosen set, groups of equivalent effects, and probabilities: by effect, none, unknown.

    `search` is the one that found the set.
    """

    verdict: Verdict
    chosen: Evaluation
    groups: list[list[str]]
    probabilities: dict[str, float]
    none: float
    unknown: float
    search: Search | None = None


def decide_verdict(searches: Sequence[Search], effects: Sequence[str]) -> Decision:
    """Return the verdict on searches, the first without a disturbance; `effects` are the names that may be at work."""
    objective, selection, _ = searches[0]
    settings = objective.settings.decision
    if _shows_no_gap(objective.problem, selection):
        rest = (1.0 - settings.none_if_none) / (len(effects) + 1)
        return Decision("none", selection.calibrated, [], dict.fromkeys(effects, rest), settings.none_if_none, rest)
    hypotheses = list_hypotheses(searches)
    *weights, unknown = weigh_hypotheses(hypotheses).tolist()
    answers = _merge_same(list(zip(hypotheses, weights, strict=False)))
    probabilities = _sum_by_effect(answers, effects)
    if not answers:
        return Decision("unknown", selection.calibrated, [], probabilities, 0.0, unknown)
    (chosen, likeliest), *others = answers
    others = [(each, weight) for each, weight in others if weight > settings.further_name]
    groups = group_equivalent(chosen.names, [each.names for each, _ in others if each.search is chosen.search])
    named = chosen.names.union(*groups)
    beside = [weight for each, weight in others if each.names <= named]
    right = likeliest + sum(beside)
    verdict: Verdict = "ambiguous" if groups else "known"
    if unknown > right - settings.further_name * len(beside) - settings.wrong_name * (1.0 - right):
        verdict, groups = "unknown", []
    rig = _fit_named(chosen) or selection.calibrated
    return Decision(verdict, rig, groups, probabilities, 0.0, unknown, chosen.search)


def decide_beside_unknown(objective: Objective, decision: Decision, search: Search) -> Decision:
    """Return the decision `unknown` with effects beside the unknown cause, found by a search under uniform weights.

    `objective` has the weights by noise.
    """
    settings, hypotheses = objective.settings.decision, list_hypotheses([search], objective)
    answers = _merge_same(list(zip(hypotheses, weigh_hypotheses(hypotheses, True).tolist(), strict=True)))
    chosen, groups = _choose_likely(settings, answers)
    rig = _fit_named(chosen) or search.selection.calibrated
    probabilities = _sum_by_effect(answers, decision.probabilities)
    return call_unknown(settings, dataclasses.replace(decision, chosen=rig, groups=groups, probabilities=probabilities))


def call_unknown(settings: DecisionSettings, decision: Decision) -> Decision:
    """Return a decision whose effects stay, but take too little of the gap to be its causes alone."""
    return dataclasses.replace(decision, verdict="unknown", unknown=max(decision.unknown, settings.unknown_if_unknown))


def give_up_effects(problem: DiagnosisProblem, decision: Decision, calibrated: Evaluation) -> Decision:
    """Return the decision without its effects: `unknown`, or `none` where the calibrated rig leaves no material gap."""
    settings, given_up = problem.settings.decision, decision.chosen.parameters.names
    probabilities = {name: 0.0 if name in given_up else value for name, value in decision.probabilities.items()}
    left = dataclasses.replace(decision, chosen=calibrated, groups=[], probabilities=probabilities)
    if np.any(measure_remainders(problem, calibrated) >= settings.material):
        return call_unknown(settings, left)
    return dataclasses.replace(left, verdict="none", none=settings.none_if_none)


def _sum_by_effect(answers: _Answers, effects: Iterable[str]) -> dict[str, float]:
    """Return the probability of each effect: the sum over the sets with it."""
    return {name: sum(weight for each, weight in answers if name in each.names) for name in effects}


def _choose_likely(settings: DecisionSettings, answers: _Answers) -> tuple[Hypothesis, list[list[str]]]:
    """Return the set whose effects are worth most beside an unknown cause, and pairs of effects.

    An effect of probability p that is stated is worth p, less its cost where it is not at work; one that is not stated
    is worth 1 - p. An effect that could stand in the place of a stated one, and is no likelier, is named with it where
    that adds enough to p.
    """
    weights = [(each.names, weight) for each, weight in answers]

    def sum_over(names: Sequence[str]) -> float:
        return sum(weight for others, weight in weights if not others.isdisjoint(names))

    def pair(name: str, stand_ins: Sequence[str]) -> Sequence[str]:
        alone = sum_over([name])
        both = [name, *[other for other in stand_ins if sum_over([other]) <= alone][:1]]
        return both if sum_over(both) - alone > settings.further_name else [name]

    found = []
    for each, _ in answers:
        alike = group_equivalent(each.names, [names for names, _ in weights if names != each.names])
        stand_ins = {name: others for name, *others in alike}
        named = [pair(name, stand_ins.get(name, ())) for name in sorted(each.names)]
        worth = sum(1.0 - (2.0 + settings.wrong_name) * (1.0 - sum_over(names)) for names in named)
        # Of two sets that stand in for each other the one with the likelier effects is stated.
        found.append((worth, sum_over([*each.names]), each, [[*names] for names in named if len(names) > 1]))
    *_, chosen, groups = max(found, key=lambda each: each[:2])
    return chosen, groups


def _merge_same(weighed: _Answers) -> list[tuple[Hypothesis, float]]:
    """Return one hypothesis, the likeliest, for the same effects, as an offset of a sensor and its drift."""
    merged: dict[frozenset[str], tuple[Hypothesis, float]] = {}
    for each, weight in sorted(weighed, key=lambda pair: pair[1]):
        _, before = merged.get(each.names, (each, 0.0))
        merged[each.names] = each, before + weight
    return sorted(merged.values(), key=lambda pair: -pair[1])


def _fit_named(hypothesis: Hypothesis) -> Evaluation | None:
    """Return the rig of a hypothesis, fitted again without those of its effects that are not named."""
    rig, search = hypothesis.rig, hypothesis.search
    if rig is None or search is None or rig.parameters.names <= hypothesis.names:
        return rig
    objective = search.objective.unhurried
    start = objective.evaluate([rig.parameters.remove(*rig.parameters.names - hypothesis.names)])[0]
    return fit(objective, start, search.selection.nuisances)


def _shows_no_gap(problem: DiagnosisProblem, selection: Selection) -> bool:
    """Whether the calibrated rig leaves no gap, or no single effect that reduces the gap is material."""
    calibrated = selection.calibrated
    if calibrated.excess < problem.settings.selection.nothing_left:
        return not _shows_effect(problem, selection)
    if np.any(measure_remainders(problem, calibrated) >= problem.settings.decision.material):
        return False
    # Where every candidate is withheld there is no set of one effect.
    return len(selection.sets) == 1 or not is_material(problem, selection.sets[1][0])


def _shows_effect(problem: DiagnosisProblem, selection: Selection) -> bool:
    """Whether a single material effect lowers the cost by more than chance does, however little the noise leaves.

    An effect at a few frequencies, such as a preload that shifts the travel, hardly changes the excess of all.
    """
    before = selection.calibrated
    needed = problem.settings.decision.least_lowered * before.rows
    singles = selection.singles.values()
    return any(before.cost - each.cost > needed and is_material(problem, each) for each in singles)
