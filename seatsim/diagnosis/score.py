"""One score for every hypothesis on the cause of a gap: a fitted set of effects, or an unknown cause.

    score = sum of weight * feature,    P(hypothesis) = exp(score) / sum of exp(score) over all hypotheses

A feature is a figure of the fits that an engineer would look at; `score.yaml` says what each means and holds its
weight. The weights were fitted, not chosen: to recordings of known causes, by conditional logistic regression
(`benchmarks/fit_score.py`), so that the probabilities are those with which the hypotheses came true there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.special import softmax

from seatsim.diagnosis.localise.disturbance import BIAS_DRIFT, Disturbance
from seatsim.diagnosis.movement import (
    expect_power,
    measure_relative_movements,
    measure_shares_left,
    relate_to_material,
)
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.select import Selection
from seatsim.schema.arrays import Array
from seatsim.schema.fields import read_packaged

_LITTLE = 0.02
"""Share of the excess, or gap in standard deviations, about which differences begin to count."""
_LEAST_MOVEMENT = 0.01
"""Movement, in material limits, below which smaller ones count as much."""
_NAMED = 0.6
"""Movement, in material limits, from which an effect is named; smaller ones of a set make up for its wrong form.

It is below 1, since what a fit finds of a material effect is often less than what the effect moves.
"""


class Weight(NamedTuple):
    """What a feature of a hypothesis means, and the weights fitted for it: of a cause, and beside an unknown one."""

    means: str
    weight: float = 0.0
    beside_unknown: float = 0.0


class _Fit(NamedTuple):
    """Weights by the name of their feature, and to how many cases of each kind they were fitted."""

    cases: dict[str, int]
    features: dict[str, Weight]


_Gaps = Mapping[frozenset[str], float]
"""Gap of every set of a search by the names of its effects."""
FILE = Path(__file__).with_name("score.yaml")
"""What `benchmarks/fit_score.py` wrote."""
CASES, WEIGHTS = read_packaged(FILE, _Fit)
"""To how many cases the weights of each kind were fitted, and the weights by the name of their feature."""


class Search(NamedTuple):
    """Fitted sets of effects under the weights of an objective, beside a disturbance, if any."""

    objective: Objective
    selection: Selection
    disturbance: Disturbance | None = None

    @property
    def effect(self) -> frozenset[str]:
        """The name of the effect that the disturbance is; empty without one."""
        return frozenset([self.disturbance.effect] if self.disturbance else [])


class Hypothesis(NamedTuple):
    """What may explain the recording: a rig and a search, beside whose disturbance it stands, with features by name.

    Without a rig it stands for an unknown cause. `names` are those of the disturbance and of its effects that move a
    channel enough to be named, of all where there is none of either.
    """

    features: dict[str, float]
    rig: Evaluation | None = None
    search: Search | None = None
    names: frozenset[str] = frozenset()


def list_hypotheses(searches: Sequence[Search], noise: Objective | None = None) -> list[Hypothesis]:
    """Return the best sets of each size of some searches, and an unknown cause alone, which is the last.

    All are compared with the calibrated rig of the first search, which has no disturbance. `noise` has the weights that
    say what a right rig leaves, where those of the searches do not.
    """
    first, *_ = searches
    count = first.objective.settings.selection.finalists
    gaps = [_measure_gaps(noise or search.objective, search.selection) for search in searches]
    hypotheses = [
        _describe_set(first, search, rig, own, gaps[0])
        for search, own in zip(searches, gaps, strict=True)
        for rig in search.selection.list_finalists(count)
        if search.disturbance or rig.parameters.terms
    ]
    prior = first.objective.measure_prior(first.selection.calibrated.parameters)
    return [*hypotheses, Hypothesis({"unknown": 1.0, "unknown_prior": prior})]


def _describe_set(first: Search, search: Search, rig: Evaluation, gaps: _Gaps, alone: _Gaps) -> Hypothesis:
    """Return a fitted set of effects with its features; `gaps` are of its search, `alone` of the first.

    A random signal takes any gap, however right it is, so that effects beside one have credit for what they take alone.
    """
    objective, parameters, names = search.objective, rig.parameters, rig.parameters.names
    problem, beside, calibrated = objective.problem, search.disturbance, first.selection.calibrated
    worst = max([0.0, *measure_shares_left(problem, calibrated, rig)])
    smaller = [gap for others, gap in gaps.items() if others < names]
    nothing = alone[frozenset()]
    movements = measure_relative_movements(problem, rig)
    movements += [relate_to_material(problem, beside.measure_movements(problem))] if beside else []
    most = [float(np.max(each)) for each in movements]
    effects = [*(term.effect for term in parameters.terms), *search.effect]
    features = {
        "gap": math.log(alone.get(names, nothing) / nothing),
        "gap_gain": math.log(gaps[names] / min(smaller, default=gaps[names])),
        "worst": math.log(worst + _LITTLE),
        "movement": min(0.0, math.log(min(most) + _LEAST_MOVEMENT)),
        "prior": objective.measure_prior(parameters),
        "parameters": float(len(parameters.effect_components)),
        "sensors": float(sum(effect.startswith("sensor.") for effect in effects)),
    }
    if beside:
        same = [each.excess for sets in first.selection.sets for each in sets if each.parameters.names == names]
        features |= {
            "disturbance": 1.0,
            "open": math.log((min(same, default=calibrated.excess) + _LITTLE) / (calibrated.excess + _LITTLE)),
            "disturbance_effects": float(len(effects)),
            "predicted": beside.found.shares["everything"],
            "following": beside.found.following,
            "repeated": beside.measure_share_repeated(problem),
            "drift": float(beside.effect == BIAS_DRIFT),
        }
    moving = frozenset(term.effect for term, moved in zip(parameters.terms, most, strict=False) if moved > _NAMED)
    return Hypothesis(features, rig, search, (moving | search.effect) or names)


def _measure_gaps(objective: Objective, selection: Selection) -> _Gaps:
    """Return the gap of every fitted set by the names of its effects."""
    return {rig.parameters.names: _measure_gap(objective, rig) for sets in selection.sets for rig in sets}


def _measure_gap(objective: Objective, rig: Evaluation) -> float:
    """Return the gap beyond what the weights expect of a right rig, over all channels, above the little without weight.

    It is in standard deviations of the channels. A random disturbance that counts as noise is no part of it, nor what
    its power may be by chance.
    """
    problem = objective.problem
    expected, deviations = np.mean([expect_power(objective, run) for run in problem.runs], axis=0)
    power = np.mean([np.mean(rig.residuals[run] ** 2, axis=1) for run in problem.runs], axis=0)
    chance = objective.settings.validation.by_chance * deviations / math.sqrt(len(problem.runs))
    return float(np.linalg.norm(np.sqrt(np.maximum(power - expected - chance, 0.0)) / problem.spread)) + _LITTLE


def weigh_hypotheses(hypotheses: Sequence[Hypothesis], beside_unknown: bool = False) -> Array:
    """Return the probabilities of hypotheses, shape (hypotheses,), on the cause or on what stands beside an unknown."""
    weights = {name: each.beside_unknown if beside_unknown else each.weight for name, each in WEIGHTS.items()}
    weighted = ([weights[name] * value for name, value in each.features.items()] for each in hypotheses)
    return np.asarray(softmax([sum(each) for each in weighted]))
