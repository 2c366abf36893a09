"""Input reconstruction: a run of a rig with an unknown input, the channels' response to it, and its power."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.noise import NoiseWeights
from seatsim.diagnosis.objective import Objective, Parameters
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.settings.examining import ReconstructionSettings
from seatsim.diagnosis.spectra import Spectra, estimate_response, measure_power
from seatsim.schema.arrays import Array
from seatsim.schema.errors import RunError
from seatsim.simulation.inputs import Forces, SeatInputs
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


@dataclass(frozen=True)
class Reconstruction:
    """A run of a rig with a port; `current` is that of its coil without an input, every step of the simulation."""

    problem: DiagnosisProblem
    weights: NoiseWeights
    parameters: Parameters
    run: str
    port: Port
    current: Array

    @property
    def settings(self) -> ReconstructionSettings:
        """Thresholds of the reconstruction."""
        return self.problem.settings.reconstruction

    @property
    def recorded(self) -> SeatInputs:
        """Inputs of the run."""
        inputs = self.problem.inputs[self.run]
        assert isinstance(inputs, SeatInputs)
        return inputs

    @property
    def samples(self) -> int:
        """Number of samples of a signal."""
        return int(self.problem.measured[self.run].shape[1])

    def simulate_with(self, signal: Array) -> Array:
        """Return the channels with a signal at the port, shape (channels, samples)."""
        problem, port, floor = self.problem, self.port, self.recorded.floor
        full = problem.spread_over_steps(self.recorded, signal)
        floor = floor._replace(acceleration=floor.acceleration + port.base_acceleration * full)
        if port.current:
            floor = floor._replace(command=None, coil_current=np.maximum(self.current + port.current * full, 0.0))
        forces = Forces(port.frame_force * full, port.driver_force * full)
        inputs = self.recorded._replace(floor=floor, forces=forces)
        try:
            outputs = problem.simulated(self.run, self.parameters.deviations, self.parameters.effects, inputs)
        except RunError:
            return np.full(problem.measured[self.run].shape, FAR_OFF * problem.spread[:, None])
        if port.load_cell_error and "damper_force" in problem.channels:
            outputs[problem.channels.index("damper_force")] += port.load_cell_error * signal
        return outputs

    def whiten_residuals(self, outputs: Array) -> Array:
        """Return the whitened difference of the measured channels and the outputs."""
        return self.weights(self.problem.measured[self.run] - outputs, self.run)

    def draw_probe(self, corner: float, seed: int) -> Array:
        """Return a small random signal whose spectrum falls above a corner in Hz."""
        plant = self.problem.scenario.plant
        assert plant is not None
        mass = 1.0 if self.port.base_acceleration else plant.driver_mass
        scale = self.settings.probe_size * float(np.std(self.recorded.floor.acceleration)) * mass
        return scale * _draw_red_noise(self.samples, self.problem.rate, corner, seed)

    def plausible_power(self) -> Array:
        """Return the power of plausible signals, shape (frequencies,)."""
        probe = np.fft.rfft(self.draw_probe(self.settings.plausible_corner, 1))[: self.weights.bins[self.run]]
        return self.settings.largest_input**2 * measure_power(probe, self.problem.settings.noise.smoothing)

    def measure_response(self, signal: Array, outputs: Array, seed: int = 1) -> Spectra:
        """Return the frequency response of the whitened channels to the signal, shape (channels, frequencies).

        The response is taken about a signal and its outputs, by adding a small random signal.
        """
        probe = self.draw_probe(self.settings.probe_corner, seed)
        change = np.fft.rfft(self.simulate_with(signal + probe) - outputs)
        response = estimate_response(change, np.fft.rfft(probe), self.problem.settings.noise.smoothing)
        return np.asarray(self.weights.weights[self.run] * response[:, : self.weights.bins[self.run]])


def reconstruct(objective: Objective, parameters: Parameters, run: str, port: Port) -> Reconstruction:
    """Return the run of a rig with a port, ready to be driven by an input."""
    problem = objective.problem
    current = np.zeros(0)
    if port.current:
        inputs = problem.inputs[run]
        assert isinstance(inputs, SeatInputs)
        scenario = problem.scenario_of(run, parameters.deviations, parameters.effects)
        every_step = inputs._replace(interval=inputs.floor.step)
        current = respond(scenario, every_step, carry_all_effects=True)["coil_current"]
    return Reconstruction(problem, objective.weights, parameters, run, port, current)


def _draw_red_noise(samples: int, rate: float, corner: float, seed: int) -> Array:
    """Return random numbers of unit standard deviation whose spectrum falls above a corner in Hz."""
    frequency = np.fft.rfftfreq(samples, 1.0 / rate)
    white = np.random.default_rng(seed).standard_normal(samples)
    red = np.fft.irfft(np.fft.rfft(white) / (1.0 + frequency / corner), samples)
    return np.asarray(red / np.std(red))
