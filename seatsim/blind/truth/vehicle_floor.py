"""Floors as they are measured in vehicles: a rough road at a changing speed, seen through the vehicle, at 2 kHz."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from seatsim.blind.truth.excitation import coloured_noise
from seatsim.blind.truth.rig import EXCITATION_RATE
from seatsim.schema.arrays import Array

_Spectrum = NDArray[np.complex128]
_ROUGHNESS = {"A": 16e-6, "B": 64e-6, "C": 256e-6, "D": 1024e-6}
"""Displacement power `Gd(n0)` of ISO 8608:2016 at the middle of each class, m^3."""
_REFERENCE = 0.1
"""n0 of ISO 8608, cycles per metre."""
_LOWEST, _HIGHEST = 0.4, 90.0
"""Hz, the soft edges of what a floor does: no drift, and nothing that rows at 256 Hz would alias."""
_QUIETEST, _LOUDEST = 0.4, 2.2
"""Rms that a floor is brought within, m/s^2: a smooth road still moves the seat, a rough one keeps it off its stops."""


class _Vehicle(NamedTuple):
    """A vehicle between road and floor: natural frequencies (rad/s) and damping ratios of three modes; its engine."""

    body: float
    body_damping: float
    wheel: float
    wheel_damping: float
    panel: float
    panel_damping: float
    panel_gain: float  # -, by how much the floor's panel amplifies above its resonance
    engine: float  # Hz
    hum: float  # m/s^2, rms of the engine


def draw_vehicle(rng: Generator) -> _Vehicle:
    """Draw a bus, truck cab or tractor: body at 1-2.2 Hz, wheels at 8-14 Hz, a panel at 18-45 Hz, an engine."""
    radians = 2.0 * np.pi
    body = radians * rng.uniform(1.0, 2.2), rng.uniform(0.15, 0.35)
    wheel = radians * rng.uniform(8.0, 14.0), rng.uniform(0.08, 0.25)
    panel = radians * rng.uniform(18.0, 45.0), rng.uniform(0.03, 0.15), rng.uniform(0.1, 1.0)
    return _Vehicle(*body, *wheel, *panel, rng.uniform(22.0, 55.0), rng.uniform(0.02, 0.12))


def draw_vehicle_floor(rng: Generator, vehicle: _Vehicle, seconds: float, bumps: float) -> Array:
    """Return the acceleration of the floor on a drive, m/s^2, at 2 kHz; `bumps` is their mean number per second.

    The vertical velocity of a road whose displacement power falls as `n^-2` (ISO 8608) is white, of one-sided power
    `(2 pi n0)^2 Gd(n0) v`; so it is drawn white and scaled by the speed and the roughness of the moment.
    """
    samples = round(seconds * EXCITATION_RATE)
    speed = _draw_speed(rng, samples)
    power = (2.0 * np.pi * _REFERENCE) ** 2 * _draw_roughness(rng, samples) * speed
    road = np.sqrt(0.5 * EXCITATION_RATE * power) * rng.standard_normal(samples)
    floor = _through_vehicle(road + _draw_bump_velocity(rng, speed, bumps), vehicle)
    level = float(np.std(floor))
    return floor * min(max(level, _QUIETEST), _LOUDEST) / level + _draw_engine(rng, vehicle, samples)


def _draw_speed(rng: Generator, samples: int) -> Array:
    """Return the speed of a drive, m/s, shape (samples,): linear between levels of 15-100 % of its fastest."""
    return rng.uniform(8.0, 25.0) * _levels(rng, samples, 0.15, 1.0)


def _draw_roughness(rng: Generator, samples: int) -> Array:
    """Return `Gd(n0)`, m^3, shape (samples,): that of a class, patched by factors of 1/2 to 2."""
    middle = _ROUGHNESS[str(rng.choice(list(_ROUGHNESS), p=[0.1, 0.35, 0.4, 0.15]))]
    return np.asarray(middle * 2.0 ** _levels(rng, samples, -1.0, 1.0))


def _levels(rng: Generator, samples: int, low: float, high: float) -> Array:
    """Return random levels 2-8 s apart, linear between them, shape (samples,)."""
    time = np.arange(samples) / EXCITATION_RATE
    knots = np.cumsum(rng.uniform(2.0, 8.0, 2 + int(time[-1] / 2.0)))
    return np.interp(time, knots - knots[0], rng.uniform(low, high, knots.size))


def _draw_bump_velocity(rng: Generator, speed: Array, rate: float) -> Array:
    """Return the vertical velocity of the wheel over bumps and holes, m/s, shape (samples,).

    They are raised cosines of 8-40 mm over 0.4-2 m, `rate` per second on average (Poisson), at the speed of the moment.
    """
    velocity = np.zeros(speed.size)
    place = np.cumsum(speed) / EXCITATION_RATE
    at = rng.exponential(1.0 / rate)
    while at * EXCITATION_RATE < speed.size:
        height, length = rng.choice([-1.0, 1.0]) * rng.uniform(0.008, 0.04), rng.uniform(0.4, 2.0)
        along = (place - place[int(at * EXCITATION_RATE)]) / length
        inside = (along >= 0.0) & (along < 1.0)
        slope = np.pi * height / length * np.sin(2.0 * np.pi * along[inside])
        velocity[inside] += slope * speed[inside]
        at += rng.exponential(1.0 / rate)
    return velocity


def _through_vehicle(velocity: Array, vehicle: _Vehicle) -> Array:
    """Return the floor's acceleration for the road's vertical velocity: wheel, body and panel in series."""
    f = np.fft.rfftfreq(velocity.size, 1.0 / EXCITATION_RATE)
    s: _Spectrum = np.asarray(2j * np.pi * f, dtype=np.complex128)
    wheel = _mode(s, vehicle.wheel, vehicle.wheel_damping)
    body = s * _mode(s, vehicle.body, vehicle.body_damping)
    panel = 1.0 + vehicle.panel_gain * (1.0 - _mode(s, vehicle.panel, vehicle.panel_damping))
    edge = (f / _LOWEST) ** 3 / np.sqrt(1.0 + (f / _LOWEST) ** 6) / np.sqrt(1.0 + (f / _HIGHEST) ** 8)
    return np.fft.irfft(np.fft.rfft(velocity) * wheel * body * panel * edge, velocity.size)


def _mode(s: _Spectrum, w: float, damping: float) -> _Spectrum:
    """Return the transmissibility `(2 z w s + w^2) / (s^2 + 2 z w s + w^2)` of a sprung mass."""
    carried = 2.0 * damping * w * s + w * w
    return carried / (s * s + carried)


def _draw_engine(rng: Generator, vehicle: _Vehicle, samples: int) -> Array:
    """Return the engine's part of the floor, m/s^2, shape (samples,): a narrow band about its frequency."""
    return vehicle.hum * coloured_noise(rng, samples, 0.97 * vehicle.engine, vehicle.engine, 0.0, EXCITATION_RATE)
