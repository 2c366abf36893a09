"""Power spectral densities by Welch's method."""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy import fft

from seatsim.metrics.weighting import ComplexArray
from seatsim.schema.arrays import Array


def cross_spectral_density(x: Array, y: Array, sample_rate: float, length: int) -> tuple[Array, ComplexArray]:
    """Return frequencies in Hz and the one-sided cross spectral density `S_xy(f)`, shape (F,), in units of x y per Hz.

    `S_xy = 2 mean(conj(X) Y) / (sample_rate sum(w^2))` over half-overlapping segments of `length` samples, each with
    its mean removed and under a periodic Hann window w: what `scipy.signal.csd(x, y, sample_rate, nperseg=length)`
    returns, without that module's half second of import at the start of every command. Source: P. D. Welch 1967, IEEE
    Trans. Audio Electroacoust. 15:70.
    """
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length) if length > 1 else np.ones(1)
    first, second = (_segments(values, length) * window for values in (x, y))
    products = np.conj(fft.rfft(first, axis=-1)) * fft.rfft(second, axis=-1)
    density = products.mean(axis=0) / (sample_rate * np.sum(window**2))
    # One-sided: every line stands for its negative frequency too, except zero and, for even lengths, Nyquist's.
    density[1 : (length + 1) // 2] *= 2.0
    return fft.rfftfreq(length, 1.0 / sample_rate), density


def power_spectral_density(x: Array, sample_rate: float, length: int) -> tuple[Array, Array]:
    """Return frequencies in Hz and the one-sided power spectral density `S_xx(f)`, shape (F,), in units of x^2 per Hz.

    Estimated as in `cross_spectral_density`, over segments of `length` samples.
    """
    frequency, power = cross_spectral_density(x, x, sample_rate, length)
    return frequency, power.real


def _segments(values: Array, length: int) -> Array:
    """Return half-overlapping segments with their means removed, shape (S, length)."""
    parts: Array = sliding_window_view(values, length)[:: max(1, length - length // 2)]
    centred: Array = parts - parts.mean(axis=-1, keepdims=True)
    return centred
