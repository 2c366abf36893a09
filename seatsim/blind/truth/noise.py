"""Coloured noise, from which roads, forces on the frame and the bias drift of sensors are made."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from seatsim.blind.truth.physics.compiled import Array

HIGHEST = 60.0
"""Hz, above which there is nothing, so that linear interpolation at 2 kHz and rows at 500 Hz lose nothing."""


def coloured_noise(rng: Generator, samples: int, low: float, high: float, slope: float, rate: float) -> Array:
    """Return noise of unit variance, shape (samples,), whose amplitude goes as `f^slope` between two soft edges (Hz).

    The edges are those of third-order high-pass and fourth-order low-pass Butterworth filters, without their phase:
    `(f / low)^3 / sqrt(1 + (f / low)^6) / sqrt(1 + (f / high)^8)`.
    """
    spectrum = np.fft.rfft(rng.standard_normal(samples))
    f = np.fft.rfftfreq(samples, 1.0 / rate)
    f[0] = f[1]  # a falling slope has no value at 0 Hz
    edge = (f / low) ** 3 / np.sqrt(1.0 + (f / low) ** 6) / np.sqrt(1.0 + (f / high) ** 8)
    value = np.fft.irfft(spectrum * f**slope * edge * (f < HIGHEST), samples)
    return np.asarray(value / np.std(value))
