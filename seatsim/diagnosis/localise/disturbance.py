"""Effects that are a random signal: a force from outside, or the drift of a sensor's zero, beside what else is wrong.

Their signal differs from run to run, so that no fit finds it. It is estimated in what a set of effects leaves, and the
search for effects goes on beside it. A drift counts as noise of the channels. A force is taken out: the rig is
linearised about the force that was estimated, and what a force can do to the channels at a frequency, all of them
together, weighs as little as its power says; what it cannot do keeps its full weight.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatsim.diagnosis.localise.discrepancy import Discrepancy, describe_discrepancy, is_bias_drift
from seatsim.diagnosis.localise.input_estimate import InputEstimate
from seatsim.diagnosis.localise.localisation import evaluate_hypotheses
from seatsim.diagnosis.noise import NoiseWeights
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.result import Cause, Estimate
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.spectra import Spectra
from seatsim.schema.arrays import Array

_FORCE_FROM_OUTSIDE, BIAS_DRIFT = "floor.unmeasured_input", "sensor.bias"


@dataclass(frozen=True)
class Disturbance:
    """A random signal with the effect that it is, its estimate in each run, and the weights of that estimate."""

    effect: str
    found: Discrepancy
    estimates: Mapping[str, InputEstimate]
    weights: NoiseWeights

    @cached_property
    def amplitudes(self) -> dict[str, Spectra]:
        """Frequency response of the channels to the signal times the root of its power, (channels, frequencies)."""
        return {run: self._respond(run, np.sqrt(each.power)) for run, each in self.estimates.items()}

    @cached_property
    def traces(self) -> dict[str, Array]:
        """What the signal leaves in the channels by run, shape (channels, samples)."""
        signals = {run: each.signal for run, each in self.estimates.items()}
        return {run: np.fft.irfft(self._respond(run, np.fft.rfft(x)), len(x)) for run, x in signals.items()}

    def _respond(self, run: str, spectrum: Spectra | Array) -> Spectra:
        """Return the spectra that the channels have from one of the signal, at the frequencies that are compared."""
        response = self.estimates[run].response / self.weights.weights[run]
        return np.asarray(response * spectrum[: response.shape[1]])

    def measure_movements(self, problem: DiagnosisProblem) -> Array:
        """Return by how much it moves each channel, in the channel's standard deviations, shape (channels,)."""
        traces = np.concatenate([self.traces[run] for run in problem.runs], axis=1)
        return np.asarray(np.sqrt(np.mean(traces**2, axis=1)) / problem.spread)

    def measure_share_repeated(self, problem: DiagnosisProblem) -> float:
        """Return the share of the signal's variance (R2) that repeats of a run show again, 0 where none is repeated."""
        shares = list[float]()
        for runs in problem.repeats:
            rows = min(len(self.found.signals[run]) for run in runs)
            first, second = (self.found.signals[run][:rows] - np.mean(self.found.signals[run][:rows]) for run in runs)
            powers = float(first @ first) * float(second @ second)
            shares.append(float(first @ second) ** 2 / powers if powers else 0.0)
        return float(np.mean(shares)) if shares else 0.0


def find_disturbance(objective: Objective, selection: Selection, chosen: Evaluation | None) -> Disturbance | None:
    """Return the random signal that may hide further effects, None where what is left is no such effect.

    It is sought beside the chosen set where that leaves more than noise, or without one beside the best of each size. A
    disturbance shows only about a rig with the effects beside it, and they are found only where the disturbance is
    expected. Rigs are therefore judged by what they leave beyond a disturbance, not by all that they leave.
    """
    rigs = [sets[0] for sets in selection.sets]
    if chosen is not None:
        rigs = [chosen] if chosen.excess > objective.settings.localisation.above_noise else []
    slight = objective.settings.localisation.slight * selection.calibrated.excess
    tried = []
    for rig in rigs:
        hypotheses = evaluate_hypotheses(objective, selection.linearise(rig), ["suspension"])
        if BIAS_DRIFT in rig.parameters.names:
            # An offset of a sensor has taken a part of its drift.
            hypotheses.pop("sensor")
        block, likeliest = min(hypotheses.items(), key=lambda pair: pair[1].negative_log_evidence)
        charged = likeliest.negative_log_evidence + slight * len(rig.parameters.terms)
        tried.append((charged, rig, block, likeliest))
    if not tried:
        return None
    _, rig, block, likeliest = min(tried, key=lambda each: each[0])
    problem = objective.problem
    found = describe_discrepancy(problem, rig.parameters, block, likeliest)
    if block == "suspension":
        found = found._replace(block="floor")
        return Disturbance(_FORCE_FROM_OUTSIDE, found, likeliest.estimates, objective.weights)
    # An input that was reconstructed, as the floor's motion, does not hold the noise of its sensor.
    noise = float(problem.noise[problem.channels.index(found.channel)]) if found.channel in problem.channels else 0.0
    if is_bias_drift(problem.settings.localisation, found, problem.rate, noise):
        return Disturbance(BIAS_DRIFT, found, likeliest.estimates, objective.weights)
    return None


def put_beside(objective: Objective, disturbance: Disturbance) -> Objective:
    """Return the objective beside a disturbance."""
    problem, weights = objective.problem, objective.weights
    if disturbance.effect == _FORCE_FROM_OUTSIDE:
        about = problem.about(disturbance.found.signals, disturbance.traces)
        return Objective(about, weights.add_force(disturbance.amplitudes))
    return Objective(problem, weights.add({run: np.abs(each) ** 2 for run, each in disturbance.amplitudes.items()}))


def add_strength(cause: Cause, found: Discrepancy) -> Cause:
    """Return the cause with the RMS of its signal, and the channel that errs."""
    place: dict[str, Estimate | str] = {"channel": found.channel} if found.channel else {}
    return cause._replace(parameters=place | {"rms": Estimate(found.rms, 0.0, found.unit)})
