"""From fitted sets of effects to a verdict: none, known, ambiguous or unknown, with probabilities.

Every hypothesis has a probability (see `seatsim.diagnosis.score`); that of an effect is the sum over the sets with it.
The verdict is the answer that is worth most on average. A right answer is worth 1. Each further name that is given
beside the likeliest, since either may be right, takes its cost off, and so does a set that is wrong.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Literal

from seatsim.diagnosis.movement import group_equivalent, is_material
from seatsim.diagnosis.objective import Evaluation
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.score import list_hypotheses, weigh_hypotheses
from seatsim.diagnosis.select import Selection


def weigh_effects(sets: Sequence[tuple[frozenset[str], float]], effects: Sequence[str]) -> dict[str, float]:
    """Return the probability of each effect.

    Args:
        sets: names of the effects of each set, with the logarithm of its weight.
        effects: names of all effects.
    """
    largest = max((log for _, log in sets), default=0.0)
    weights = [(names, math.exp(log - largest)) for names, log in sets]
    total = sum(weight for _, weight in weights) or 1.0
    return {name: sum(weight for names, weight in weights if name in names) / total for name in effects}


Verdict = Literal["none", "known", "ambiguous", "unknown"]


@dataclasses.dataclass(frozen=True)
class Decision:
    """The verdict with the chosen set, groups of equivalent effects, and probabilities: by effect, none, unknown."""

    verdict: Verdict
    chosen: Evaluation
    groups: list[list[str]]
    probabilities: dict[str, float]
    none: float
    unknown: float


def decide_verdict(problem: DiagnosisProblem, selection: Selection, effects: Sequence[str]) -> Decision:
    """Return the verdict on a selection; `effects` are the names that may be at work."""
    settings, hypotheses = problem.settings.decision, list_hypotheses(problem, selection)
    none, *_, unknown = weights = weigh_hypotheses(hypotheses).tolist()
    sets = [(each.rig, weight) for each, weight in zip(hypotheses, weights, strict=True) if each.rig and each.names]
    chosen, likeliest = max(sets, key=lambda pair: pair[1], default=(selection.calibrated, 0.0))
    others = [pair for pair in sets if pair[0] is not chosen and pair[1] > settings.further_name]
    groups = group_equivalent(chosen, [rig for rig, _ in others])
    named = {name for group in groups for name in group} | chosen.parameters.names
    covered = [weight for rig, weight in others if rig.parameters.names <= named]
    right = likeliest + sum(covered)
    worth = right - settings.further_name * len(covered) - settings.wrong_name * (1.0 - right)
    named_verdict: Verdict = "ambiguous" if groups else "known"
    worths: dict[Verdict, float] = {"none": none, "unknown": unknown, named_verdict: worth if sets else -math.inf}
    verdict = max(worths, key=lambda each: worths[each])
    if verdict == "none" or none > likeliest:
        chosen = selection.calibrated
    probabilities = {name: sum(weight for rig, weight in sets if name in rig.parameters.names) for name in effects}
    return Decision(verdict, chosen, groups if verdict == "ambiguous" else [], probabilities, none, unknown)


def shows_effect(problem: DiagnosisProblem, selection: Selection) -> bool:
    """Whether a single material effect lowers the cost by more than chance does, however little the noise leaves.

    An effect at a few frequencies, such as a preload that shifts the travel, hardly changes the excess of all.
    """
    before = selection.calibrated
    needed = problem.settings.decision.least_lowered * before.rows
    singles = selection.singles.values()
    return any(before.cost - each.cost > needed and is_material(problem, each) for each in singles)
