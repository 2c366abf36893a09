"""Fourier coefficients to motion and back: synthesis, differentiation and integration without drift.

A displacement of period P is `z(t) = c_0 + 2 Re(sum over k > 0 of c_k exp(2 pi i k t / P))`, the convention
of `scipy.fft.rfft(..., norm="forward")`. Its derivatives are `(2 pi i k / P)^m c_k`, exact and free of drift.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft

from seatsim.excitations.motion import Motion
from seatsim.schema.arrays import Array

Spectrum = NDArray[np.complex128]


def lines(spectrum: Spectrum, period: float) -> Array:
    """Return the frequency of every coefficient, `k/period`: Hz for a period in s, cycles/m for m."""
    return np.arange(len(spectrum)) / period


def random_phase(density: Callable[[Array], Array], low: float, high: float, period: float, seed: int) -> Spectrum:
    """Draw coefficients of a random signal whose one-sided spectral density is `density` in `low..high`.

    `c_k = sqrt(G(k/P) / (2P)) exp(i phi_k)`, with `phi_k` uniform and independent: the variance of every line
    is its share `G/P` of the spectrum in each realisation, and the sum of many lines is close to Gaussian.

    Args:
        density: one-sided density G, unit^2/Hz over Hz, or unit^2 m over cycles/m.
        low: lower end of the band.
        high: upper end of the band.
        period: length P after which the signal repeats, in s or m.
        seed: of the phases; the same seed draws the same phases whatever the density.
    """
    frequency = np.arange(int(high * period) + 1) / period
    inside = frequency >= low
    phase = np.random.default_rng(seed).uniform(0.0, 2 * np.pi, len(frequency))
    amplitude = np.zeros(len(frequency))
    amplitude[inside] = np.sqrt(density(frequency[inside]) / (2 * period))
    spectrum: Spectrum = amplitude * np.exp(1j * phase)
    return spectrum


def motion_of(displacement: Spectrum, step: float, size: int, count: int) -> Motion:
    """Return `count` samples of the motion with these coefficients and a period of `size` steps.

    Args:
        displacement: coefficients in m, at most `size//2 + 1`.
        step: sample time in s.
        size: samples in one period.
        count: samples wanted; beyond one period the motion repeats.
    """
    s = 2j * np.pi * lines(displacement, size * step)
    orders = (displacement, s * displacement, s**2 * displacement)
    return Motion(*(np.resize(irfft(c, n=size, norm="forward"), count) for c in orders))


def integrated_twice(acceleration: Spectrum, period: float) -> Spectrum:
    """Return the coefficients of displacement from those of an `acceleration` without a mean."""
    omega = 2 * np.pi * lines(acceleration, period)
    omega[0] = np.inf
    return -acceleration / omega**2


def mirrored(values: Array) -> Spectrum:
    """Return the coefficients of a record continued by its mirror image, so without a jump at its end.

    A record of N values has a period of `2*(N - 1)` intervals.
    """
    spectrum: Spectrum = rfft(np.concatenate([values, values[-2:0:-1]]), norm="forward")
    return spectrum


def limited(values: Array, interval: float, low: float, high: float) -> Array:
    """Return a record passed through `band`, shape of `values`, without mean and steady slope.

    Beyond both ends the record is continued by its point mirror image: the line through first and last value is
    removed and the remainder repeated backwards with the opposite sign, so value and slope are continuous.
    """
    rest = values - np.linspace(values[0], values[-1], len(values))
    spectrum = rfft(np.concatenate([rest, -rest[-2:0:-1]]), norm="forward")
    size = 2 * (len(values) - 1)
    spectrum *= band(lines(spectrum, size * interval), low, high)
    passed: Array = irfft(spectrum, n=size, norm="forward")[: len(values)]
    passed -= passed.mean()
    return passed


def band(frequency: Array, low: float, high: float) -> Array:
    """Return the gain of a band-pass without phase shift, shape of `frequency`.

    `f^4/(f^4 + low^4)` (a half at `low`, so steep that an integrated displacement stays bounded), times a
    raised cosine from 1 at `0.8*high` to 0 at `high`.
    """
    fall = np.clip((frequency / high - 0.8) / 0.2, 0.0, 1.0)
    gain: Array = frequency**4 / (frequency**4 + low**4) * np.cos(np.pi / 2 * fall) ** 2
    return gain
