"""Forces on the frame that no channel records, N, sampled at 2 kHz: coloured noise, the hum of an engine, knocks."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.random import Generator

from seatsim.blind.truth.faults.scenario import FrameForce
from seatsim.blind.truth.noise import coloured_noise
from seatsim.blind.truth.physics.rig import EXCITATION_RATE
from seatsim.schema.arrays import Array

NO_FORCE = np.zeros(1)
"""A single sample, which the rig's loop takes for none."""


def frame_force(forces: Iterable[FrameForce], run: int, seconds: float) -> Array:
    """Return the sum of forces in a run, shape (samples,); each has its own generator, so none changes another."""
    drawn = [force.rms * _draw_unit_force(np.random.default_rng([force.seed, run]), force, seconds) for force in forces]
    if not drawn:
        return NO_FORCE
    total = np.zeros(round(seconds * EXCITATION_RATE))
    for values in drawn:
        total += values
    return total


def _draw_unit_force(rng: Generator, force: FrameForce, seconds: float) -> Array:
    match force.kind:
        case "coloured":
            return draw_coloured_force(rng, seconds)
        case "hum":
            return draw_hum(rng, seconds, force.detail)
        case "knock":
            return draw_knocks(rng, seconds, force.detail)


def draw_coloured_force(rng: Generator, seconds: float) -> Array:
    """Return a random force of 1 N rms, from 1-2.5 Hz to 8-18 Hz."""
    low, high = rng.uniform(1.0, 2.5), rng.uniform(8.0, 18.0)
    return coloured_noise(rng, round(seconds * EXCITATION_RATE), low, high, rng.uniform(-0.3, 0.3), EXCITATION_RATE)


def draw_hum(rng: Generator, seconds: float, hertz: float) -> Array:
    """Return an engine tone of about 1 N rms: its frequency wanders by 2 %, its amplitude by 25 %."""
    time = np.arange(round(seconds * EXCITATION_RATE)) / EXCITATION_RATE
    wander = 0.02 * coloured_noise(rng, time.size, 0.1, 0.4, 0.0, EXCITATION_RATE)
    phase = 2.0 * np.pi * np.cumsum(hertz * (1.0 + wander)) / EXCITATION_RATE
    envelope = 1.0 + 0.25 * np.sin(2.0 * np.pi * rng.uniform(0.05, 0.2) * time + rng.uniform(0.0, 6.0))
    return np.asarray(np.sqrt(2.0) * envelope * np.sin(phase))


def draw_knocks(rng: Generator, seconds: float, interval: float) -> Array:
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
