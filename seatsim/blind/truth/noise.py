"""Coloured noise, from which roads, forces on the frame and the noise and bias drift of sensors are made."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.schema.arrays import Array

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


class NoiseColour(NamedTuple):
    """Spectrum of a sensor's noise: shares of its variance in two parts, and their frequencies; the rest is white."""

    flicker: float  # share that goes as 1/f below its corner
    corner: float  # Hz
    slow: float  # share that passed a first-order low-pass
    bandwidth: float  # Hz, of that low-pass


def colour_noise(white: Array, colour: NoiseColour, rate: float) -> Array:
    """Return white noise of unit variance, shape (samples,), with a coloured spectrum and the same expected variance.

    The power is `1 - flicker - slow + flicker a / (f (1 + (f / corner)^2)) + slow b / (1 + (f / bandwidth)^2)`, with a
    and b such that each part has its share of the variance.
    """
    f = np.fft.rfftfreq(white.size, 1.0 / rate)
    f[0] = f[1]  # 1/f has no value at 0 Hz
    flicker = 1.0 / (f * (1.0 + (f / colour.corner) ** 2))
    slow = 1.0 / (1.0 + (f / colour.bandwidth) ** 2)
    power = 1.0 - colour.flicker - colour.slow
    power = power + colour.flicker * flicker / np.mean(flicker) + colour.slow * slow / np.mean(slow)
    return np.fft.irfft(np.fft.rfft(white) * np.sqrt(power), white.size)
