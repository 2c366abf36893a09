"""Noise of the recorded inputs, carried through the nominal rig to the compared channels by simulation.

A replicate is a run whose inputs have newly drawn noise of their sensors' stated size; its power is that of the
difference in the outputs. The motion of a bench follows a spline that is smoothed to within its noise (see
`seatsim.simulation.respond`). A replicate draws its noise about that path and is smoothed as the record was, so
that what is carried is the noise of the smoothed path, not that of the sensor.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from scipy.interpolate import LSQUnivariateSpline

from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.spectra import randomise_phases, smooth_spectrum
from seatsim.schema.arrays import Array
from seatsim.simulation.inputs import BenchInputs, Forces, RigInputs, SeatInputs
from seatsim.simulation.respond import fit_motion


def carry_input_noise(problem: DiagnosisProblem, run: str) -> Array:
    """Return the power spectrum that noise of a run's inputs causes in its outputs, shape (channels, frequencies)."""
    inputs = problem.inputs[run]
    if isinstance(inputs, BenchInputs):
        return _carry(problem, run, lambda rng: _draw_bench(problem, inputs, rng))
    return _carry(problem, run, lambda rng: _draw_floor(problem, inputs, rng))


def carry_force(problem: DiagnosisProblem, forces: Mapping[str, Array]) -> dict[str, Array]:
    """Return by run the power spectrum that a random force on a seat's frame causes, shape (channels, frequencies).

    `forces[run]` is a signal of it in N, shape (samples,).
    """

    def carry(run: str, force: Array) -> Array:
        inputs = problem.inputs[run]
        assert isinstance(inputs, SeatInputs)
        return _carry(problem, run, lambda rng: inputs._replace(forces=_draw_force(problem, inputs, force, rng)))

    return {run: carry(run, forces[run]) for run in problem.runs}


def _carry(problem: DiagnosisProblem, run: str, draw: Callable[[np.random.Generator], RigInputs]) -> Array:
    """Return the power spectrum by which the outputs change under inputs that are drawn, (channels, frequencies)."""
    # The same draws for every recording: equal input gives equal output.
    rng = np.random.default_rng(0)
    drawn = [draw(rng) for _ in range(problem.settings.noise.replicates)]
    clean = problem.simulated(run, problem.nominal, ())
    replicates = problem.pool.map(lambda noisy: problem.simulated(run, problem.nominal, (), noisy), drawn)
    power = np.mean([np.abs(np.fft.rfft(noisy - clean, axis=1)) ** 2 for noisy in replicates], axis=0)
    return smooth_spectrum(power, problem.settings.noise.smoothing)


def _draw_bench(problem: DiagnosisProblem, inputs: BenchInputs, rng: np.random.Generator) -> BenchInputs:
    """Return the inputs of a bench with newly drawn noise of its motion, and of a current that drives the damper."""

    def noise(channel: str) -> Array:
        return problem.recording.channels[channel].noise_rms * rng.standard_normal(len(inputs.displacement))

    spline = fit_motion(inputs.interval, inputs.displacement.tobytes(), inputs.displacement_noise)
    rows = inputs.interval * np.arange(len(inputs.displacement))
    # Fitting a spline with the knots of the record's is as smooth as choosing them anew, which takes seconds.
    knots = spline.get_knots()[1:-1]
    smoothed = LSQUnivariateSpline(rows, spline(rows) + noise("displacement"), knots, k=5)(rows)
    noisy = inputs._replace(displacement=smoothed, displacement_noise=0.0)
    if inputs.velocity is not None:
        noisy = noisy._replace(velocity=inputs.velocity + noise("velocity"))
    if inputs.coil_current is not None and inputs.current_command is None and inputs.command_voltage is None:
        noisy = noisy._replace(coil_current=inputs.coil_current + noise("coil_current"))
    return noisy


def _draw_floor(problem: DiagnosisProblem, inputs: SeatInputs, rng: np.random.Generator) -> SeatInputs:
    """Return the inputs of a seat with newly drawn noise of its floor, and of a current that drives the damper."""
    floor, channels = inputs.floor, problem.recording.channels
    every = np.arange(len(floor.acceleration))
    rows = every[:: problem.parts]

    def noise(channel: str) -> Array:
        return np.interp(every, rows, channels[channel].noise_rms * rng.standard_normal(len(rows)))

    noisy = floor._replace(acceleration=floor.acceleration + noise("floor_acceleration"))
    if floor.command is None and floor.coil_current is not None:
        noisy = noisy._replace(coil_current=floor.coil_current + noise("coil_current"))
    return inputs._replace(floor=noisy)


def _draw_force(problem: DiagnosisProblem, inputs: SeatInputs, force: Array, rng: np.random.Generator) -> Forces:
    """Return a random force on the frame with the spectrum of the one given, on the simulation's steps."""
    every = np.arange(len(inputs.floor.acceleration))
    rows = every[:: problem.parts]
    return Forces(np.interp(every, rows[: len(force)], randomise_phases(force, rng), right=0.0))
