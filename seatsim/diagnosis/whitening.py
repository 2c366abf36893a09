"""Weights by which residuals of all channels and frequencies become comparable, from what noise and model leave.

    P(f) = noise^2 + floor noise carried through the rig + (TRUST spectrum of the channel)^2

is the power that a perfect model leaves: the stated noise, the noise of the recorded floor that drives the simulation
(found by simulating it), and a small share of the signal for what no model of finite order gets right. It is never
fitted to the residual under test, which would hide narrow gaps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.problem import POOL, Problem

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
        spectrum = np.fft.rfft(residual, axis=1)[:, : self.bins[run]] * self.weights[run]
        return np.concatenate([spectrum.real, spectrum.imag], axis=1)


def whitening(problem: Problem) -> Whitening:
    """Return the weights for a recording."""
    rate = problem.recording.header.sample_rate
    weights, bins = {}, {}
    for run in problem.runs:
        measured = problem.measured[run]
        samples = measured.shape[1]
        frequency = np.fft.rfftfreq(samples, 1.0 / rate)
        bins[run] = int(np.searchsorted(frequency, min(HIGHEST, 0.5 * rate)))
        power = problem.noise[:, None] ** 2 * samples + _carried(problem, run)
        signal = np.abs(np.fft.rfft(measured - measured.mean(axis=1, keepdims=True), axis=1)) ** 2
        total = power + TRUST**2 * _smoothed(signal)
        total = np.maximum(total, 1e-6 * problem.spread[:, None] ** 2 * samples)
        weights[run] = np.sqrt(2.0 / total[:, : bins[run]])
    return Whitening(weights, bins)


def _carried(problem: Problem, run: str) -> Array:
    """Return the power spectrum that the noise of the recorded floor leaves in the outputs."""
    floor = problem.floors[run]
    if floor is None:
        return np.zeros((len(problem.channels), 1))
    rng = np.random.default_rng(0)
    rate, step = problem.recording.header.sample_rate, floor.step
    noise = problem.recording.channels["floor_acceleration"].noise_rms
    rows = np.arange(0, len(floor.acceleration), round(1.0 / rate / step))

    def shaken(index: int) -> Array:
        drawn = np.interp(np.arange(len(floor.acceleration)), rows, draws[index])
        noisy = floor._replace(acceleration=floor.acceleration + drawn)
        return problem.simulated(run, problem.rest, (), noisy)

    draws = noise * rng.standard_normal((TWINS, len(rows)))
    clean = problem.simulated(run, problem.rest, ())
    twins = list(POOL.map(shaken, range(TWINS)))
    power = np.mean([np.abs(np.fft.rfft(twin - clean, axis=1)) ** 2 for twin in twins], axis=0)
    return _smoothed(power)


def _smoothed(power: Array) -> Array:
    """Return a power spectrum, shape (channels, frequencies), averaged over a constant relative band."""
    count = power.shape[1]
    cumulated = np.concatenate([np.zeros((len(power), 1)), np.cumsum(power, axis=1)], axis=1)
    index = np.arange(count)
    half = np.maximum(4, (SMOOTH * index).astype(int))
    low, high = np.maximum(0, index - half), np.minimum(count, index + half + 1)
    return np.asarray((cumulated[:, high] - cumulated[:, low]) / (high - low))
