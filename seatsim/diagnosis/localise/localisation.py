"""Which block the gap lies in: from the causes found, or from the fault hypotheses on an unknown input."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.localise.hypotheses import FaultHypothesis, evaluate_hypotheses
from seatsim.diagnosis.movement import measure_movements
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective
from seatsim.diagnosis.result import Share

_ON_FRAME = ("damper", "suspension", "floor")
"""Blocks whose unknown input is a force on the frame."""
_LEAST_DIFFERENCE = 1e-6
"""Least difference in evidence that is divided by, where no block explains anything."""


class Remainder(NamedTuple):
    """What is unexplained: a hypothesis for each block that could hold it, and each block's share, likeliest first."""

    hypotheses: dict[str, FaultHypothesis]
    shares: dict[str, float]

    @property
    def block(self) -> str:
        """The likeliest block."""
        return next(iter(self.shares))

    @property
    def likeliest(self) -> FaultHypothesis:
        """The hypothesis of the likeliest block."""
        return self.hypotheses[self.block]


def share_gap(objective: Objective, chosen: Evaluation, remainder: Remainder | None) -> list[Share]:
    """Return the blocks, ranked by their share of the gap; with an unexplained remainder its block comes first."""
    shares: dict[str, float] = {}
    for term, move in zip(chosen.parameters.terms, measure_movements(objective.problem, chosen), strict=True):
        shares[term.block] = shares.get(term.block, 0.0) + float(np.mean(move**2))
    if remainder is not None:
        factor = objective.settings.localisation.remainder_factor
        scale = factor * max(shares.values(), default=1.0) / remainder.shares[remainder.block]
        for block, share in remainder.shares.items():
            shares[block] = shares.get(block, 0.0) + share * scale
    total = sum(shares.values())
    ranked = sorted(shares.items(), key=lambda item: -item[1])
    return [Share(block, size / total) for block, size in ranked if size > 0.0]


def localise_remainder(
    objective: Objective, calibrated: Evaluation, chosen: Evaluation
) -> tuple[Remainder, Evaluation]:
    """Return what is unexplained, and the rig that lacks it: the calibrated one where a single block explains the gap.

    Effects that were chosen but do not explain the gap are dropped for one unknown input that explains it, unless that
    leaves more than one beside them. Where the form of the rig is wrong everywhere no such input explains it, and where
    the gap is less than noise and disturbance nothing shows that there is one.
    """
    settings, beside = objective.settings, weigh_blocks(objective, objective.linearise_nuisances(chosen))
    if not chosen.parameters.terms or calibrated.excess < settings.localisation.above_noise:
        return beside, chosen
    alone = weigh_blocks(objective, objective.linearise_nuisances(calibrated))
    # An error of the very sensor that an effect names is that effect in a more general form.
    if alone.likeliest.channel in [term.fixed.get("channel") for term in chosen.parameters.terms]:
        return beside, chosen
    little = settings.decision.explained * calibrated.excess
    slight = settings.localisation.slight * calibrated.excess
    if alone.likeliest.negative_log_evidence < min(little, beside.likeliest.negative_log_evidence + slight):
        return alone, calibrated
    return beside, chosen


def weigh_blocks(objective: Objective, nuisances: Linearisation) -> Remainder:
    """Return the blocks that could hold what a rig leaves, with its sensitivities to the nuisance parameters.

    A slow force on the driver acts like one on the frame, since both move together. Where both explain nearly the same,
    the force is assigned to the frame.
    """
    hypotheses, evaluation = evaluate_hypotheses(objective, nuisances), nuisances.evaluation
    before = evaluation.cost / evaluation.rows - 1.0
    best = min(hypothesis.negative_log_evidence for hypothesis in hypotheses.values())
    width = objective.settings.localisation.decisive * max(before - best, _LEAST_DIFFERENCE)
    driver = hypotheses["driver"].negative_log_evidence + width
    if min(hypotheses[block].negative_log_evidence for block in _ON_FRAME if block in hypotheses) < driver:
        hypotheses["driver"] = hypotheses["driver"]._replace(negative_log_evidence=driver)
    best = min(hypothesis.negative_log_evidence for hypothesis in hypotheses.values())
    weights = {block: math.exp(-(h.negative_log_evidence - best) / width) for block, h in hypotheses.items()}
    ranked = sorted(weights.items(), key=lambda item: -item[1])
    return Remainder(hypotheses, {block: weight / sum(weights.values()) for block, weight in ranked})
