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

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.objective import Evaluation, Objective, Parameters
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.spectra import Spectra, as_complex, estimate_response, measure_power, wiener_share
from seatsim.schema.arrays import Array
from seatsim.schema.errors import RunError
from seatsim.simulation.inputs import Forces
from seatsim.simulation.respond import respond

FAR_OFF = 1e6
"""Residual, in standard deviations, given to a rig that leaves all bounds, so that such a step is rejected."""


class Port(NamedTuple):
    """Where an unknown signal acts, each field a multiple of it.

    A force on frame or driver in N, a base acceleration in m/s^2, an error of the load cell in N, a current in A.
    """

    frame_force: float = 0.0
    driver_force: float = 0.0
    base_acceleration: float = 0.0
    load_cell_error: float = 0.0
    current: float = 0.0


PORTS = {
    "damper": Port(frame_force=-1.0, load_cell_error=1.0),
    "suspension": Port(frame_force=1.0),
    "cushion": Port(frame_force=-1.0, driver_force=1.0),
    "driver": Port(driver_force=1.0),
    "floor": Port(base_acceleration=1.0),
}
"""Port of each block that may hold an unknown input; the coil's is its logged current."""


_PROBE_SIZE = 0.1
"""Size of random probing inputs, as a share of the floor's motion and of the force that it means.

The rig is not linear about the motion for larger ones; smaller ones drown in rounding.
"""
_PROBE_CORNER = 40.0
"""Frequency above which the spectrum of probing inputs falls [Hz]."""
_PLAUSIBLE_CORNER = 2.0
"""Frequency above which the spectrum of plausible inputs falls [Hz]."""
_ROUNDS = 20
"""Most corrections of an input."""
_SETTLED = 0.02
"""A correction that lowers what is left by less than this share is fruitless."""
_FRUITLESS = 2
"""Fruitless corrections in a row after which the estimate ends: one may be due to a misleading probe."""
_BACKTRACKING = (1.0, 0.4, 0.15, 0.05)
"""Fractions of a correction that are tried in turn."""


class _Attempt(NamedTuple):
    """A signal with the simulated channels under it and their whitened residuals."""

    signal: Array
    outputs: Array
    residuals: Array

    @property
    def cost(self) -> float:
        return float(np.sum(self.residuals**2))


@dataclass(frozen=True)
class Reconstruction:
    """A run of a rig with a port, ready to be driven by an input."""

    objective: Objective
    parameters: Parameters
    run: str
    port: Port

    @property
    def problem(self) -> DiagnosisProblem:
        """The problem that the run is of."""
        return self.objective.problem

    @cached_property
    def current(self) -> Array:
        """Current of the coil without an input, every step of the simulation."""
        inputs = self.problem.seat_inputs(self.run)
        scenario = self.problem.scenario_of(self.run, self.parameters.deviations, self.parameters.effects)
        every_step = inputs._replace(interval=inputs.floor.step)
        return respond(scenario, every_step)["coil_current"]

    @property
    def samples(self) -> int:
        """Number of samples of a signal."""
        return int(self.problem.measured[self.run].shape[1])

    def simulate_with(self, signal: Array) -> Array:
        """Return the channels with a signal at the port, shape (channels, samples)."""
        problem, port, recorded = self.problem, self.port, self.problem.seat_inputs(self.run)
        full, floor = problem.spread_over_steps(recorded, signal), recorded.floor
        floor = floor._replace(acceleration=floor.acceleration + port.base_acceleration * full)
        if port.current:
            floor = floor._replace(command=None, coil_current=np.maximum(self.current + port.current * full, 0.0))
        forces = Forces(port.frame_force * full, port.driver_force * full)
        inputs = recorded._replace(floor=floor, forces=forces)
        try:
            outputs = problem.simulated(self.run, self.parameters.deviations, self.parameters.effects, inputs)
        except RunError:
            return np.full(problem.measured[self.run].shape, FAR_OFF * problem.spread[:, None])
        if port.load_cell_error and "damper_force" in problem.channels:
            outputs[problem.channels.index("damper_force")] += port.load_cell_error * signal
        return outputs

    def attempt(self, signal: Array) -> _Attempt:
        """Return what the channels are with a signal at the port, and how they then differ from the measured ones."""
        outputs = self.simulate_with(signal)
        return _Attempt(signal, outputs, self.objective.weights(self.problem.measured[self.run] - outputs, self.run))

    def draw_probe(self, corner: float, seed: int) -> Array:
        """Return a small random signal whose spectrum falls above a corner in Hz."""
        plant, floor = self.problem.scenario.plant, self.problem.seat_inputs(self.run).floor
        assert plant is not None
        mass = 1.0 if self.port.base_acceleration else plant.driver_mass
        white = np.fft.rfft(np.random.default_rng(seed).standard_normal(self.samples))
        frequency = np.fft.rfftfreq(self.samples, 1.0 / self.problem.rate)
        red = np.fft.irfft(white / (1.0 + frequency / corner), self.samples)
        return np.asarray(_PROBE_SIZE * float(np.std(floor.acceleration)) * mass * (red / np.std(red)))

    def plausible_power(self) -> Array:
        """Return the power of plausible signals, shape (frequencies,)."""
        probe = np.fft.rfft(self.draw_probe(_PLAUSIBLE_CORNER, 1))[: self.objective.weights.bins[self.run]]
        return self.problem.settings.localisation.largest_input**2 * measure_power(probe)

    def measure_response(self, signal: Array, outputs: Array, seed: int) -> Spectra:
        """Return the frequency response of the whitened channels to the signal, shape (channels, frequencies).

        The response is taken about a signal and its outputs, by adding a small random signal.
        """
        probe = self.draw_probe(_PROBE_CORNER, seed)
        change = np.fft.rfft(self.simulate_with(signal + probe) - outputs)
        response = estimate_response(change, np.fft.rfft(probe))
        weights = self.objective.weights.weights[self.run]
        return np.asarray(weights * response[:, : weights.shape[1]])


class InputEstimate(NamedTuple):
    """Estimate of a block's input in a run: whitened residuals, frequency response, power, and signal.

    Where the simulation is driven by the input, `residuals` is what the driven simulation leaves plus what the signal
    explains by the last frequency response.
    """

    residuals: Array
    response: Spectra
    power: Array
    signal: Array


def _match_input(response: Spectra, whitened: Array, power: Array) -> Spectra:
    """Return the spectrum of the input of a plausible power that explains whitened residuals best, (frequencies,).

    It ends at the highest frequency that is compared; a transform back takes what is above as 0.
    """
    matched = np.sum(response.conj() * as_complex(whitened), axis=0)
    return np.asarray(matched / (np.sum(np.abs(response) ** 2, axis=0) + 2.0 / power))


def estimate_input(
    objective: Objective, evaluation: Evaluation, run: str, port: Port, highest: float = np.inf
) -> InputEstimate:
    """Return the estimate of an input, below a highest frequency in Hz, that matches the channels as well as it can.

    The frequency response is estimated anew, about the signal so far and with another random probe, where a correction
    by the last one was fruitless: a strong signal changes how the damper slips.
    """
    rig = Reconstruction(objective, evaluation.parameters, run, port)
    bins = objective.weights.bins[run]
    permitted = np.fft.rfftfreq(rig.samples, 1.0 / objective.problem.rate)[:bins] <= highest
    plausible = rig.plausible_power()
    best, fruitless, stale = rig.attempt(np.zeros(rig.samples)), 0, True
    for seed in range(1, _ROUNDS + 1):
        before = best.cost
        if stale:
            response = rig.measure_response(best.signal, best.outputs, seed)
        step = np.fft.irfft(permitted * _match_input(response, best.residuals, plausible), rig.samples)
        tries = (rig.attempt(best.signal + part * step) for part in _BACKTRACKING)
        best = next((tried for tried in tries if tried.cost < before), best)
        stale = best.cost > (1.0 - _SETTLED) * before
        fruitless = fruitless + 1 if stale else 0
        if fruitless == _FRUITLESS or best.cost < best.residuals.size:
            break
    spectrum = np.fft.rfft(best.signal)
    power = measure_power(spectrum[:bins])
    explained = response * spectrum[:bins]
    spectrum[:bins] *= wiener_share(np.sum(np.abs(response) ** 2, axis=0) * power)
    whole = best.residuals + np.concatenate([explained.real, explained.imag], axis=1)
    return InputEstimate(whole, response, power, np.fft.irfft(spectrum, rig.samples))


def estimate_current(objective: Objective, evaluation: Evaluation, run: str) -> InputEstimate:
    """Return the logged current less the simulated one, as the estimate of an input."""
    k, samples = objective.problem.channels.index("coil_current"), objective.problem.measured[run].shape[1]
    weights = objective.weights.weights[run]
    error = as_complex(evaluation.whitened[run])[k]
    signal = np.fft.irfft(error / weights[k] * wiener_share(measure_power(error)), samples)
    rig = Reconstruction(objective, evaluation.parameters, run, Port(current=1.0))
    residuals = rig.attempt(signal).residuals
    residuals[k] = evaluation.whitened[run][k]
    return InputEstimate(residuals, respond_to_error(weights, k), measure_power(error / weights[k]), signal)


def estimate_error(objective: Objective, evaluation: Evaluation, run: str, k: int) -> InputEstimate:
    """Return the error of the sensor of channel `k` that would explain its residuals."""
    weights, residuals = objective.weights.weights[run], evaluation.whitened[run]
    power = measure_power(as_complex(residuals)[k] / weights[k])
    return InputEstimate(residuals, respond_to_error(weights, k), power, evaluation.residuals[run][k])


def respond_to_error(weights: Array, k: int) -> Spectra:
    """Return the response of the whitened channels to a unit error of channel `k`, shape (channels, frequencies)."""
    return np.asarray(np.eye(len(weights))[:, k : k + 1] * weights, dtype=complex)
