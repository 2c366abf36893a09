"""Standard deviations of fitted parameters.

A fit weighs the whitened numbers r by `K = (J J' + P)^-1 J`, so that its estimate moves by `K r`. What moves it is

- noise: `K K'`, or what blocks of time show, `sum over blocks b of (K_b r_b)(K_b r_b)'`, where that is more, as with
  residuals that are correlated in time or between channels (the sandwich of Huber 1967, clustered by time);
- parameters inside their tolerance: `(J J' + P)^-1 P (J J' + P)^-1`;
- the model's form: a band of a channel may be wrong by one share of its amplitude, at the phase that moves the estimate
  most, which no longer run averages out. The share e is taken to be that which the residual shows beyond stated noise
  and chance, since what parameters could not absorb is the only witness of what they did: `e^2 |sum of conj(K) y|^2`
  over the band, with y the whitened spectrum of what was measured.

Whether their 90 % intervals cover is measured by `benchmarks/diagnosis_intervals.py`.
"""

from __future__ import annotations

import numpy as np

from seatsim.diagnosis.objective import PRIOR_STD, Evaluation, Linearisation, Objective
from seatsim.diagnosis.spectra import Spectra, as_complex
from seatsim.recordings.model_error import band_edges, band_powers, band_widths
from seatsim.schema.arrays import Array

BLOCK_LENGTH = 1.0
"""s; length of blocks of time, as of a bootstrap: several periods of the seat's resonance, and many in a run."""


def estimate_standard_deviations(objective: Objective, evaluation: Evaluation, nuisances: Linearisation) -> Array:
    """Return the standard deviations of `vector`, shape (components,); `nuisances` are the sensitivities about it."""
    own = objective.linearise_effects(evaluation).jacobian
    jacobian = {run: np.concatenate([nuisances.jacobian[run], own[run]]) for run in own}
    prior = np.zeros(len(next(iter(jacobian.values()))))
    prior[: len(evaluation.parameters.deviations)] = PRIOR_STD**-2
    inverse = np.linalg.pinv(np.sum([each @ each.T for each in jacobian.values()], axis=0) + np.diag(prior))
    channels = len(objective.problem.channels)
    gains = {run: as_complex((inverse @ each).reshape(len(prior), channels, -1)) for run, each in jacobian.items()}
    white = np.sum([np.sum(np.abs(gain) ** 2, axis=(1, 2)) for gain in gains.values()], axis=0)
    noise = np.maximum(white, _measure_block_variance(objective, evaluation, gains))
    variance = noise + inverse**2 @ prior + _measure_form_variance(objective, evaluation, gains)
    return np.asarray(np.sqrt(variance))


def _measure_block_variance(objective: Objective, evaluation: Evaluation, gains: dict[str, Spectra]) -> Array:
    """Return the variance of the estimate that the residuals of blocks of time show, shape (components,)."""
    length, moves = BLOCK_LENGTH * objective.problem.rate, []
    for run, gain in gains.items():
        residual = _as_signals(as_complex(evaluation.whitened[run]))
        count = max(1, round(objective.problem.measured[run].shape[1] / length))
        moved = np.sum(_as_signals(gain) * residual, axis=1)
        moves += [np.sum(block, axis=1) for block in np.array_split(moved, count, axis=1)]
    return np.asarray(len(moves) * np.var(moves, axis=0, ddof=min(1, len(moves) - 1)))


def _as_signals(spectra: Spectra) -> Array:
    """Return signals of which inner products are those of real and imaginary parts of the spectra, (..., samples)."""
    samples = 2 * spectra.shape[-1]
    halved = spectra.copy()
    halved[..., 0] *= np.sqrt(2.0)
    return np.asarray(np.fft.irfft(halved, samples, axis=-1) * np.sqrt(0.5 * samples))


def _measure_form_variance(objective: Objective, evaluation: Evaluation, gains: dict[str, Spectra]) -> Array:
    """Return the variance of the estimate by errors of the model's form, shape (components,)."""
    problem = objective.problem
    edges = band_edges(min(problem.settings.noise.highest_frequency, 0.5 * problem.rate))
    left, chance, signal = np.zeros((3, len(problem.channels), len(edges)))
    for run in gains:
        measured = problem.measured[run]
        noise = problem.noise[:, None] ** 2 * band_widths(problem.rate, edges)
        left += _band_powers(evaluation.residuals[run], problem.rate, edges) - noise
        # The mean square of noise in n frequencies varies by 1 / sqrt(n) of it.
        chance += noise**2 / np.maximum(0.5 * measured.shape[1] * band_widths(problem.rate, edges), 1.0)
        signal += _band_powers(measured - measured.mean(axis=1, keepdims=True), problem.rate, edges)
    left = np.maximum(left - problem.settings.validation.by_chance * np.sqrt(chance), 0.0)
    moves = np.sum([_sum_bands(objective, run, gain, edges) for run, gain in gains.items()], axis=0)
    # A mean that is missed is no share of a signal.
    signal[:, 0] = 0.0
    share = np.divide(left, signal, out=np.zeros_like(left), where=signal > 0.0)
    return np.asarray(np.sum(share * np.abs(moves) ** 2, axis=(1, 2)))


def _band_powers(channels: Array, rate: float, edges: Array) -> Array:
    """Return the mean squares of channels, shape (channels, samples), by band, shape (channels, bands)."""
    return np.array([band_powers(values, rate, edges) for values in channels])


def _sum_bands(objective: Objective, run: str, gain: Spectra, edges: Array) -> Spectra:
    """Return `sum of conj(K) y` over each band, shape (components, channels, bands)."""
    measured = objective.problem.measured[run]
    spectra = as_complex(objective.weights(measured - measured.mean(axis=1, keepdims=True), run))
    frequency = np.fft.rfftfreq(measured.shape[1], 1.0 / objective.problem.rate)[: spectra.shape[1]]
    inside = frequency >= edges[:, None]
    inside &= ~np.vstack([inside[1:], np.zeros_like(frequency, dtype=bool)])
    return np.asarray((gain.conj() * spectra) @ inside.T)
