"""Weights by which residuals of all channels and frequencies become comparable, from what noise and model leave.

    P(f) = noise^2 + input noise carried through the rig + (TRUST spectrum of the channel)^2

is the power that a perfect model leaves: the stated noise; the noise of the recorded floor that drives the simulation,
and of the coil current where no command is recorded, found by simulating it; and a small share of the signal for what
no model of finite order gets right. It is never fitted to the residual under test, which would hide narrow gaps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft

from seatsim.diagnosis.problem import POOL, Problem
from seatsim.excitations.base import Floor
from seatsim.simulation.inputs import BenchInputs, Forces

Array = NDArray[np.float64]

HIGHEST = 100.0
"""Hz; content above it is left out."""
TRUST = 0.01
"""Share of a channel's local amplitude spectrum that a right model may miss."""
SMOOTH = 0.15
"""Half-width, relative to the frequency, over which spectra are averaged."""
TWINS = 3
"""Simulations with drawn floor noise per run."""


@dataclass(frozen=True)
class Whitening:
    """Turns residuals into whitened numbers: `weights[run]` has shape (channels, frequencies)."""

    weights: dict[str, Array]
    bins: dict[str, int]

    def __call__(self, residual: Array, run: str) -> Array:
        """Return the whitened residual, shape (channels, 2 frequencies), mean square 1 where only noise is left."""
        spectrum = rfft(residual, axis=1)[:, : self.bins[run]] * self.weights[run]
        return np.concatenate([spectrum.real, spectrum.imag], axis=1)


def whitening(
    problem: Problem, pushes: Mapping[str, Array] | None = None, errors: Mapping[str, Array] | None = None
) -> Whitening:
    """Return the weights for a recording.

    `pushes` are courses of a random force on the frame in N by run, shape (samples,), whose power counts as noise;
    `errors` are power spectra of errors of the channels, shape (channels, frequencies) or (channels, 1).
    """
    rate = problem.recording.header.sample_rate
    repeated = _unrepeatable(problem)
    weights, bins = {}, {}
    for run in problem.runs:
        measured = problem.measured[run]
        samples = measured.shape[1]
        frequency = np.fft.rfftfreq(samples, 1.0 / rate)
        bins[run] = _compared(frequency, rate)
        power = problem.noise[:, None] ** 2 * samples + _carried(problem, run, (pushes or {}).get(run))
        if errors is not None:
            power = power + errors[run]
        if repeated is not None:
            power = np.maximum(
                power, np.array([np.interp(frequency, repeated[0], row) for row in repeated[1]]) * samples
            )
        signal = np.abs(np.fft.rfft(measured - measured.mean(axis=1, keepdims=True), axis=1)) ** 2
        total = power + TRUST**2 * smoothed(signal)
        total = np.maximum(total, 1e-6 * problem.spread[:, None] ** 2 * samples)
        weights[run] = np.sqrt(2.0 / total[:, : bins[run]])
    return Whitening(weights, bins)


def even(problem: Problem, power: Mapping[str, Array]) -> Whitening:
    """Return weights that are the same at all frequencies, from white power by run, shape (channels, 1)."""
    rate = problem.recording.header.sample_rate
    weights, bins = {}, {}
    for run in problem.runs:
        bins[run] = _compared(np.fft.rfftfreq(problem.measured[run].shape[1], 1.0 / rate), rate)
        weights[run] = np.tile(np.sqrt(2.0 / power[run]), bins[run])
    return Whitening(weights, bins)


def _compared(frequency: NDArray[np.floating[Any]], rate: float) -> int:
    """Return how many frequencies in Hz are compared: those below HIGHEST and below half the rate."""
    return int(np.searchsorted(frequency, min(HIGHEST, 0.5 * rate)))


def _carried(problem: Problem, run: str, push: Array | None) -> Array:
    """Return the power spectrum that the noise of the recorded inputs, and a random push, leave in the outputs."""
    inputs = problem.inputs[run]
    if isinstance(inputs, BenchInputs):
        return np.zeros((len(problem.channels), 1))
    rng = np.random.default_rng(0)
    floor = inputs.floor
    drawn = [
        inputs._replace(floor=_noisy(problem, floor, rng), forces=_drawn(problem, floor, push, rng))
        for _ in range(TWINS)
    ]
    clean = problem.simulated(run, problem.rest, ())
    twins = list(POOL.map(lambda noisy: problem.simulated(run, problem.rest, (), noisy), drawn))
    return smoothed(np.mean([np.abs(np.fft.rfft(twin - clean, axis=1)) ** 2 for twin in twins], axis=0))


def broadband(problem: Problem, residual: Mapping[str, Array]) -> dict[str, Array]:
    """Return by run the white power, shape (channels, 1), of residuals that are twice the stated noise above HIGHEST.

    A force that chatters between two values is sampled as white noise, which no model foretells.
    """
    found = {}
    for run, values in residual.items():
        frequency = np.fft.rfftfreq(values.shape[1], 1.0 / problem.recording.header.sample_rate)
        power = np.abs(np.fft.rfft(values, axis=1)[:, frequency > HIGHEST]) ** 2
        level = np.median(power, axis=1) / np.log(2.0) if power.size else np.zeros(len(values))
        stated = problem.noise**2 * values.shape[1]
        found[run] = np.where(level > 2.0 * stated, level - stated, 0.0)[:, None]
    return found


def _noisy(problem: Problem, floor: Floor, rng: np.random.Generator) -> Floor:
    """Return the inputs of a run with the noise of their sensors once more."""
    every, channels = np.arange(len(floor.acceleration)), problem.recording.channels
    rows = every[:: problem.parts]

    def noise(channel: str) -> Array:
        return np.interp(every, rows, channels[channel].noise_rms * rng.standard_normal(len(rows)))

    noisy = floor._replace(acceleration=floor.acceleration + noise("floor_acceleration"))
    if floor.command is None and floor.coil_current is not None:
        noisy = noisy._replace(coil_current=floor.coil_current + noise("coil_current"))
    return noisy


def _drawn(problem: Problem, floor: Floor, push: Array | None, rng: np.random.Generator) -> Forces:
    """Return a random force like a push, on the simulation's steps."""
    if push is None:
        return Forces()
    every = np.arange(len(floor.acceleration))
    rows = every[:: problem.parts]
    return Forces(np.interp(every, rows[: len(push)], _shuffled(push, rng), right=0.0))


def _shuffled(course: Array, rng: np.random.Generator) -> Array:
    """Return a course with the same spectrum and random phases."""
    spectrum = np.fft.rfft(course)
    return np.fft.irfft(np.abs(spectrum) * np.exp(2j * np.pi * rng.random(len(spectrum))), len(course))


def smoothed(power: Array) -> Array:
    """Return a power spectrum, shape (channels, frequencies), averaged over a constant relative band."""
    count = power.shape[1]
    cumulated = np.concatenate([np.zeros((len(power), 1)), np.cumsum(power, axis=1)], axis=1)
    index = np.arange(count)
    half = np.maximum(4, (SMOOTH * index).astype(int))
    low, high = np.maximum(0, index - half), np.minimum(count, index + half + 1)
    return np.asarray((cumulated[:, high] - cumulated[:, low]) / (high - low))


def _unrepeatable(problem: Problem) -> tuple[Array, Array] | None:
    """Return frequencies and the power per sample by which runs differ from those that they repeat, None without any.

    The difference of two repeats holds twice the power that does not repeat.
    """
    found = []
    for run, entry in problem.recording.runs.items():
        if entry.repeat_of is None or run not in problem.runs or entry.repeat_of not in problem.runs:
            continue
        first, second = problem.measured[entry.repeat_of], problem.measured[run]
        samples = min(first.shape[1], second.shape[1])
        spectrum = np.fft.rfft(first[:, :samples] - second[:, :samples], axis=1)
        frequency = np.arange(samples // 2 + 1) * problem.recording.header.sample_rate / samples
        found.append((frequency, 0.5 * smoothed(np.abs(spectrum) ** 2) / samples))
    if not found:
        return None
    frequency = found[0][0]
    resampled = [[np.interp(frequency, f, row) for row in power] for f, power in found]
    mean: Array = np.mean(resampled, axis=0)
    return frequency, mean
