"""What a law's instruments tell: readings through anti-alias filters with noise, and velocities made out of them.

Every filter is a first-order lag `y' = rate (u - y)`, solved exactly for an input u that is linear between samples.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.jit import jit
from seatsim.rig.control import Measurement
from seatsim.schema.fields import param

Array = NDArray[np.float64]
State = tuple[float, ...]

READINGS = 4
"""Suspension displacement, then the accelerations of frame, driver and floor."""
STREAM = 1
"""Key of the noise's random stream beside the seed, so that it is not the draw that made the floor."""


class Lag(NamedTuple):
    """One step of `y' = rate (u - y)`: `y <- keep y + old u0 + new u1`, exact for u linear from u0 to u1."""

    rate: float
    keep: float
    old: float
    new: float


def lag(rate: float, time: float) -> Lag:
    """Return the step over `time` seconds of a lag with a `rate` in 1/s."""
    mean = -math.expm1(-rate * time) / (rate * time)
    return Lag(rate, math.exp(-rate * time), mean - math.exp(-rate * time), 1.0 - mean)


@jit
def lagged(step: Lag, y: float, u0: float, u1: float) -> float:
    """Return a lag's output after one step."""
    return step.keep * y + step.old * u0 + step.new * u1


class Direct(NamedTuple):
    """No instruments: the law sees the true states."""


class Instruments(NamedTuple):
    """Compiled form of `Sensors`: the steps of its filters, and what is added to the floor's reading (0 or NaN).

    The state holds last input and output of the four anti-alias filters, then last reading and lag of the displacement
    and last reading and velocity of frame and driver.
    """

    alias: Lag
    derivative: Lag
    leak: Lag
    floor: float

    def passed(self, floor: float, x: float, rates: State, s: State) -> State:
        """Return the state after one step of the loop, in which the anti-alias filters move on.

        `rates` is the derivative of the rig's state, whose entries 1 and 3 are the accelerations of x and cushion.
        """
        a, frame = self.alias, floor + rates[1]
        driver = frame + rates[3]
        filtered = (
            x, lagged(a, s[1], s[0], x), frame, lagged(a, s[3], s[2], frame),
            driver, lagged(a, s[5], s[4], driver), floor, lagged(a, s[7], s[6], floor),
        )  # fmt: skip
        return filtered + s[8:]

    def read(self, true: Measurement, noise: Array, sample: int, s: State) -> tuple[Measurement, State]:
        """Return what the law sees at one of its samples, with that row of the `noise`, and the state after it."""
        x, f = s[1] + noise[sample, 0], s[3] + noise[sample, 1]
        d, z = s[5] + noise[sample, 2], s[7] + noise[sample, 3] + self.floor
        slow = lagged(self.derivative, s[9], s[8], x)
        frame = self.leak.keep * s[11] + (self.leak.old * s[10] + self.leak.new * f) / self.leak.rate
        driver = self.leak.keep * s[13] + (self.leak.old * s[12] + self.leak.new * d) / self.leak.rate
        v = self.derivative.rate * (x - slow)
        y = Measurement(
            true.time, x, v, frame, driver, z, f, d, true.damper_force, true.current, true.temperature, true.replayed
        )
        return y, s[:8] + (x, slow, f, frame, d, driver)  # noqa: RUF005 - numba has no starred tuples


class Sensors(NamedTuple):
    """Instruments that a law runs on in place of the true states; G(s) acts on what is true, n is white noise.

        r  = wb / (s + wb) u + n        wb = 2 pi bandwidth: every reading, filtered in continuous time, then sampled
        v  = s wd / (s + wd) r_x        wd = 2 pi derivative_bandwidth: suspension velocity
        v' = 1 / (s + wc) r_a           wc = 2 pi corner: absolute velocity of frame and driver, a leaky integral

    The last two run at the law's samples, exact for readings linear between them. Noise is drawn at every sample of
    the law, from the scenario's seed. The inverse works on the measured displacement and velocity. Damper force,
    current and temperature are seen as they are; the floor's acceleration only with `floor_accelerometer`, else NaN.
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
            lag(math.tau * self.bandwidth, step),
            lag(math.tau * self.derivative_bandwidth, period),
            lag(math.tau * self.corner, period),
            0.0 if self.floor_accelerometer else math.nan,
        )

    def noise(self, samples: int, seed: int) -> Array:
        """Draw the noise of the readings at `samples` samples of the law, shape (samples, READINGS)."""
        rng = np.random.default_rng([seed, STREAM])
        a = self.acceleration_noise
        return rng.standard_normal((samples, READINGS)) * [self.displacement_noise, a, a, a]


def at_rest(displacement: float) -> State:
    """Return the instruments' state where everything stood still at a suspension displacement in m."""
    return (displacement, displacement, *(0.0,) * 6, displacement, displacement, *(0.0,) * 4)
