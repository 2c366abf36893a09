"""Effects that are a stochastic disturbance: found in what no other effect explains, and added to the noise.

Their signal is never simulated, since it differs from run to run.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from seatsim.diagnosis.decide import Decision
from seatsim.diagnosis.localise.discrepancy import Discrepancy, describe_discrepancy, is_bias_drift, is_from_outside
from seatsim.diagnosis.localise.localisation import FaultHypothesis, evaluate_hypotheses, weigh_blocks
from seatsim.diagnosis.localise.reconstruction import PORTS, reconstruct
from seatsim.diagnosis.movement import measure_remainders
from seatsim.diagnosis.noise import NoiseWeights, carry_force
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective, Parameters
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.result import Cause, Estimate, Share
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.diagnosis.spectra import measure_power, smooth_spectrum
from seatsim.schema.arrays import Array

FORCE_FROM_OUTSIDE, BIAS_DRIFT = "floor.unmeasured_input", "sensor.bias"


def find_disturbance(objective: Objective, selection: Selection) -> Discrepancy | None:
    """Return the stochastic disturbance that one of the best sets leaves, None where all leave something else.

    A disturbance shows only about a rig with the effects beside it, and they are found only where the disturbance is
    expected. Sets are therefore judged by what they leave beyond a disturbance, not by all that they leave.
    """
    rigs = [selection.linearise(sets[0]) for sets in selection.sets]
    left = [
        _measure_left(objective, rig, selection.calibrated.excess)
        + objective.settings.localisation.slight * len(rig.evaluation.parameters.terms)
        for rig in rigs
    ]
    if min(left) == math.inf:
        return None
    nuisances = rigs[int(np.argmin(left))]
    blocks = weigh_blocks(objective, nuisances)
    return describe_discrepancy(objective.problem, nuisances.evaluation.parameters, blocks.block, blocks.likeliest)


def _measure_left(objective: Objective, nuisances: Linearisation, before: float) -> float:
    """Return the share of an excess `before` that a disturbance leaves of a rig, infinite where none explains it."""
    problem = objective.problem
    hypotheses = evaluate_hypotheses(objective, nuisances, ["suspension"])
    block, likeliest = min(hypotheses.items(), key=lambda pair: pair[1].negative_log_evidence)
    share = likeliest.negative_log_evidence / before
    if share >= problem.settings.decision.explained:
        return math.inf
    remainder = describe_discrepancy(problem, nuisances.evaluation.parameters, block, likeliest)
    return share if name_stochastic_effect(problem, remainder) else math.inf


def find_bias_drift(problem: DiagnosisProblem, evaluation: Evaluation) -> Discrepancy | None:
    """Return the remainder of the one channel with a material gap as an error of its sensor, None without one.

    The travel is excluded: a slow force on the rig would move it, and creep moves it alone.
    """
    settings = problem.settings
    gaps = measure_remainders(problem, evaluation)
    k = int(np.argmax(gaps))
    name, others = problem.channels[k], np.delete(gaps, k)
    is_alone = not np.any(others > gaps[k] / settings.localisation.drift_alone)
    if gaps[k] < settings.decision.material or not is_alone or name == "suspension_displacement":
        return None
    signals = {run: values[k] for run, values in evaluation.residuals.items()}
    error = FaultHypothesis(0.0, f"error of {name}", problem.recording.channels[name].unit, signals, name)
    return describe_discrepancy(problem, evaluation.parameters, "sensor", error)


def name_stochastic_effect(problem: DiagnosisProblem, found: Discrepancy) -> str:
    """Return the effect that an unexplained discrepancy may be; an empty word for none."""
    settings = problem.settings.localisation
    # Without a load cell no channel distinguishes a force of the damper from one from outside.
    merged = () if "damper_force" in problem.channels else ("damper",)
    if found.block in ("suspension", *merged) and is_from_outside(problem.settings, found, problem.rate):
        return FORCE_FROM_OUTSIDE
    # An input that was reconstructed, as the floor's motion, does not hold the noise of its sensor.
    noise = float(problem.noise[problem.channels.index(found.channel)]) if found.channel in problem.channels else 0.0
    return BIAS_DRIFT if is_bias_drift(settings, found, problem.rate, noise) else ""


def add_to_noise(problem: DiagnosisProblem, weights: NoiseWeights, effect: str, found: Discrepancy) -> NoiseWeights:
    """Return the weights with the signal added to the noise of the recording."""
    smoothing = problem.settings.noise.smoothing
    if effect == FORCE_FROM_OUTSIDE:
        regained = problem.settings.reconstruction.regained
        return weights.add(carry_force(problem, {run: regained * signal for run, signal in found.signals.items()}))
    if found.channel not in problem.channels:
        objective = Objective(problem, weights)
        return weights.add({run: _carry_floor_motion(objective, run, each) for run, each in found.signals.items()})
    row = np.array([[name == found.channel] for name in problem.channels], dtype=float)
    powers = {run: row * measure_power(np.fft.rfft(signal), smoothing) for run, signal in found.signals.items()}
    return weights.add(powers)


def _carry_floor_motion(objective: Objective, run: str, signal: Array) -> Array:
    """Return the power that a motion of the floor leaves in the channels, shape (channels, frequencies)."""
    problem = objective.problem
    rig = reconstruct(objective, Parameters(problem.nominal), run, PORTS["floor"])
    change = rig.simulate_with(signal) - problem.simulated(run, problem.nominal, ())
    return smooth_spectrum(np.abs(np.fft.rfft(change)) ** 2, problem.settings.noise.smoothing)


def merge_effect(
    settings: DiagnosisSettings, decision: Decision, where: Sequence[Share], effect: str
) -> tuple[Decision, list[Share]]:
    """Return the decision and the shares of the other causes, with the stochastic effect added to both."""
    probability, none, unknown = settings.decision.stochastic
    decision = dataclasses.replace(
        decision,
        verdict="ambiguous" if decision.groups else "known",
        probabilities=decision.probabilities | {effect: probability},
        none=none,
        unknown=unknown,
    )
    block, own = effect.partition(".")[0], settings.localisation.stochastic_share if where else 1.0
    others = [Share(s.block, s.share * (1.0 - own)) for s in where if s.block != block]
    return decision, [Share(block, 1.0 - sum(share for _, share in others)), *others]


def add_strength(cause: Cause, found: Discrepancy) -> Cause:
    """Return the cause with the RMS of its signal, and the channel that errs."""
    place: dict[str, Estimate | str] = {"channel": found.channel} if found.channel else {}
    return cause._replace(parameters=place | {"rms": Estimate(found.rms, 0.0, found.unit)})
