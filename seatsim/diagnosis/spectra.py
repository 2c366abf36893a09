"""Spectra of whole runs: whitened numbers as complex ones, smoothed powers, and frequency responses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.arrays import Array

Spectra = NDArray[np.complex128]

_HALF_WIDTH, _FEWEST_BINS = 0.15, 4
"""Half-width of an average, relative to its frequency, and the least one in bins, so that all are averages.

A wider one smears narrow resonances; a narrower one leaves the weights themselves random.
"""
_TINY = 1e-30
"""Least power, so that nothing is divided by the zero of a silent channel."""


def smooth_spectrum(power: Array) -> Array:
    """Return a power spectrum from frequency 0 on, shape (channels, frequencies), averaged over a relative band."""
    count = power.shape[1]
    cumulated = np.concatenate([np.zeros((len(power), 1)), np.cumsum(power, axis=1)], axis=1)
    index = np.arange(count)
    half = np.maximum(_FEWEST_BINS, (_HALF_WIDTH * index).astype(int))
    low, high = np.maximum(0, index - half), np.minimum(count, index + half + 1)
    return np.asarray((cumulated[:, high] - cumulated[:, low]) / (high - low))


def measure_power(spectrum: Spectra) -> Array:
    """Return the smoothed power of a spectrum, shape (frequencies,), never zero."""
    return np.asarray(smooth_spectrum(np.abs(spectrum[None]) ** 2)[0] + _TINY)


def estimate_response(outputs: Spectra, cause: Spectra) -> Spectra:
    """Return the best linear approximation of the frequency response from a cause to outputs.

    `H = smoothed(Y X*) / smoothed(|X|^2)`, the H1 estimate; shape (channels, frequencies).
    """
    crossed = outputs * cause.conj()
    power = smooth_spectrum(np.abs(cause[None]) ** 2)
    return np.asarray((smooth_spectrum(crossed.real) + 1j * smooth_spectrum(crossed.imag)) / power)


def as_complex(whitened: Array) -> Spectra:
    """Return whitened numbers, shape (..., 2 frequencies), as complex ones, shape (..., frequencies)."""
    half = whitened.shape[-1] // 2
    return np.asarray(whitened[..., :half] + 1j * whitened[..., half:])


def wiener_share(power: Array) -> Array:
    """Return Wiener's filter for a whitened power spectrum; noise has the power 2, of real and imaginary part."""
    return np.maximum(0.0, 1.0 - 2.0 / power)
