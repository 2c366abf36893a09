"""Estimation of an unknown input of one block: the signal at its port that explains the residuals of a rig.

The input is free at every frequency: a force on the frame (suspension), on the driver (driver), between the two
(cushion), of the damper, which the load cell sees, or a motion of the floor. With r the whitened residuals of the
channels and h their frequency response to the input, the simulation is driven by the input q and q is then corrected,
in turn, starting from zero, as long as the residuals fall:

    q(f) += h* r / (|h|^2 + 2 / p(f)),      p(f) the plausible power of an input.

The input of the coil is the difference between the logged and the simulated current. The force that a current causes
depends on the motion, so there is no frequency response h to correct it by.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.localise.reconstruction import PORTS, Port, Reconstruction, reconstruct
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.spectra import Spectra, as_complex, measure_power, wiener_share
from seatsim.schema.arrays import Array


class InputEstimate(NamedTuple):
    """Estimate of a block's input in a run: whitened residuals, frequency response, power, and signal.

    Where the simulation is driven by the input, `residuals` is what the driven simulation leaves plus what the signal
    explains by the last frequency response.
    """

    residuals: Array
    response: Spectra
    power: Array
    signal: Array

    @property
    def gain(self) -> Array:
        """Wiener's filter for the input, shape (frequencies,): near 1 where its effect exceeds the noise."""
        return wiener_share(np.sum(np.abs(self.response) ** 2, axis=0) * self.power)


class _Attempt(NamedTuple):
    """A signal with the simulated channels under it and their whitened residuals."""

    signal: Array
    outputs: Array
    residuals: Array

    @property
    def cost(self) -> float:
        return float(np.sum(self.residuals**2))


def estimate_input(
    objective: Objective, evaluation: Evaluation, run: str, port: Port, highest: float = np.inf
) -> InputEstimate:
    """Return the estimate of an input, below a highest frequency in Hz, that matches the channels as well as it can.

    The frequency response is estimated anew, about the signal so far and with another random probe, where a correction
    by the last one was fruitless: a strong signal changes how the damper slips.
    """
    rig = reconstruct(objective, evaluation.parameters, run, port)
    settings, bins = rig.settings, objective.weights.bins[run]
    permitted = np.fft.rfftfreq(rig.samples, 1.0 / objective.problem.rate)[:bins] <= highest
    plausible = rig.plausible_power()
    best, fruitless, stale = _attempt(rig, np.zeros(rig.samples)), 0, True
    for seed in range(1, settings.rounds + 1):
        before = best.cost
        if stale:
            response = rig.measure_response(best.signal, best.outputs, seed)
            size = np.sum(np.abs(response) ** 2, axis=0)
        step = np.zeros(rig.samples // 2 + 1, dtype=complex)
        matched = np.sum(response.conj() * as_complex(best.residuals), axis=0)
        step[:bins] = permitted * matched / (size + 2.0 / plausible)
        best = _improve(rig, best, np.fft.irfft(step, rig.samples))
        stale = best.cost > (1.0 - settings.settled) * before
        fruitless = fruitless + 1 if stale else 0
        if fruitless == settings.fruitless or best.cost < best.residuals.size:
            break
    spectrum = np.fft.rfft(best.signal)
    power = measure_power(spectrum[:bins], objective.settings.noise.smoothing)
    explained = response * spectrum[:bins]
    spectrum[:bins] *= wiener_share(size * power)
    whole = best.residuals + np.concatenate([explained.real, explained.imag], axis=1)
    return InputEstimate(whole, response, power, np.fft.irfft(spectrum, rig.samples))


def _attempt(rig: Reconstruction, signal: Array) -> _Attempt:
    outputs = rig.simulate_with(signal)
    return _Attempt(signal, outputs, rig.whiten_residuals(outputs))


def _improve(rig: Reconstruction, best: _Attempt, step: Array) -> _Attempt:
    """Return the first of several fractions of a step that lowers the residuals, else the best signal so far."""
    for fraction in rig.settings.backtracking:
        tried = _attempt(rig, best.signal + fraction * step)
        if tried.cost < best.cost:
            return tried
    return best


def estimate_current(objective: Objective, evaluation: Evaluation, run: str) -> InputEstimate:
    """Return the logged current less the simulated one, as the estimate of an input."""
    k, samples = objective.problem.channels.index("coil_current"), objective.problem.measured[run].shape[1]
    weights, bins = objective.weights.weights[run], objective.weights.bins[run]
    smoothing = objective.settings.noise.smoothing
    error, spectrum = as_complex(evaluation.whitened[run])[k], np.zeros(samples // 2 + 1, dtype=complex)
    spectrum[:bins] = error / weights[k] * wiener_share(measure_power(error, smoothing))
    signal = np.fft.irfft(spectrum, samples)
    rig = reconstruct(objective, evaluation.parameters, run, Port(current=1.0))
    residuals = rig.whiten_residuals(rig.simulate_with(signal))
    residuals[k] = evaluation.whitened[run][k]
    return InputEstimate(residuals, respond_to_error(weights, k), measure_power(error / weights[k], smoothing), signal)


def estimate_error(objective: Objective, evaluation: Evaluation, run: str, k: int) -> InputEstimate:
    """Return the error of the sensor of channel `k` that would explain its residuals."""
    weights, residuals = objective.weights.weights[run], evaluation.whitened[run]
    power = measure_power(as_complex(residuals)[k] / weights[k], objective.settings.noise.smoothing)
    return InputEstimate(residuals, respond_to_error(weights, k), power, evaluation.residuals[run][k])


def respond_to_error(weights: Array, k: int) -> Spectra:
    """Return the response of the whitened channels to a unit error of channel `k`, shape (channels, frequencies)."""
    return np.asarray(np.eye(len(weights))[:, k : k + 1] * weights, dtype=complex)


def estimate_nonrepeatable_force(objective: Objective, evaluation: Evaluation) -> dict[str, Array] | None:
    """Return a random force on the frame by run, shape (samples,), by which repeated runs differ; None without repeats.

    The residuals of two repeats differ by twice the power of the non-repeatable disturbance. Residuals, because each
    repeat has a floor and a command of its own, which a real rig does not repeat exactly.
    """
    problem, settings = objective.problem, objective.settings
    for run, entry in problem.recording.runs.items():
        first = evaluation.residuals.get(entry.repeat_of or "", np.zeros(0))
        second = evaluation.residuals[run]
        if first.shape == second.shape:
            rig = reconstruct(objective, evaluation.parameters, run, PORTS["suspension"])
            response = rig.measure_response(np.zeros(rig.samples), problem.measured[run] - second)
            residuals = as_complex(objective.weights((first - second) / np.sqrt(2.0), run))
            size = np.sum(np.abs(response) ** 2, axis=0)
            spectrum = np.sum(response.conj() * residuals, axis=0) / (size + 2.0 / rig.plausible_power())
            power = measure_power(spectrum, settings.noise.smoothing)
            spectrum *= settings.reconstruction.regained * wiener_share(size * power)
            force = np.fft.irfft(spectrum, rig.samples)
            return {name: np.resize(force, values.shape[1]) for name, values in problem.measured.items()}
    return None
