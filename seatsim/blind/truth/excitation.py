"""What moves the true rig, sampled at 2 kHz: floors, forces on the frame that no channel records, current schedules.

All of it is made of coloured noise, as the noise and the bias drift of sensors are.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.truth.faults import FrameForce
from seatsim.blind.truth.rig import EXCITATION_RATE, SAMPLE_RATE
from seatsim.schema.arrays import Array

_HIGHEST = 60.0
"""Hz, above which there is nothing, so that linear interpolation at 2 kHz and rows at 500 Hz lose nothing."""
_OFF_SHARE = 0.3
"""Share of the steps of a schedule that are without current, so that the damper's fall is seen as often as its rise."""
_NO_FORCE = np.zeros(1)
"""A single sample, which the rig's loop takes for none."""


def coloured_noise(rng: Generator, samples: int, low: float, high: float, slope: float, rate: float) -> Array:
    """Return noise of unit variance, shape (samples,), whose amplitude goes as `f^slope` between two soft edges (Hz).

    The edges are those of third-order high-pass and fourth-order low-pass Butterworth filters, without their phase:
    `(f / low)^3 / sqrt(1 + (f / low)^6) / sqrt(1 + (f / high)^8)`.
    """
    spectrum = np.fft.rfft(rng.standard_normal(samples))
    f = np.fft.rfftfreq(samples, 1.0 / rate)
    f[0] = f[1]  # a falling slope has no value at 0 Hz
    edge = (f / low) ** 3 / np.sqrt(1.0 + (f / low) ** 6) / np.sqrt(1.0 + (f / high) ** 8)
    value = np.fft.irfft(spectrum * f**slope * edge * (f < _HIGHEST), samples)
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


def _noise(rng: Generator, samples: int, low: float, high: float, slope: float) -> Array:
    return coloured_noise(rng, samples, low, high, slope, EXCITATION_RATE)


def draw_road(rng: Generator, seconds: float, rms: float) -> Array:
    """Return the acceleration of a cab floor on a random road, m/s^2 (a soft vehicle mode over a flat spectrum)."""
    samples = round(seconds * EXCITATION_RATE)
    base = _noise(rng, samples, rng.uniform(0.6, 1.1), rng.uniform(7.0, 14.0), rng.uniform(-0.6, 0.1))
    mode = _noise(rng, samples, rng.uniform(1.2, 1.6), rng.uniform(2.2, 3.5), 0.0)
    mixed = base + rng.uniform(0.3, 1.2) * mode
    return np.asarray(rms * mixed / np.std(mixed))


def draw_bumps(rng: Generator, seconds: float, peak: float) -> Array:
    """Return a row of rounded bumps over a little road noise, m/s^2; `peak` is the largest acceleration of a bump.

    A bump is a raised cosine in height, so a cosine in acceleration, softened where it begins and ends.
    """
    time = np.arange(round(seconds * EXCITATION_RATE)) / EXCITATION_RATE
    total = 0.12 * _noise(rng, time.size, 1.0, 15.0, -0.3)
    at = rng.uniform(0.4, 1.2)
    while at < seconds - 1.0:
        long = rng.uniform(0.2, 0.5)
        inside = (time >= at) & (time < at + long)
        phase = 2.0 * np.pi * (time[inside] - at) / long
        window = np.sin(0.5 * phase) ** 0.5
        total[inside] += rng.choice([-1.0, 1.0]) * peak * rng.uniform(0.55, 1.0) * np.cos(phase) * window
        at += long + rng.uniform(0.6, 1.8)
    # high-pass at 0.5 Hz, as a cab on springs moves, and low-pass at 35 Hz; the integral of the floor stays bounded
    f = np.fft.rfftfreq(time.size, 1.0 / EXCITATION_RATE)
    soft = np.fft.rfft(total) * (f / 0.5) ** 2 / (1.0 + (f / 0.5) ** 2) / np.sqrt(1.0 + (f / 35.0) ** 8)
    return np.asarray(np.fft.irfft(soft, time.size))


def draw_sweep(rng: Generator, seconds: float, rms: float) -> Array:
    """Return a logarithmic sine sweep over the seat's band, once up, over coloured noise, m/s^2.

    It starts at 0.6-1 Hz and ends at 9-14 Hz. Its amplitude grows over the first 60 % of the time, as the travel is
    longest at the lowest frequencies.
    """
    time = np.arange(round(seconds * EXCITATION_RATE)) / EXCITATION_RATE
    low, high = rng.uniform(0.6, 1.0), rng.uniform(9.0, 14.0)
    rate = np.log(high / low) / seconds
    phase = 2.0 * np.pi * low * (np.exp(rate * time) - 1.0) / rate
    size = 1.1 * rms * np.minimum(1.0, 0.4 + time / seconds)
    return np.asarray(size * np.sin(phase) + 0.6 * rms * _noise(rng, time.size, 0.8, 10.0, -0.3))


def draw_current_steps(rng: Generator, rows: int, top: float, rate: float = SAMPLE_RATE) -> Array:
    """Return a schedule of current steps, A, shape (rows,): random levels, zero now and then, held 0.3-2.5 s."""
    out = np.zeros(rows)
    at = 0
    while at < rows:
        hold = round(rng.uniform(0.3, 2.5) * rate)
        level = 0.0 if rng.random() < _OFF_SHARE else float(round(rng.uniform(0.05, top), 3))
        out[at : at + hold] = level
        at += hold
    return out


def frame_force(forces: Iterable[FrameForce], run: int, seconds: float) -> Array:
    """Return the sum of forces in a run, shape (samples,); each has its own generator, so none changes another."""
    drawn = [force.rms * _draw_unit_force(np.random.default_rng([force.seed, run]), force, seconds) for force in forces]
    if not drawn:
        return _NO_FORCE
    total = np.zeros(round(seconds * EXCITATION_RATE))
    for values in drawn:
        total += values
    return total


def _draw_unit_force(rng: Generator, force: FrameForce, seconds: float) -> Array:
    match force.kind:
        case "coloured":
            return _draw_coloured_force(rng, seconds)
        case "hum":
            return _draw_hum(rng, seconds, force.detail)
        case "knock":
            return _draw_knocks(rng, seconds, force.detail)


def _draw_coloured_force(rng: Generator, seconds: float) -> Array:
    """Return a random force of 1 N rms, from 1-2.5 Hz to 8-18 Hz."""
    low, high = rng.uniform(1.0, 2.5), rng.uniform(8.0, 18.0)
    return coloured_noise(rng, round(seconds * EXCITATION_RATE), low, high, rng.uniform(-0.3, 0.3), EXCITATION_RATE)


def _draw_hum(rng: Generator, seconds: float, hertz: float) -> Array:
    """Return an engine tone of about 1 N rms: its frequency wanders by 2 %, its amplitude by 25 %."""
    time = np.arange(round(seconds * EXCITATION_RATE)) / EXCITATION_RATE
    wander = 0.02 * coloured_noise(rng, time.size, 0.1, 0.4, 0.0, EXCITATION_RATE)
    phase = 2.0 * np.pi * np.cumsum(hertz * (1.0 + wander)) / EXCITATION_RATE
    envelope = 1.0 + 0.25 * np.sin(2.0 * np.pi * rng.uniform(0.05, 0.2) * time + rng.uniform(0.0, 6.0))
    return np.asarray(np.sqrt(2.0) * envelope * np.sin(phase))


def _draw_knocks(rng: Generator, seconds: float, interval: float) -> Array:
    """Return half-sine pulses of 60-200 ms, `interval` s apart on average (Poisson), about 1 N rms overall."""
    time = np.arange(round(seconds * EXCITATION_RATE)) / EXCITATION_RATE
    total = np.zeros(time.size)
    at = rng.exponential(interval)
    while at < seconds:
        long = rng.uniform(0.06, 0.2)
        inside = (time >= at) & (time < at + long)
        total[inside] += rng.choice([-1.0, 1.0]) * rng.uniform(0.6, 1.4) * np.sin(np.pi * (time[inside] - at) / long)
        at += long + rng.exponential(interval)
    # a short run may hold no knock at all
    return np.asarray(total / max(float(np.std(total)), 1e-3))
