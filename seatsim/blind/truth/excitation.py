"""What moves the true rig, sampled at 2 kHz: floors, drawn plainly or through a vehicle, forces, current schedules.

All of it is made of coloured noise, as the noise and the bias drift of sensors are.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from seatsim.blind.truth.faults import FrameForce
from seatsim.blind.truth.rig import EXCITATION_RATE, SAMPLE_RATE
from seatsim.schema.arrays import Array

_HIGHEST = 60.0
"""Hz, above which there is nothing, so that linear interpolation at 2 kHz and rows at 500 Hz lose nothing."""
_Spectrum = NDArray[np.complex128]
_ROUGHNESS = {"A": 16e-6, "B": 64e-6, "C": 256e-6, "D": 1024e-6}
"""Displacement power `Gd(n0)` of ISO 8608:2016 at the middle of each class, m^3."""
_REFERENCE = 0.1
"""n0 of ISO 8608, cycles per metre."""
_FLOOR_LOW, _FLOOR_HIGH = 0.4, 90.0
"""Hz, the soft edges of what a floor does: no drift, and nothing that rows at 256 Hz would alias."""
_QUIETEST, _LOUDEST = 0.4, 2.2
"""Rms that a floor is brought within, m/s^2: a smooth road still moves the seat, a rough one keeps it off its stops."""
_OFF_SHARE = 0.3
"""Share of the steps of a schedule that are without current, so that the damper's fall is seen as often as its rise."""
_NO_FORCE = np.zeros(1)
"""A single sample, which the rig's loop takes for none."""


def coloured_noise(
    rng: Generator, samples: int, low: float, high: float, slope: float, rate: float = EXCITATION_RATE
) -> Array:
    """Return noise of unit variance, shape (samples,), whose amplitude goes as `f^slope` between two soft edges, Hz."""
    spectrum = np.fft.rfft(rng.standard_normal(samples))
    f = np.fft.rfftfreq(samples, 1.0 / rate)
    f[0] = f[1]  # a falling slope has no value at 0 Hz
    value = np.fft.irfft(spectrum * f**slope * _soft_edges(f, low, high) * (f < _HIGHEST), samples)
    return np.asarray(value / np.std(value))


def _soft_edges(frequencies: ArrayLike, low: float, high: float) -> Array:
    """Return the gains of third-order high-pass and fourth-order low-pass Butterworth filters, without their phase.

    `(f / low)^3 / sqrt(1 + (f / low)^6) / sqrt(1 + (f / high)^8)`
    """
    f = np.asarray(frequencies, dtype=np.float64)
    return np.asarray((f / low) ** 3 / np.sqrt(1.0 + (f / low) ** 6) / np.sqrt(1.0 + (f / high) ** 8))


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


def draw_road(rng: Generator, seconds: float, rms: float) -> Array:
    """Return the acceleration of a cab floor on a random road, m/s^2 (a soft vehicle mode over a flat spectrum)."""
    samples = round(seconds * EXCITATION_RATE)
    base = coloured_noise(rng, samples, rng.uniform(0.6, 1.1), rng.uniform(7.0, 14.0), rng.uniform(-0.6, 0.1))
    mode = coloured_noise(rng, samples, rng.uniform(1.2, 1.6), rng.uniform(2.2, 3.5), 0.0)
    mixed = base + rng.uniform(0.3, 1.2) * mode
    return np.asarray(rms * mixed / np.std(mixed))


def draw_bumps(rng: Generator, seconds: float, peak: float) -> Array:
    """Return a row of rounded bumps over a little road noise, m/s^2; `peak` is the largest acceleration of a bump.

    A bump is a raised cosine in height, so a cosine in acceleration, softened where it begins and ends.
    """
    time = np.arange(round(seconds * EXCITATION_RATE)) / EXCITATION_RATE
    total = 0.12 * coloured_noise(rng, time.size, 1.0, 15.0, -0.3)
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
    return np.asarray(size * np.sin(phase) + 0.6 * rms * coloured_noise(rng, time.size, 0.8, 10.0, -0.3))


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
    # levels of 15-100 % of the fastest speed, m/s; the roughness of a class, m^3, patched by factors of 1/2 to 2
    speed = rng.uniform(8.0, 25.0) * _levels(rng, samples, 0.15, 1.0)
    middle = _ROUGHNESS[str(rng.choice(list(_ROUGHNESS), p=[0.1, 0.35, 0.4, 0.15]))]
    power = (2.0 * np.pi * _REFERENCE) ** 2 * (middle * 2.0 ** _levels(rng, samples, -1.0, 1.0)) * speed
    road = np.sqrt(0.5 * EXCITATION_RATE * power) * rng.standard_normal(samples)
    floor = _through_vehicle(road + _draw_bump_velocity(rng, speed, bumps), vehicle)
    level = float(np.std(floor))
    # the engine is a narrow band about its frequency
    engine = coloured_noise(rng, samples, 0.97 * vehicle.engine, vehicle.engine, 0.0)
    return floor * min(max(level, _QUIETEST), _LOUDEST) / level + vehicle.hum * engine


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
    edge = _soft_edges(f, _FLOOR_LOW, _FLOOR_HIGH)
    return np.fft.irfft(np.fft.rfft(velocity) * wheel * body * panel * edge, velocity.size)


def _mode(s: _Spectrum, w: float, damping: float) -> _Spectrum:
    """Return the transmissibility `(2 z w s + w^2) / (s^2 + 2 z w s + w^2)` of a sprung mass."""
    carried = 2.0 * damping * w * s + w * w
    return carried / (s * s + carried)


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
    return sum(drawn, np.zeros(round(seconds * EXCITATION_RATE))) if drawn else _NO_FORCE


def _draw_unit_force(rng: Generator, force: FrameForce, seconds: float) -> Array:
    """Return a force of 1 N rms: random from 1-2.5 Hz to 8-18 Hz, the tone of an engine, or knocks."""
    match force.kind:
        case "coloured":
            low, high, samples = rng.uniform(1.0, 2.5), rng.uniform(8.0, 18.0), round(seconds * EXCITATION_RATE)
            return coloured_noise(rng, samples, low, high, rng.uniform(-0.3, 0.3))
        case "hum":
            return _draw_hum(rng, seconds, force.detail)
        case "knock":
            return _draw_knocks(rng, seconds, force.detail)


def _draw_hum(rng: Generator, seconds: float, hertz: float) -> Array:
    """Return an engine tone of about 1 N rms: its frequency wanders by 2 %, its amplitude by 25 %."""
    time = np.arange(round(seconds * EXCITATION_RATE)) / EXCITATION_RATE
    wander = 0.02 * coloured_noise(rng, time.size, 0.1, 0.4, 0.0)
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
