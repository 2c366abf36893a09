"""Instruments of a law: readings through anti-alias filters with noise, and velocities derived from them.

Every filter is a first-order lag `y' = rate (u - y)`, solved exactly for an input u that is linear between samples.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.compilation.jit import jit
from seatsim.rig.control import Measurement
from seatsim.rig.state import CUSHION_VELOCITY, VELOCITY, State
from seatsim.schema.arrays import Array
from seatsim.schema.fields import param

READINGS = 4
"""Suspension displacement, then the accelerations of frame, driver and floor."""
_STREAM = 1
"""Key of the noise's random stream beside the seed, so that the noise is independent of the floor's random draw."""

# Order of the instruments' state: input and output of each anti-alias filter, then values at the law's last sample.
_X_TRUE, _X_FILTERED, _FRAME_TRUE, _FRAME_FILTERED = range(4)
_DRIVER_TRUE, _DRIVER_FILTERED, _FLOOR_TRUE, _FLOOR_FILTERED = range(4, 8)
_X_READ, _X_VELOCITY, _FRAME_READ, _FRAME_VELOCITY, _DRIVER_READ, _DRIVER_VELOCITY = range(8, 14)
_FILTERS, INSTRUMENTS = 8, 14
"""Length of the anti-alias filters' part of the state, and of all of it."""


class LagStep(NamedTuple):
    """A step of `y' = rate (u - y)`: `y <- keep y + old u0 + new u1`, exact for u linear from u0 to u1; rate in 1/s."""

    rate: float
    keep: float
    old: float
    new: float


def discretise_lag(rate: float, time: float) -> LagStep:
    """Return the step over `time` seconds of a lag with a `rate` in 1/s, both above zero."""
    mean = -math.expm1(-rate * time) / (rate * time)
    return LagStep(rate, math.exp(-rate * time), mean - math.exp(-rate * time), 1.0 - mean)


@jit
def advance_lag(step: LagStep, y: float, u0: float, u1: float) -> float:
    """Return the output of a lag one step after `y`, where its input went linearly from `u0` to `u1`."""
    return step.keep * y + step.old * u0 + step.new * u1


class Direct(NamedTuple):
    """No instruments: the law sees the true states."""


class Instruments(NamedTuple):
    """Compiled form of `Sensors`: the steps of its filters, and an offset of the floor's reading (0, or NaN: absent).

    The state holds last input and output of the four anti-alias filters, then last reading and velocity of suspension,
    frame and driver.
    """

    alias: LagStep
    derivative: LagStep
    leak: LagStep
    floor: float

    def advance_filters(self, floor: float, x: float, rates: State, s: State) -> State:
        """Return the state after one step of the loop, in which the anti-alias filters move on.

        `floor` is the floor's acceleration in m/s^2, x the suspension displacement in m, `rates` the derivative of the
        rig's state, whose velocities' entries are the accelerations of x and cushion.
        """
        a, frame = self.alias, floor + rates[VELOCITY]
        driver = frame + rates[CUSHION_VELOCITY]
        filtered = (
            x, advance_lag(a, s[_X_FILTERED], s[_X_TRUE], x),
            frame, advance_lag(a, s[_FRAME_FILTERED], s[_FRAME_TRUE], frame),
            driver, advance_lag(a, s[_DRIVER_FILTERED], s[_DRIVER_TRUE], driver),
            floor, advance_lag(a, s[_FLOOR_FILTERED], s[_FLOOR_TRUE], floor),
        )  # fmt: skip
        return filtered + s[_FILTERS:]

    def read(self, true: Measurement, noise: Array, sample: int, s: State) -> tuple[Measurement, State]:
        """Return what the law sees at one of its samples, with that row of the `noise`, and the state after it."""
        x, f = s[_X_FILTERED] + noise[sample, 0], s[_FRAME_FILTERED] + noise[sample, 1]
        d, z = s[_DRIVER_FILTERED] + noise[sample, 2], s[_FLOOR_FILTERED] + noise[sample, 3] + self.floor
        return derive_velocities(self.derivative, self.leak, (x, f, d, z), true, s)

    def take(self, read: Measurement, s: State) -> tuple[Measurement, State]:
        """Return what the law sees of readings that were filtered and sampled elsewhere, and the state after it."""
        floor = read.floor_acceleration + self.floor
        readings = (read.displacement, read.frame_acceleration, read.driver_acceleration, floor)
        return derive_velocities(self.derivative, self.leak, readings, read, s)


@jit
def derive_velocities(
    derivative: LagStep, leak: LagStep, readings: State, true: Measurement, s: State
) -> tuple[Measurement, State]:
    """Return a measurement of the `readings`, in the order of `READINGS`, with velocities derived from them.

    With it comes the state of the instruments after it.
    """
    x, f, d, z = readings
    # The difference of a reading and its lag, times the rate. The readings' difference is taken first: the lag would be
    # nearly the reading itself, and their difference would magnify its rounding error.
    v = derivative.keep * s[_X_VELOCITY] + derivative.rate * (1.0 - derivative.new) * (x - s[_X_READ])
    frame = leak.keep * s[_FRAME_VELOCITY] + (leak.old * s[_FRAME_READ] + leak.new * f) / leak.rate
    driver = leak.keep * s[_DRIVER_VELOCITY] + (leak.old * s[_DRIVER_READ] + leak.new * d) / leak.rate
    y = Measurement(
        true.time, x, v, frame, driver, z, f, d, true.damper_force, true.current, true.temperature, true.replayed
    )
    return y, s[:_FILTERS] + (x, v, f, frame, d, driver)  # noqa: RUF005 - numba has no starred tuples


Sensing = Direct | Instruments
"""Instruments of a law, or none."""


class Sensors(NamedTuple):
    """Instruments that a law uses in place of the true states; u is a true signal, n white noise.

        r  = wb / (s + wb) u + n        wb = 2 pi bandwidth: every reading, filtered in continuous time, then sampled
        v  = s wd / (s + wd) r_x        wd = 2 pi derivative_bandwidth: suspension velocity
        v' = 1 / (s + wc) r_a           wc = 2 pi corner: absolute velocity of frame and driver, a leaky integral

    The last two run at the law's samples, exact for readings linear between them. Noise is drawn at every sample of
    the law, from the scenario's seed. The inverse uses the measured displacement and velocity. Damper force, current
    and temperature are seen without error; the floor's acceleration only with `floor_accelerometer`, else NaN.
    """

    bandwidth: Annotated[float, param("Hz", "corner of the anti-alias low-pass", above=0, high=1e4)] = 80.0
    derivative_bandwidth: Annotated[
        float, param("Hz", "corner of the low-pass that differentiates the displacement", above=0, high=1e4)
    ] = 40.0
    corner: Annotated[float, param("Hz", "corner of the leaky integrators", low=1e-3, high=10)] = 0.1
    displacement_noise: Annotated[float, param("m", "RMS noise of a displacement reading", low=0, high=1)] = 0.0
    acceleration_noise: Annotated[float, param("m/s^2", "RMS noise of an acceleration reading", low=0, high=1e3)] = 0.0
    floor_accelerometer: Annotated[bool, param("", "whether the floor has an accelerometer")] = False

    def instruments(self, step: float, period: float) -> Instruments:
        """Return the compiled form for a loop of `step` and a law of `period` seconds between samples."""
        return Instruments(
            discretise_lag(math.tau * self.bandwidth, step),
            discretise_lag(math.tau * self.derivative_bandwidth, period),
            discretise_lag(math.tau * self.corner, period),
            0.0 if self.floor_accelerometer else math.nan,
        )

    def noise(self, samples: int, seed: int) -> Array:
        """Draw the noise of the readings at `samples` samples of the law, shape (samples, READINGS)."""
        rng = np.random.default_rng([seed, _STREAM])
        a = self.acceleration_noise
        return rng.standard_normal((samples, READINGS)) * [self.displacement_noise, a, a, a]


def at_rest(displacement: float) -> State:
    """Return the instruments' state of a seat at rest at a suspension displacement in m."""
    return tuple(displacement if k in (_X_TRUE, _X_FILTERED, _X_READ) else 0.0 for k in range(INSTRUMENTS))
