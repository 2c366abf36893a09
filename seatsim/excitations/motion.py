"""Motions with their first two derivatives, and their Fourier coefficients: products, fades, integration without drift.

A displacement of period P is `z(t) = c_0 + 2 Re(sum over k > 0 of c_k exp(2 pi i k t / P))`, the convention
of `scipy.fft.rfft(..., norm="forward")`. Its derivatives are `(2 pi i k / P)^m c_k`, exact and free of drift.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft

from seatsim.excitations.base import Floor
from seatsim.schema.arrays import Array
from seatsim.schema.bounds import check_steps
from seatsim.schema.errors import InputError

_SOFT_START = 1.0


class Motion(NamedTuple):
    """A function of time with its first and second derivative, each of shape (N,)."""

    displacement: Array
    velocity: Array
    acceleration: Array


def product(a: Motion, b: Motion) -> Motion:
    """Return `a*b` by the product rule: `(ab)'' = a''b + 2a'b' + ab''`."""
    return Motion(
        a.displacement * b.displacement,
        a.velocity * b.displacement + a.displacement * b.velocity,
        a.acceleration * b.displacement + 2 * a.velocity * b.velocity + a.displacement * b.acceleration,
    )


def sine(phase: Motion) -> Motion:
    """Return `sin(phase)` for a phase in rad that is given with its derivatives."""
    s, c = np.sin(phase.displacement), np.cos(phase.displacement)
    return Motion(s, c * phase.velocity, c * phase.acceleration - s * phase.velocity**2)


def ease(time: Array, rise: float | Array) -> Motion:
    """Return the smooth step `w = 10u^3 - 15u^4 + 6u^5`, `u = time/rise`: 0 before 0, 1 after `rise` seconds.

    `w`, `w'` and `w''` are continuous, hence a motion times `w` starts at rest without a jump of
    acceleration.
    """
    u = np.clip(time / rise, 0.0, 1.0)
    left = 1.0 - u
    return Motion(
        u**3 * (10.0 - 15.0 * u + 6.0 * u**2),
        30.0 * (u * left) ** 2 / rise,
        60.0 * u * left * (left - u) / np.square(rise),
    )


def soft_start(step: float, motion: Motion) -> Floor:
    """Return the floor that follows `motion`, faded in by `ease` from rest over the first second.

    Runs shorter than four seconds are faded in over their first quarter.
    """
    time = clock(len(motion.displacement), step)
    return floor_of(step, product(ease(time, min(_SOFT_START, time[-1] / 4)), motion))


def floor_of(step: float, motion: Motion) -> Floor:
    """Return `motion` as a floor sampled every `step` seconds."""
    return Floor(step, motion.acceleration, motion.velocity, motion.displacement)


def clock(count: int, step: float) -> Array:
    """Return the times `0, step, ...` in s, shape (count,)."""
    return step * np.arange(count, dtype=np.float64)


def samples(duration: float, step: float) -> int:
    """Return `round(duration/step) + 1`, the number of samples of a run from 0 to `duration`, both included.

    Raises:
        InputError: the run is shorter than two steps, or does not fit into the memory.
    """
    check_steps(duration / step)
    count = round(duration / step) + 1
    if count < 3:
        raise InputError(f"duration {duration:g} s holds fewer than two steps of {step:g} s; lengthen it")
    return count


def check_step(kind: str, step: float, highest: float, per_period: int) -> None:
    """Refuse a `step` with fewer than `per_period` samples in a period of the `highest` frequency in Hz.

    The simulation interpolates the acceleration linearly, which scales a tone of `p` samples a period by
    `sinc(1/p)^2`: 0.97 at 10, required of pure tones, and 0.87 at 5, required of the upper end of a broad band,
    which carries little power.

    Raises:
        InputError: the step is too coarse.
    """
    permitted = 1.0 / (per_period * highest)
    if step > permitted * (1 + 1e-9):
        raise InputError(
            f"excitation '{kind}': a step of {step:g} s is too coarse for its {highest:.4g} Hz; "
            f"permitted: at most {permitted:.3g} s; lower solver.step"
        )


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
    return np.asarray(amplitude * np.exp(1j * phase))


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
    return np.asarray(rfft(np.concatenate([values, values[-2:0:-1]]), norm="forward"))


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
    return np.asarray(frequency**4 / (frequency**4 + low**4) * np.cos(np.pi / 2 * fall) ** 2)
