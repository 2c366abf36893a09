"""Floors of the true rig, sampled at 2 kHz: road, bumps, sweep; and the current schedules beside them."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from seatsim.blind.truth.noise import coloured_noise
from seatsim.blind.truth.physics.rig import EXCITATION_RATE, SAMPLE_RATE
from seatsim.schema.arrays import Array

OFF_SHARE = 0.3
"""Share of the steps of a schedule that are without current, so that the damper's fall is seen as often as its rise."""


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
        level = 0.0 if rng.random() < OFF_SHARE else float(round(rng.uniform(0.05, top), 3))
        out[at : at + hold] = level
        at += hold
    return out
