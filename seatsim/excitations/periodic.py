"""Tones and sweeps of the floor, as a shaker table plays them: sine, stepped sine, chirp, and rest."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field
from pydantic.fields import FieldInfo

from seatsim.excitations.base import Duration, Floor, Quantity, excitation
from seatsim.excitations.motion import Motion, check_step, clock, ease, floor_of, product, samples, sine, soft_start
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param

_Frequency = Annotated[float, param("Hz", "frequency of the tone", above=0)]
_Displacement = Annotated[float, param("m", "amplitude of displacement", above=0)]
_Amplitude = Annotated[float, param("m or m/s^2", "amplitude of displacement or acceleration, see quantity", above=0)]

_TONES: FieldInfo = Field(description="the tones in order", json_schema_extra={"unit": "Hz"}, min_length=1)


@excitation("sine")
class Sine(NamedTuple):
    """A tone `z0 = amplitude * sin(2 pi frequency t)`, faded in from rest over the first second."""

    amplitude: _Displacement
    frequency: _Frequency
    duration: Duration

    def floor(self, step: float, seed: int) -> Floor:
        """Return the motion of the floor; `seed` plays no part.

        Raises:
            InputError: `step` holds fewer than ten samples of a period.
        """
        check_step("sine", step, self.frequency, per_period=10)
        time = clock(samples(self.duration, step), step)
        omega = 2 * np.pi * self.frequency
        return soft_start(step, _scaled(self.amplitude, sine(_line(omega * time, omega))))


@excitation("stepped_sine")
class SteppedSine(NamedTuple):
    """One tone after the other, each at full amplitude for `cycles` periods; in between the floor rests.

    A further period before and one after fade the tone in and out, so a step at frequency f lasts `(cycles +
    2)/f`.
    """

    frequencies: Annotated[tuple[_Frequency, ...], _TONES]
    cycles: Annotated[int, param("", "periods at full amplitude in every step", low=1)]
    amplitude: _Displacement

    @property
    def duration(self) -> float:
        """Length of the whole sequence in s."""
        return float(np.sum(self._lengths))

    @property
    def _lengths(self) -> Array:
        return (self.cycles + 2) / np.asarray(self.frequencies)

    def floor(self, step: float, seed: int) -> Floor:
        """Return the motion of the floor; `seed` plays no part.

        Raises:
            InputError: `step` holds fewer than ten samples of the shortest period.
        """
        check_step("stepped_sine", step, max(self.frequencies), per_period=10)
        time = clock(samples(self.duration, step), step)
        ends = np.cumsum(self._lengths)
        index = np.minimum(np.searchsorted(ends, time, side="right"), len(ends) - 1)
        frequency, length = np.asarray(self.frequencies)[index], self._lengths[index]
        local = time - (ends - self._lengths)[index]
        omega = 2 * np.pi * frequency
        tone = product(_window(local, length, 1 / frequency), sine(_line(omega * local, omega)))
        return floor_of(step, _scaled(self.amplitude, tone))


@excitation("chirp")
class Chirp(NamedTuple):
    """A tone whose frequency glides from start to stop by equal octaves per second.

    `z0 = a(t) sin(phi(t))`, `phi' = 2 pi f(t)`. For a displacement amplitude a is constant, for an
    acceleration amplitude it is `amplitude/(2 pi f(t))^2`, so the acceleration has that amplitude but for
    terms of the order of `f'/f^2`. Faded in from rest over the first second.
    """

    start_frequency: Annotated[float, param("Hz", "frequency at time zero", above=0)]
    stop_frequency: Annotated[float, param("Hz", "frequency at the end", above=0)]
    amplitude: _Amplitude
    duration: Duration
    quantity: Quantity = "displacement"

    def floor(self, step: float, seed: int) -> Floor:
        """Return the motion of the floor; `seed` plays no part.

        Raises:
            InputError: start and stop are equal, or `step` holds fewer than ten samples of the shortest
            period.
        """
        if self.start_frequency == self.stop_frequency:
            raise InputError(
                f"chirp: start_frequency and stop_frequency are both {self.start_frequency:g} Hz; "
                "give different ones, or use kind: sine"
            )
        check_step("chirp", step, max(self.start_frequency, self.stop_frequency), per_period=10)
        phase, omega = self._course(clock(samples(self.duration, step), step))
        tone = sine(Motion(phase, omega.displacement, omega.velocity))
        if self.quantity == "acceleration":
            tone = product(_inverse_square(omega), tone)
        return soft_start(step, _scaled(self.amplitude, tone))

    def _course(self, time: Array) -> tuple[Array, Motion]:
        """Return the phase in rad, and the angular frequency in rad/s with its derivatives."""
        first, last = 2 * np.pi * self.start_frequency, 2 * np.pi * self.stop_frequency
        rate = np.log(last / first) / self.duration
        omega = first * np.exp(rate * time)
        return (omega - first) / rate, Motion(omega, rate * omega, rate**2 * omega)


def _line(value: Array, slope: float | Array) -> Motion:
    return Motion(value, np.broadcast_to(slope, value.shape), np.zeros_like(value))


def _scaled(factor: float | Array, motion: Motion) -> Motion:
    return Motion(*(factor * part for part in motion))


def _inverse_square(omega: Motion) -> Motion:
    w, rate, bend = omega
    return Motion(w**-2, -2 * rate * w**-3, 6 * rate**2 * w**-4 - 2 * bend * w**-3)


def _window(time: Array, length: Array, rise: Array) -> Motion:
    fall = ease(length - time, rise)
    return product(ease(time, rise), Motion(fall.displacement, -fall.velocity, fall.acceleration))


@excitation("rest")
class Rest(NamedTuple):
    """A floor that does not move; the seat is released from the position in `start`."""

    duration: Duration

    def floor(self, step: float, seed: int) -> Floor:
        """Return the floor at rest."""
        still = np.zeros(samples(self.duration, step))
        return Floor(step, still, still, still)
