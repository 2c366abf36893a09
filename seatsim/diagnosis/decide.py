"""From fitted sets of effects to a verdict: none, known, ambiguous or unknown, with probabilities.

The thresholds hold for the whitened excess, which is 0 where only noise is left, and for movements in standard
deviations of a channel. Probabilities come from tempered evidences of the sets that were fitted. A set of n effects
that leaves a mean square m has the weight

    w = prior_1 ... prior_n m^-power,

the evidence of a model whose noise is known but for its level, tempered: of the many numbers that are compared only
`2 power` count as independent, since what even a right set leaves is the error of an effect's form, which all of them
share. An effect's probability is the share of the weight that lies in sets with it, whatever else stays unexplained.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from seatsim.diagnosis.movement import group_equivalent, is_material, measure_remainders, measure_shares_left
from seatsim.diagnosis.objective import Evaluation
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.settings.judging import DecisionSettings

_SENSORS = "sensor."
"""How the names of effects begin by which a sensor errs."""


class Evidence(NamedTuple):
    """What a set of effects is worth: prior odds of an effect of the rig and of a sensor, and the power above."""

    prior: float
    prior_of_sensor: float
    power: float

    def weigh(self, names: frozenset[str], left: float) -> float:
        """Return the logarithm of the weight of a set of effects that leaves a mean square."""
        priors = [self.prior_of_sensor if name.startswith(_SENSORS) else self.prior for name in names]
        return sum(math.log(prior) for prior in priors) - self.power * math.log(left)


def weigh_effects(
    sets: Sequence[tuple[frozenset[str], float]], effects: Sequence[str], bounds: tuple[float, float]
) -> dict[str, float]:
    """Return the probability of each effect, within the bounds that are permitted.

    Args:
        sets: names of the effects of each set, with the logarithm of its weight.
        effects: names of all effects.
        bounds: least and greatest probability.
    """
    largest = max((log for _, log in sets), default=0.0)
    weights = [(names, math.exp(log - largest)) for names, log in sets]
    total = sum(weight for _, weight in weights) or 1.0
    shares = {name: sum(weight for names, weight in weights if name in names) / total for name in effects}
    least, most = bounds
    return {name: min(max(share, least), most) for name, share in shares.items()}


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
    settings, before = problem.settings.decision, selection.calibrated.excess
    if _shows_no_gap(problem, selection):
        excess = before - problem.settings.selection.nothing_left
        sure = max(_logistic(settings.none_offset - excess / settings.none_width), settings.none_least)
        probabilities = dict.fromkeys(effects, settings.effect_if_none)
        return Decision("none", selection.calibrated, [], probabilities, sure, settings.unknown_if_none)
    selection = _drop_immaterial(problem, selection)
    chosen = _choose_set(problem, selection)
    # Of a gap that hardly shows in the excess of all frequencies, sets differ by as little.
    scale = min(1.0, before / problem.settings.selection.nothing_left)
    groups = group_equivalent(chosen, _list_equivalent(settings, selection, chosen, scale))
    share = chosen.excess / before
    explained = _explains(problem, selection.calibrated, chosen, groups)
    unknown = _logistic(
        (math.log(max(share, settings.least_share)) - math.log(settings.explained)) / settings.unknown_width
    )
    least, most = settings.unknown_if_known
    unknown = min(max(unknown, least), most) if explained else max(unknown, settings.unknown_if_unknown)
    groups = groups if explained else []
    verdict: Verdict = ("ambiguous" if groups else "known") if explained else "unknown"
    probabilities = weigh_effects(_weigh_compared(settings, selection, chosen, scale), effects, settings.effect_bounds)
    return Decision(verdict, chosen, groups, probabilities, settings.none_if_gap, unknown)


def explain_after_all(
    problem: DiagnosisProblem, calibrated: Evaluation, chosen: Evaluation, decision: Decision
) -> Decision:
    """Return the decision beside an unknown cause, or `known` or `ambiguous` where its set explains the gap after all.

    Args:
        problem: the recording beside its nominal scenario.
        calibrated: the rig without effects.
        chosen: the set, found by another search and weighed as the calibrated rig is.
        decision: the decision beside an unknown cause, with that set.
    """
    if not _explains(problem, calibrated, chosen, decision.groups):
        return decision
    verdict: Verdict = "ambiguous" if decision.groups else "known"
    return dataclasses.replace(decision, verdict=verdict, unknown=problem.settings.decision.unknown_if_known[0])


def shows_effect(problem: DiagnosisProblem, selection: Selection) -> bool:
    """Whether a single material effect lowers the cost by more than chance does, however little the noise leaves.

    An effect at a few frequencies, such as a preload that shifts the travel, hardly changes the excess of all.
    """
    before = selection.calibrated
    needed = problem.settings.decision.least_lowered * before.rows
    singles = selection.singles.values()
    return any(before.cost - each.cost > needed and is_material(problem, each) for each in singles)


def _drop_immaterial(problem: DiagnosisProblem, selection: Selection) -> Selection:
    """Return the selection without sets that hold an immaterial effect, up to the first size of which none is left.

    Beyond the best set of a size, only those are asked that could be equivalent to it; others are neither chosen nor
    named.
    """
    settings, kept = problem.settings.decision, [selection.sets[0]]
    for sets in selection.sets[1:]:
        first = next((k for k, each in enumerate(sets) if is_material(problem, each)), None)
        if first is None:
            break
        best, *others = sets[first:]
        limit = settings.equivalent * best.excess + settings.equivalent_floor
        kept.append((best, *(each for each in others if each.excess > limit or is_material(problem, each))))
    return dataclasses.replace(selection, sets=tuple(kept))


def _shows_no_gap(problem: DiagnosisProblem, selection: Selection) -> bool:
    """Whether the calibrated rig leaves no gap, or no single effect that reduces the gap is material."""
    calibrated = selection.calibrated
    if calibrated.excess < problem.settings.selection.nothing_left:
        return calibrated.excess == 0.0 or not shows_effect(problem, selection)
    if np.any(measure_remainders(problem, calibrated) >= problem.settings.decision.material):
        return False
    # Where every candidate is withheld there is no set of one effect.
    return len(selection.sets) == 1 or not is_material(problem, selection.sets[1][0])


def _explains(
    problem: DiagnosisProblem, calibrated: Evaluation, chosen: Evaluation, groups: Sequence[Sequence[str]]
) -> bool:
    """Whether a set of effects explains the gap: little of its excess is left everywhere, or nothing material at all.

    A set that takes most of the gap may leave more of the excess, which weighs weak signals as much as strong ones.

    A long group of equivalent effects under a small remainder means that the data hardly show which effect it is.
    """
    if not chosen.parameters.terms:
        return False
    settings = problem.settings.decision
    is_short = all(len(group) <= settings.equivalent_members for group in groups)
    after = measure_remainders(problem, chosen)
    if np.all(after < settings.material) and is_short:
        return True
    shares, left = measure_shares_left(problem, calibrated, chosen), chosen.excess / calibrated.excess
    before = measure_remainders(problem, calibrated)
    takes_most = is_short and np.linalg.norm(after) < (1.0 - settings.most_taken) * np.linalg.norm(before)
    little = settings.left_if_taken if takes_most else settings.explained
    return left < little and all(share < settings.left_in_channel for share in shares)


def _choose_set(problem: DiagnosisProblem, selection: Selection) -> Evaluation:
    """Return the smallest set that no enlargement beats by enough."""
    settings, chosen = problem.settings, selection.calibrated
    for better, *_ in selection.sets[1:]:
        if not _enlarges(problem, selection.calibrated, chosen, better):
            if chosen.parameters.terms:
                break
            # Two effects may explain together what neither does alone, so a first one that helps only a little is kept.
            if better.excess > settings.decision.first_effect_helps * chosen.excess:
                continue
        chosen = better
        if chosen.excess < settings.selection.nothing_left:
            break
    return chosen


def _enlarges(problem: DiagnosisProblem, calibrated: Evaluation, chosen: Evaluation, better: Evaluation) -> bool:
    """Whether a larger set leaves clearly less, overall or in one channel with a material gap, so that it is accepted.

    A model error of the first effect must not hide a second one. So it also suffices that one channel is explained, or,
    where the smaller set explains the recording already, that both the excess and the gap fall.
    """
    settings, enlarge = problem.settings.selection, problem.settings.selection.enlarge
    if better.excess <= enlarge * chosen.excess:
        return True
    explained = chosen.excess < problem.settings.decision.explained * calibrated.excess
    if explained and better.excess <= settings.enlarge_explained * chosen.excess:
        before, after = (np.linalg.norm(measure_remainders(problem, each)) for each in (chosen, better))
        return bool(after <= settings.gap_lowered * before)
    return bool(chosen.parameters.terms) and any(
        left <= enlarge for left in measure_shares_left(problem, chosen, better)
    )


def _list_equivalent(
    settings: DecisionSettings, selection: Selection, chosen: Evaluation, scale: float
) -> list[Evaluation]:
    """Return the sets of as many effects that fit as well, the chosen one among them.

    `scale` is the factor on the margin of the excess, below 1 for a gap that hardly shows in it.
    """
    limit = settings.equivalent * chosen.excess + settings.equivalent_floor * scale
    others = selection.sets[len(chosen.parameters.terms)]
    return [evaluation for evaluation in others if evaluation.excess <= limit]


def _weigh_compared(
    settings: DecisionSettings, selection: Selection, chosen: Evaluation, scale: float
) -> list[tuple[frozenset[str], float]]:
    """Return the chosen set and all that are no larger and leave no less, by names, with the logarithm of each weight.

    Sets that leave less were passed over, since an effect of theirs is immaterial.
    """
    # Where the noise is known, a sensor is found to err as surely as any other part.
    evidence = Evidence(settings.prior, settings.prior, settings.power)
    size = len(chosen.parameters.terms)
    others = [
        each for sets in selection.sets[: size + 1] for each in sets if each.excess >= chosen.excess or each is chosen
    ]
    left = {each.parameters.names: each.excess + settings.excess_margin * scale for each in others}
    return [(names, evidence.weigh(names, square)) for names, square in left.items()]


def _logistic(log_odds: float) -> float:
    return 1.0 / (1.0 + math.exp(-log_odds))
