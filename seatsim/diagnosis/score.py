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

from seatsim.diagnosis.movement import expect_power, measure_relative_movements, measure_shares_left
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.select import Selection
from seatsim.schema.arrays import Array
from seatsim.schema.fields import read_packaged

_LITTLE = 0.02
"""Excess, its share, or gap in standard deviations, about which differences begin to count."""
_LEAST_MOVEMENT = 0.01
"""Movement, in material limits, below which smaller ones count as much."""


class Weight(NamedTuple):
    """What a feature of a hypothesis means, and the weight that was fitted for it."""

    means: str
    weight: float


WEIGHTS = read_packaged(Path(__file__).with_name("score.yaml"), dict[str, Weight])
"""Weight of each feature, by name."""


class Hypothesis(NamedTuple):
    """A rig that may explain the recording, with its features by name; None stands for an unknown cause."""

    rig: Evaluation | None
    features: dict[str, float]

    @property
    def names(self) -> frozenset[str]:
        """Names of its effects."""
        return self.rig.parameters.names if self.rig else frozenset()


def list_hypotheses(objective: Objective, selection: Selection) -> list[Hypothesis]:
    """Return the best sets of each size, and an unknown cause last."""
    count = objective.settings.selection.finalists
    gaps = {each.parameters.names: _measure_gap(objective, each) for sets in selection.sets for each in sets}
    sets = [
        _describe_set(objective, selection.calibrated, each, gaps)
        for sets in selection.sets[1:]
        for each in sets[:count]
    ]
    least = min((each.features["excess"] for each in sets), default=0.0)
    return [*sets, Hypothesis(None, {"unknown": 1.0, "unknown_excess": least})]


def _describe_set(
    objective: Objective, calibrated: Evaluation, rig: Evaluation, gaps: Mapping[frozenset[str], float]
) -> Hypothesis:
    """Return a fitted set of effects with its features; `gaps` are those of all sets by the names of their effects."""
    names = rig.parameters.names
    worst = max([0.0, *measure_shares_left(objective.problem, calibrated, rig)])
    moved = min(float(np.max(each)) for each in measure_relative_movements(objective.problem, rig))
    return Hypothesis(rig, {
        "excess": math.log((rig.excess + _LITTLE) / (calibrated.excess + _LITTLE)),
        "gap": math.log(gaps[names] / gaps[calibrated.parameters.names]),
        "gap_gain": math.log(gaps[names] / min(gap for smaller, gap in gaps.items() if smaller < names)),
        "worst": math.log(worst + _LITTLE),
        "movement": min(0.0, math.log(moved + _LEAST_MOVEMENT)),
        "prior": float(np.sum((rig.parameters.deviations / objective.settings.fit.prior_std) ** 2)),
    })  # fmt: skip


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


def weigh_hypotheses(hypotheses: Sequence[Hypothesis]) -> Array:
    """Return the probabilities of hypotheses, shape (hypotheses,)."""
    weighted = ([WEIGHTS[name].weight * value for name, value in each.features.items()] for each in hypotheses)
    return np.asarray(softmax([sum(each) for each in weighted]))
