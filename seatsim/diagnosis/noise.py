"""The noise of a recording, as one sum of power spectra, and the weights by it that make residuals comparable.

    P(f) = noise^2 + input noise carried through the rig + (model_error * spectrum of the channel)^2 + disturbances

is the power that a perfect model leaves: the stated noise, the noise of the recorded inputs (the floor or the motion of
a bench, and the coil current where no command is recorded) carried through the simulation, a share of the signal that
no model of finite order gets right, as the recording states it or else small, and random disturbances, each added as it
is found to all that is there. It is never fitted to the residual under test, which would hide narrow gaps.

What is carried is simulated: a replicate is a run whose inputs have newly drawn noise of their sensors' stated size,
and its power is that of the difference in the outputs. The motion of a bench follows a spline that is smoothed to
within its noise (see `seatsim.simulation.respond`). A replicate draws its noise about that path and is smoothed
as the record was, so that what is carried is the noise of the smoothed path, not that of the sensor.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.fft import rfft
from scipy.interpolate import LSQUnivariateSpline

from seatsim.diagnosis.problem import DiagnosisProblem, normalise_rms_errors
from seatsim.diagnosis.spectra import Spectra, as_complex, smooth_spectrum
from seatsim.schema.arrays import Array
from seatsim.simulation.inputs import BenchInputs, SeatInputs
from seatsim.simulation.respond import fit_motion

_LEVEL = 0.1
"""Share of the gap that counts as noise under uniform weights, by which what is left to explain is measured."""
_REPLICATES, _LEAST_POWER = 3, 1e-6
"""Simulations with newly drawn noise of the inputs per run, and the least noise power, as a share of a channel's
variance, without which a noiseless channel would dominate all others.
"""
_TINY = 1e-30
"""Least size of a weighted amplitude, so that nothing is divided by zero."""


def carry_input_noise(problem: DiagnosisProblem, run: str) -> Array:
    """Return the power spectrum that noise of a run's inputs causes in its outputs, shape (channels, frequencies)."""
    # The same draws for every recording: equal input gives equal output.
    inputs, rng = problem.inputs[run], np.random.default_rng(0)
    drawn = [
        _draw_bench(problem, inputs, rng) if isinstance(inputs, BenchInputs) else _draw_floor(problem, inputs, rng)
        for _ in range(_REPLICATES)
    ]
    clean = problem.simulated(run, problem.nominal, ())
    replicates = problem.pool.map(lambda noisy: problem.simulated(run, problem.nominal, (), noisy), drawn)
    power = np.mean([np.abs(np.fft.rfft(noisy - clean, axis=1)) ** 2 for noisy in replicates], axis=0)
    return smooth_spectrum(power)


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


@dataclass(frozen=True)
class NoiseWeights:
    """Turns residuals into whitened numbers, by the covariance of the noise at every frequency.

    That is `diag(power) + force force*`: `power[run]` is the power of noise that the channels have independently of
    each other, and `force[run]` the complex amplitude that a random force leaves in all of them together; both have the
    shape (channels, frequencies). Numbers are whitened by the symmetric root of the covariance, so that what the force
    cannot have done keeps its full weight.

    `independent` is the share of these numbers that count as independent of each other.
    """

    power: dict[str, Array]
    independent: float = 1.0
    force: Mapping[str, Spectra] = field(default_factory=dict)

    @cached_property
    def weights(self) -> dict[str, Array]:
        """Factors on the spectra of the residuals by run, shape (channels, frequencies)."""
        # A spectrum's real and imaginary part have half of its power each.
        return {run: np.sqrt(2.0 * self.independent / power) for run, power in self.power.items()}

    @cached_property
    def bins(self) -> dict[str, int]:
        """How many frequencies of each run are compared."""
        return {run: power.shape[1] for run, power in self.power.items()}

    @cached_property
    def _directions(self) -> dict[str, tuple[Spectra, Array]]:
        """The unit vector of the weighted force by run, and its power relative to the other noise along it."""
        found = {}
        for run, amplitude in self.force.items():
            weighted = self.weights[run] * amplitude
            size = np.linalg.norm(weighted, axis=0)
            found[run] = (weighted / np.maximum(size, _TINY), 0.5 * size**2 / self.independent)
        return found

    def __call__(self, residuals: Array, run: str) -> Array:
        """Return whitened residuals, shape (channels, 2 frequencies), mean square `independent` for noise alone."""
        spectrum = rfft(residuals, axis=1)[:, : self.bins[run]] * self.weights[run]
        spectrum = self._turn(spectrum, run, -0.5)
        return np.concatenate([spectrum.real, spectrum.imag], axis=1)

    def _turn(self, weighted: Spectra, run: str, exponent: float) -> Spectra:
        """Return weighted spectra, shape (..., channels, frequencies), times this power of `I + force force*`."""
        if run not in self.force:
            return weighted
        direction, power = self._directions[run]
        along = np.sum(direction.conj() * weighted, axis=-2, keepdims=True)
        return np.asarray(weighted + direction * along * ((1.0 + power) ** exponent - 1.0))

    def expect(self, run: str) -> Array:
        """Return the power of all noise in a run, shape (channels, frequencies)."""
        power = self.power[run] / self.independent
        return power + np.abs(self.force[run]) ** 2 if run in self.force else power

    def convert(self, whitened: Array, run: str, old: NoiseWeights) -> Array:
        """Return numbers that other weights whitened, shape (..., channels, 2 frequencies), as these whiten them."""
        spectra = old._turn(as_complex(whitened), run, 0.5) * (self.weights[run] / old.weights[run])
        spectra = self._turn(spectra, run, -0.5)
        return np.concatenate([spectra.real, spectra.imag], axis=-1)

    def add(self, disturbance: Mapping[str, Array]) -> NoiseWeights:
        """Return the weights with the power of one more disturbance, (channels, frequencies) or (channels, 1)."""
        summed = {run: power + disturbance[run][:, : power.shape[1]] for run, power in self.power.items()}
        return dataclasses.replace(self, power=summed)

    def add_force(self, amplitudes: Mapping[str, Spectra]) -> NoiseWeights:
        """Return the weights with a random force that leaves these amplitudes, shape (channels, frequencies) by run."""
        return dataclasses.replace(self, force=amplitudes)


def weigh_noise(problem: DiagnosisProblem, repeats: bool = True) -> NoiseWeights:
    """Return the weights for a recording: by all noise that is stated, and, with `repeats`, what repeats differ by."""
    settings, stated = problem.settings.noise, problem.recording.header.model_error
    missed = settings.model_error if stated is None else stated
    repeated = _measure_nonrepeatable(problem) if repeats else None
    found = {}
    for run in problem.runs:
        measured = problem.measured[run]
        samples = measured.shape[1]
        power = problem.noise[:, None] ** 2 * samples + carry_input_noise(problem, run)
        if repeated is not None:
            frequency = np.fft.rfftfreq(samples, 1.0 / problem.rate)
            power = np.maximum(
                power, np.array([np.interp(frequency, repeated[0], row) for row in repeated[1]]) * samples
            )
        signal = np.abs(np.fft.rfft(measured - measured.mean(axis=1, keepdims=True), axis=1)) ** 2
        total = power + missed**2 * smooth_spectrum(signal)
        total = np.maximum(total, _LEAST_POWER * problem.spread[:, None] ** 2 * samples)
        found[run] = total[:, : _count_compared(problem, samples)]
    return NoiseWeights(found)


def weigh_uniformly(problem: DiagnosisProblem, variance: Array, independent: float = 1.0) -> NoiseWeights:
    """Return weights that are the same at all frequencies, from the variance of white noise, shape (channels,)."""
    samples = {run: problem.measured[run].shape[1] for run in problem.runs}
    power = {run: np.tile(variance[:, None] * n, _count_compared(problem, n)) for run, n in samples.items()}
    return NoiseWeights(power, independent)


def weigh_gap(problem: DiagnosisProblem, residuals: Mapping[str, Array]) -> NoiseWeights:
    """Return weights that are the same at all frequencies, from the power of the given residuals over all runs.

    What a rig leaves whose form is wrong is no noise: its numbers depend on each other, so that few of them count as
    independent. A parameter inside its tolerance then weighs as much as what it takes off the gap.
    """
    independent, errors = problem.settings.noise.independent, normalise_rms_errors(problem, residuals)
    variance = (_LEVEL * np.sqrt(np.mean(errors**2)) * problem.spread) ** 2
    compared = 2 * sum(each.size for each in weigh_uniformly(problem, variance).power.values())
    return weigh_uniformly(problem, variance, _LEVEL**2 * independent / compared)


def measure_broadband(problem: DiagnosisProblem, residuals: Mapping[str, Array]) -> dict[str, Array]:
    """Return by run the white power, shape (channels, 1), of residuals that exceed the stated noise above all compared.

    A force that switches rapidly between two values is sampled as white noise, which no model predicts.
    """
    settings, found = problem.settings.noise, {}
    for run, values in residuals.items():
        frequency = np.fft.rfftfreq(values.shape[1], 1.0 / problem.rate)
        power = np.abs(np.fft.rfft(values, axis=1)[:, frequency > settings.highest_frequency]) ** 2
        # The median of an exponential distribution, which powers of white noise follow, is its mean times log 2.
        level = np.median(power, axis=1) / np.log(2.0) if power.size else np.zeros(len(values))
        stated = problem.noise**2 * values.shape[1]
        found[run] = np.where(level > settings.broadband_excess * stated, level - stated, 0.0)[:, None]
    return found


def _count_compared(problem: DiagnosisProblem, samples: int) -> int:
    """Return how many frequencies of a run are compared: those below the highest one and below half the rate."""
    frequency = np.fft.rfftfreq(samples, 1.0 / problem.rate)
    return int(np.searchsorted(frequency, min(problem.settings.noise.highest_frequency, 0.5 * problem.rate)))


def _measure_nonrepeatable(problem: DiagnosisProblem) -> tuple[Array, Array] | None:
    """Return frequencies and the power per sample of the non-repeatable disturbance, None without repeated runs."""
    found = []
    for signal in _list_nonrepeatable(problem):
        samples = signal.shape[1]
        power = smooth_spectrum(np.abs(np.fft.rfft(signal, axis=1)) ** 2)
        found.append((np.arange(samples // 2 + 1) * problem.rate / samples, power / samples))
    if not found:
        return None
    frequency = found[0][0]
    resampled = [[np.interp(frequency, f, row) for row in power] for f, power in found]
    mean: Array = np.mean(resampled, axis=0)
    return frequency, mean


def differ_materially(problem: DiagnosisProblem) -> bool:
    """Whether what repeats differ by, beyond the noise, is of a material size in some channel."""
    power = [np.mean(signal**2, axis=1) - problem.noise**2 for signal in _list_nonrepeatable(problem)]
    return any(np.any(each > (problem.settings.decision.material * problem.spread) ** 2) for each in power)


def _list_nonrepeatable(problem: DiagnosisProblem) -> list[Array]:
    """Return a signal with the power of the non-repeatable disturbance for each repeat, shape (channels, samples).

    The difference of two repeats has twice its power.
    """
    measured, pairs = problem.measured, problem.repeats
    lengths = [min(measured[first].shape[1], measured[second].shape[1]) for first, second in pairs]
    return [(measured[a][:, :n] - measured[b][:, :n]) / np.sqrt(2.0) for (a, b), n in zip(pairs, lengths, strict=True)]
