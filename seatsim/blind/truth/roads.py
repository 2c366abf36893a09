"""Floors of the true rig: coloured noise, bumps, sweeps, each at 2 kHz, and the current schedules beside them."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from seatsim.blind.truth.rig import FINE, RATE
from seatsim.blind.truth.slots import Array


def coloured(rng: Generator, samples: int, low: float, high: float, slope: float, rate: float = FINE) -> Array:
    """Return unit-variance noise whose amplitude goes as `f^slope` between two soft edges (Hz)."""
    spectrum = np.fft.rfft(rng.standard_normal(samples))
    f = np.fft.rfftfreq(samples, 1.0 / rate)
    f[0] = f[1]
    edge = (f / low) ** 3 / np.sqrt(1.0 + (f / low) ** 6) / np.sqrt(1.0 + (f / high) ** 8)
    value = np.fft.irfft(spectrum * f**slope * edge * (f < 60.0), samples)
    return np.asarray(value / np.std(value))


def road(rng: Generator, seconds: float, rms: float) -> Array:
    """Return the acceleration of a cab floor on a random road, m/s^2 (a soft vehicle mode over a flat spectrum)."""
    samples = round(seconds * FINE)
    base = coloured(rng, samples, rng.uniform(0.6, 1.1), rng.uniform(7.0, 14.0), rng.uniform(-0.6, 0.1))
    mode = coloured(rng, samples, rng.uniform(1.2, 1.6), rng.uniform(2.2, 3.5), 0.0)
    mixed = base + rng.uniform(0.3, 1.2) * mode
    return np.asarray(rms * mixed / np.std(mixed))


def bumps(rng: Generator, seconds: float, peak: float) -> Array:
    """Return a row of rounded bumps (raised-cosine heights) over a little road noise, m/s^2; `peak` is the highest."""
    time = np.arange(round(seconds * FINE)) / FINE
    total = 0.12 * coloured(rng, time.size, 1.0, 15.0, -0.3)
    at = rng.uniform(0.4, 1.2)
    while at < seconds - 1.0:
        long = rng.uniform(0.2, 0.5)
        inside = (time >= at) & (time < at + long)
        phase = 2.0 * np.pi * (time[inside] - at) / long
        window = np.sin(0.5 * phase) ** 0.5
        total[inside] += rng.choice([-1.0, 1.0]) * peak * rng.uniform(0.55, 1.0) * np.cos(phase) * window
        at += long + rng.uniform(0.6, 1.8)
    f = np.fft.rfftfreq(time.size, 1.0 / FINE)
    soft = np.fft.rfft(total) * (f / 0.5) ** 2 / (1.0 + (f / 0.5) ** 2) / np.sqrt(1.0 + (f / 35.0) ** 8)
    return np.asarray(np.fft.irfft(soft, time.size))


def sweep(rng: Generator, seconds: float, rms: float) -> Array:
    """Return a sine sweep from 0.7 to 12 Hz, once up, over coloured noise, m/s^2."""
    time = np.arange(round(seconds * FINE)) / FINE
    low, high = rng.uniform(0.6, 1.0), rng.uniform(9.0, 14.0)
    rate = np.log(high / low) / seconds
    phase = 2.0 * np.pi * low * (np.exp(rate * time) - 1.0) / rate
    size = 1.1 * rms * np.minimum(1.0, 0.4 + time / seconds)
    return np.asarray(size * np.sin(phase) + 0.6 * rms * coloured(rng, time.size, 0.8, 10.0, -0.3))


def steps(rng: Generator, rows: int, top: float) -> Array:
    """Return a schedule of current steps, A: random levels, zero now and then, held 0.3-2.5 s."""
    out = np.zeros(rows)
    at = 0
    while at < rows:
        hold = round(rng.uniform(0.3, 2.5) * RATE)
        level = 0.0 if rng.random() < 0.3 else float(round(rng.uniform(0.05, top), 3))
        out[at : at + hold] = level
        at += hold
    return out


def coloured_push(rng: Generator, seconds: float) -> Array:
    """Return a random force of 1 N rms on the frame, 1.5-15 Hz."""
    return coloured(rng, round(seconds * FINE), rng.uniform(1.0, 2.5), rng.uniform(8.0, 18.0), rng.uniform(-0.3, 0.3))


def hum_push(rng: Generator, seconds: float, hertz: float) -> Array:
    """Return an engine tone of about 1 N rms: frequency wanders by 2 %, amplitude breathes."""
    time = np.arange(round(seconds * FINE)) / FINE
    wander = 0.02 * coloured(rng, time.size, 0.1, 0.4, 0.0)
    phase = 2.0 * np.pi * np.cumsum(hertz * (1.0 + wander)) / FINE
    breath = 1.0 + 0.25 * np.sin(2.0 * np.pi * rng.uniform(0.05, 0.2) * time + rng.uniform(0.0, 6.0))
    return np.asarray(np.sqrt(2.0) * breath * np.sin(phase))


def knock_push(rng: Generator, seconds: float, every: float) -> Array:
    """Return half-sine pushes of 60-200 ms at random moments, about 1 N rms overall."""
    time = np.arange(round(seconds * FINE)) / FINE
    total = np.zeros(time.size)
    at = rng.exponential(every)
    while at < seconds:
        long = rng.uniform(0.06, 0.2)
        inside = (time >= at) & (time < at + long)
        total[inside] += rng.choice([-1.0, 1.0]) * rng.uniform(0.6, 1.4) * np.sin(np.pi * (time[inside] - at) / long)
        at += long + rng.exponential(every)
    return np.asarray(total / max(float(np.std(total)), 1e-3))
