"""Which block the gap lies in: from the causes found, or from hypotheses on an unknown input.

An unknown input acts in each block in turn, or one sensor errs. With r the whitened residuals without the input, h the
frequency response of the channels to the input about the estimated signal, p the power of that signal, and S the
sensitivities to the deviations u of the nuisance parameters, minus twice the log evidence is

    min over u of  sum over f  (r - S u)* (I + h h* p / 2)^-1 (r - S u) + 2 log(1 + |h|^2 p / 2)  + prior(u).

The logarithm is Occam's factor: it charges a block for every frequency at which it needs an input of its own.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.fit import solve_step
from seatsim.diagnosis.localise.input_estimate import (
    PORTS,
    InputEstimate,
    estimate_current,
    estimate_error,
    estimate_input,
)
from seatsim.diagnosis.movement import measure_movements
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective
from seatsim.diagnosis.result import Share
from seatsim.diagnosis.spectra import as_complex
from seatsim.recordings.quality.sensors import FLOOR, follows_floor
from seatsim.schema.arrays import Array

_QUANTITIES = {"coil": ("current", "A"), "floor": ("acceleration", "m/s^2")}
"""Quantity and unit of an unknown input by block, where it is not a force in N."""


class FaultHypothesis(NamedTuple):
    """A block that an unknown input may act in, with its negative log evidence per sample.

    `negative_log_evidence` is minus twice the log evidence per number compared, less 1. `signals[run]`, shape
    (samples,), is the input above its noise, a quantity in its unit; `channel` is the one that errs, for a sensor.
    `estimates` is what it was found by.
    """

    negative_log_evidence: float
    quantity: str
    unit: str
    signals: dict[str, Array]
    channel: str = ""
    estimates: Mapping[str, InputEstimate] = MappingProxyType({})


def evaluate_hypotheses(
    objective: Objective, nuisances: Linearisation, blocks: Collection[str] = tuple(PORTS)
) -> dict[str, FaultHypothesis]:
    """Return, by block, how an unknown input would explain what a rig leaves; errors of sensors are always among them.

    Args:
        objective: the problem and its weights.
        nuisances: the rig's evaluation with its sensitivities to the nuisance parameters, which are refitted.
        blocks: those with a port that are asked.
    """
    problem, evaluation = objective.problem, nuisances.evaluation
    by_run = problem.pool.map(lambda run: _estimate_inputs(objective, evaluation, run, blocks), problem.runs)
    runs = dict(zip(problem.runs, by_run, strict=True))
    hypotheses = {}
    for name in runs[problem.runs[0]]:
        estimates = {run: of_run[name] for run, of_run in runs.items()}
        signals = {run: estimate.signal for run, estimate in estimates.items()}
        quantity, unit = _QUANTITIES.get(name, ("force", "N"))
        evidence = _negative_log_evidence(nuisances, estimates)
        hypotheses[name] = FaultHypothesis(evidence, quantity, unit, signals, estimates=estimates)

    def pop_error(name: str, channel: str) -> FaultHypothesis:
        """Return a hypothesis as the error of a channel's sensor."""
        unit = problem.recording.channels[channel].unit
        return hypotheses.pop(name)._replace(quantity=f"error of {channel}", unit=unit, channel=channel)

    errors = [pop_error(name, name) for name in problem.channels]
    # An unseen motion of the floor is, with the other sign, an error of the floor's accelerometer.
    motions = [FLOOR, "floor"] if "floor" in hypotheses and not follows_floor(problem.recording) else [FLOOR]
    for error in [pop_error(name, FLOOR) for name in motions]:
        errors.append(error._replace(signals={run: -values for run, values in error.signals.items()}))
    return hypotheses | {"sensor": min(errors, key=lambda hypothesis: hypothesis.negative_log_evidence)}


def _estimate_inputs(
    objective: Objective, evaluation: Evaluation, run: str, blocks: Collection[str]
) -> dict[str, InputEstimate]:
    """Return the estimate of an input in some blocks, and of an error of each channel's sensor."""
    channels = objective.problem.channels
    estimates = {name: estimate_error(objective, evaluation, run, k) for k, name in enumerate(channels)}
    # Without a load cell no channel distinguishes a force of the damper from one of the linkage.
    merged = "damper_force" not in channels and "damper" in blocks
    for block in blocks:
        same = merged and block == "suspension"
        estimates[block] = estimates["damper"] if same else estimate_input(objective, evaluation, run, PORTS[block])
    # Below this frequency floors hardly move: what looks like a motion there is the drift of the accelerometer.
    slow = objective.settings.localisation.slow_frequency
    estimates[FLOOR] = estimate_input(objective, evaluation, run, PORTS["floor"], slow)
    if "coil_current" in channels:
        estimates["coil"] = estimate_current(objective, evaluation, run)
    return estimates


def _negative_log_evidence(nuisances: Linearisation, estimates: dict[str, InputEstimate]) -> float:
    """Return minus twice the log evidence per number compared, less 1, the nuisances refitted to first order."""
    deviations = nuisances.evaluation.parameters.deviations
    count = len(deviations)
    matrix, right, cost, rows = np.zeros((count, count)), np.zeros(count), 0.0, 0
    for run, estimate in estimates.items():
        shape = estimate.residuals.shape
        whole = as_complex(np.concatenate([estimate.residuals[None], nuisances.jacobian[run].reshape(-1, *shape)]))
        size = np.sum(np.abs(estimate.response) ** 2, axis=0)
        along = np.sum(estimate.response.conj() * whole, axis=1, keepdims=True) / (size + 2.0 / estimate.power)
        beyond = whole - estimate.response * along
        cost += float(np.sum(2.0 * np.log1p(0.5 * size * estimate.power)))
        products = (whole.reshape(count + 1, -1) @ beyond.reshape(count + 1, -1).conj().T).real
        matrix, right, cost = matrix + products[1:, 1:], right + products[1:, 0], cost + products[0, 0]
        rows += estimate.residuals.size
    ones = np.ones(count)
    step = solve_step(matrix, right, count, deviations, -ones, ones)
    return float(cost - 2.0 * step @ right + step @ matrix @ step) / rows - 1.0


_ON_FRAME = ("damper", "suspension", "floor")
"""Blocks whose unknown input is a force on the frame."""
_NOTHING: Mapping[str, Array] = MappingProxyType({})
_LEAST_DIFFERENCE = 1e-6
"""Least difference in evidence that is divided by, where no block explains anything."""


_REMAINDER_FACTOR = 1.2
"""Share of the remainder's block beside the largest share of the effects found: above 1, for it stands first."""


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


def share_gap(
    objective: Objective, chosen: Evaluation, remainder: Remainder | None, beside: Mapping[str, Array] = _NOTHING
) -> list[Share]:
    """Return the blocks, ranked by their share of the gap; with an unexplained remainder its block comes first.

    `beside` are movements of the channels by what is no effect of the rig, shape (channels,), by block.
    """
    shares = {block: float(np.mean(move**2)) for block, move in beside.items()}
    for term, move in zip(chosen.parameters.terms, measure_movements(objective.problem, chosen), strict=True):
        shares[term.block] = shares.get(term.block, 0.0) + float(np.mean(move**2))
    if remainder is not None:
        scale = _REMAINDER_FACTOR * max(shares.values(), default=1.0) / remainder.shares[remainder.block]
        for block, share in remainder.shares.items():
            shares[block] = shares.get(block, 0.0) + share * scale
    total = sum(shares.values())
    ranked = sorted(shares.items(), key=lambda item: -item[1])
    return [Share(block, size / total) for block, size in ranked if size > 0.0]


def localise_remainder(objective: Objective, nuisances: Linearisation) -> Remainder:
    """Return the blocks that could hold what a rig leaves, from its sensitivities to the nuisance parameters.

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
