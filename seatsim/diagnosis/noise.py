"""Weights that make the residuals of all channels and frequencies comparable, from noise and model error.

    P(f) = noise^2 + input noise carried through the rig + (model_error * spectrum of the channel)^2

is the power that a perfect model leaves: the stated noise, the noise of the recorded inputs (the floor or the motion of
a bench, and the coil current where no command is recorded) carried through the simulation, and a share of the signal
that no model of finite order gets right, as the recording states it or else small. It is never fitted to the residual
under test, which would hide narrow gaps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft

from seatsim.diagnosis.input_noise import carry_input_noise
from seatsim.diagnosis.problem import DiagnosisProblem, normalise_rms_errors
from seatsim.diagnosis.spectra import smooth_spectrum

Array = NDArray[np.float64]


@dataclass(frozen=True)
class NoiseWeights:
    """Turns residuals into whitened numbers: `weights[run]` has shape (channels, frequencies)."""

    weights: dict[str, Array]
    bins: dict[str, int]

    def __call__(self, residuals: Array, run: str) -> Array:
        """Return whitened residuals, shape (channels, 2 frequencies), mean square 1 where only noise is left."""
        spectrum = rfft(residuals, axis=1)[:, : self.bins[run]] * self.weights[run]
        return np.concatenate([spectrum.real, spectrum.imag], axis=1)


def weigh_noise(
    problem: DiagnosisProblem, forces: Mapping[str, Array] | None = None, errors: Mapping[str, Array] | None = None
) -> NoiseWeights:
    """Return the weights for a recording.

    Args:
        problem: the recording beside its nominal scenario.
        forces: signals of a random force on the frame in N by run, shape (samples,), whose power counts as noise.
        errors: power spectra of errors of the channels, shape (channels, frequencies) or (channels, 1).
    """
    settings, stated = problem.settings.noise, problem.recording.header.model_error
    missed = settings.model_error if stated is None else stated
    repeated = _measure_nonrepeatable(problem)
    weights, bins = {}, {}
    for run in problem.runs:
        measured = problem.measured[run]
        samples = measured.shape[1]
        frequency = np.fft.rfftfreq(samples, 1.0 / problem.rate)
        bins[run] = _count_compared(problem, samples)
        power = problem.noise[:, None] ** 2 * samples + carry_input_noise(problem, run, (forces or {}).get(run))
        if errors is not None:
            power = power + errors[run]
        if repeated is not None:
            power = np.maximum(
                power, np.array([np.interp(frequency, repeated[0], row) for row in repeated[1]]) * samples
            )
        signal = np.abs(np.fft.rfft(measured - measured.mean(axis=1, keepdims=True), axis=1)) ** 2
        total = power + missed**2 * smooth_spectrum(signal, settings.smoothing)
        total = np.maximum(total, settings.least_power * problem.spread[:, None] ** 2 * samples)
        # A spectrum's real and imaginary part have half of its power each.
        weights[run] = np.sqrt(2.0 / total[:, : bins[run]])
    return NoiseWeights(weights, bins)


def weigh_uniformly(problem: DiagnosisProblem, power: Mapping[str, Array]) -> NoiseWeights:
    """Return weights that are the same at all frequencies, from white power by run, shape (channels, 1)."""
    weights, bins = {}, {}
    for run in problem.runs:
        bins[run] = _count_compared(problem, problem.measured[run].shape[1])
        weights[run] = np.tile(np.sqrt(2.0 / power[run]), bins[run])
    return NoiseWeights(weights, bins)


def weigh_gap(problem: DiagnosisProblem, residuals: Mapping[str, Array]) -> NoiseWeights:
    """Return weights that are the same at all frequencies, from the power of the given residuals over all runs."""
    errors = normalise_rms_errors(problem, residuals)
    level = problem.settings.cross_validation.noise_level * np.sqrt(np.mean(errors**2)) * problem.spread
    return weigh_uniformly(
        problem, {run: level[:, None] ** 2 * values.shape[1] for run, values in problem.measured.items()}
    )


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
    """Return frequencies and the power per sample of the non-repeatable disturbance, None without repeated runs.

    The difference of two repeats has twice the power of that disturbance.
    """
    found = []
    for run, entry in problem.recording.runs.items():
        if entry.repeat_of is None or run not in problem.runs or entry.repeat_of not in problem.runs:
            continue
        first, second = problem.measured[entry.repeat_of], problem.measured[run]
        samples = min(first.shape[1], second.shape[1])
        spectrum = np.fft.rfft(first[:, :samples] - second[:, :samples], axis=1)
        frequency = np.arange(samples // 2 + 1) * problem.rate / samples
        smoothed = smooth_spectrum(np.abs(spectrum) ** 2, problem.settings.noise.smoothing)
        found.append((frequency, 0.5 * smoothed / samples))
    if not found:
        return None
    frequency = found[0][0]
    resampled = [[np.interp(frequency, f, row) for row in power] for f, power in found]
    mean: Array = np.mean(resampled, axis=0)
    return frequency, mean
