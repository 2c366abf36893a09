"""From fitted sets of effects to a verdict: none, known, ambiguous or unknown, with probabilities.

The thresholds were chosen on simulated rigs whose effects have other functional forms than the candidates, and hold for
whitened excess, which is 0 where only noise is left, and for material sizes in standard deviations of a channel.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.fit import Engine, State
from seatsim.diagnosis.problem import Problem
from seatsim.diagnosis.select import ENLARGE, NOTHING, Search

Array = NDArray[np.float64]

MATERIAL = 0.04
"""Movement of a channel, in its standard deviations, from which an effect is material; the contract's 5 % with a margin
for the fit's error."""
EXPLAINED = 0.12
"""Share of the calibrated excess that a known set leaves at most."""
UNTOUCHED = 0.5
"""Share of the excess of a channel with a material gap that a known set leaves at most."""
ALIKE = 1.2
"""Factor on the excess within which two sets explain a recording equally well."""
ALIKE_FLOOR = 0.02
"""Excess added to it."""
BESIDE = 0.3
"""Probability of an effect that runs left out support beside an unknown cause."""


@dataclasses.dataclass(frozen=True)
class Judgement:
    """The verdict with the chosen set, sets that explain as well, and probabilities by effect, of none and unknown."""

    verdict: str
    chosen: State
    groups: list[list[str]]
    probabilities: dict[str, float]
    none: float
    unknown: float


def judged(engine: Engine, found: Search, effects: list[str]) -> Judgement:
    """Return the verdict on a search."""
    before = found.excess(found.calibrated)
    if before < NOTHING or (_rest(engine, found.calibrated) < MATERIAL and not material(engine, found.sets[1][0])):
        sure = 1.0 / (1.0 + math.exp((before - NOTHING) / 0.05 - 2.0))
        return Judgement("none", found.calibrated, [], dict.fromkeys(effects, 0.004), max(sure, 0.6), 0.02)
    chosen = _chosen(engine, found)
    share = found.excess(chosen) / before
    rivals = groups_of(chosen, _alike(found, chosen))
    small = _rest(engine, chosen) < MATERIAL and not any(len(group) > 2 for group in rivals)
    everywhere = all(left < UNTOUCHED for left in _left(engine, found.calibrated, chosen))
    explained = bool(chosen.point.terms) and ((share < EXPLAINED and everywhere) or small)
    unknown = 1.0 / (1.0 + math.exp(-(math.log(max(share, 1e-4)) - math.log(EXPLAINED)) / 0.4))
    unknown = min(max(unknown, 0.02), 0.45) if explained else max(unknown, 0.55)
    groups = rivals if explained else []
    verdict = ("ambiguous" if groups else "known") if explained else "unknown"
    return Judgement(verdict, chosen, groups, _probabilities(chosen, groups, effects, unknown), 0.01, unknown)


def beside_unknown(judgement: Judgement, chosen: State, alike: Sequence[State] = ()) -> Judgement:
    """Return the judgement that something is unexplained with another set of effects beside it."""
    groups = groups_of(chosen, alike)
    probabilities = _probabilities(chosen, groups, list(judgement.probabilities), min(judgement.unknown, 1.0 - BESIDE))
    return dataclasses.replace(judgement, chosen=chosen, groups=groups, probabilities=probabilities)


def _chosen(engine: Engine, found: Search) -> State:
    """Return the smallest set that no enlargement beats by enough, with every effect of it material."""
    chosen = found.calibrated
    for sets in found.sets[1:]:
        better = next((state for state in sets[:3] if material(engine, state)), None)
        if better is None or not _enlarges(engine, found, chosen, better):
            if chosen.point.terms or better is None:
                break
            if found.excess(better) > 0.9 * found.excess(chosen):
                continue
        chosen = better
        if found.excess(chosen) < NOTHING:
            break
    return chosen


def _enlarges(engine: Engine, found: Search, chosen: State, better: State) -> bool:
    """Whether a larger set leaves so much less, in all or in a channel with a material gap, that its effects are real.

    What a form of an effect leaves in one channel must not hide another effect that acts on the others.
    """
    if found.excess(better) <= ENLARGE * found.excess(chosen):
        return True
    return bool(chosen.point.terms) and any(left <= ENLARGE for left in _left(engine, chosen, better))


def _left(engine: Engine, before: State, after: State) -> list[float]:
    """Return the share of the excess that is left of every channel with a material gap before."""
    gaps, excess, rest = rests_of(engine.problem, before), _by_channel(before), _by_channel(after)
    channels = np.flatnonzero((gaps > MATERIAL) & (excess > NOTHING))
    return [float(rest[k] / excess[k]) for k in channels]


def _by_channel(state: State) -> Array:
    """Return the whitened excess of every channel."""
    return np.asarray(np.mean([np.mean(values**2, axis=1) for values in state.whitened.values()], axis=0) - 1.0)


def movements(engine: Engine, state: State) -> list[Array]:
    """Return by how much each effect of a set moves each channel, in the channel's standard deviations."""
    point, problem = state.point, engine.problem
    without = [point.without(term.effect) for term in point.terms]
    others = problem.residuals([(other.u, other.effects) for other in without])
    moves = []
    for other in others:
        change = np.concatenate([other[run] - state.residual[run] for run in problem.runs], axis=1)
        moves.append(np.sqrt(np.mean(change**2, axis=1)) / problem.spread)
    return moves


def material(engine: Engine, state: State) -> bool:
    """Whether every effect of a set moves some channel by a material size and by more than its noise."""
    noise = engine.problem.noise / engine.problem.spread
    return all(bool(np.any((move > MATERIAL) & (move > 0.9 * noise))) for move in movements(engine, state))


def _rest(engine: Engine, state: State) -> float:
    """Return the largest gap of a channel beyond its noise, in the channel's standard deviations."""
    return float(np.max(rests_of(engine.problem, state)))


def rests_of(problem: Problem, state: State) -> Array:
    """Return the gap of every channel beyond its noise, in the channel's standard deviations."""
    residual = np.concatenate([state.residual[run] for run in problem.runs], axis=1)
    power = np.mean(residual**2, axis=1) - problem.noise**2
    return np.asarray(np.sqrt(np.maximum(power, 0.0)) / problem.spread)


def _alike(found: Search, chosen: State) -> list[State]:
    """Return the other sets of as many effects that fit as well."""
    limit = ALIKE * found.excess(chosen) + ALIKE_FLOOR
    others = found.sets[len(chosen.point.terms)]
    return [state for state in others if state is not chosen and found.excess(state) <= limit]


def groups_of(chosen: State, alike: Sequence[State]) -> list[list[str]]:
    """Return groups of effects that could stand for each other: sets alike that differ in one effect.

    An effect that stands for one of the chosen counts as that one in the other sets.
    """
    names = {term.effect for term in chosen.point.terms}
    groups: dict[str, list[str]] = {}
    for other in sorted(({term.effect for term in state.point.terms} for state in alike), key=lambda s: len(s - names)):
        stands_for = {member: name for name, group in groups.items() for member in group}
        missing, added = names - {stands_for.get(name, name) for name in other}, other - names - set(stands_for)
        if len(other) == len(names) and len(missing) == len(added) == 1:
            (replaced,), (stand_in,) = missing, added
            groups.setdefault(replaced, [replaced]).append(stand_in)
    return list(groups.values())


def _probabilities(chosen: State, groups: list[list[str]], effects: list[str], unknown: float) -> dict[str, float]:
    """Return the probability of every effect of being at work."""
    found = dict.fromkeys(effects, 0.006)
    for term in chosen.point.terms:
        found[term.effect] = 1.0 - unknown
    for group in groups:
        weights = [2.0] + [1.0] * (len(group) - 1)
        for name, weight in zip(group, weights, strict=True):
            found[name] = (1.0 - unknown) * weight / sum(weights)
    return found
