"""Effects of the sensors: wrong scale, offset, lag, and a controller's log that is shifted in time."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from seatsim.effects.base import Form, effect
from seatsim.rig.sensors import discretise_lag
from seatsim.schema.arrays import Array
from seatsim.schema.fields import param

_ChannelName = Literal[
    "floor_acceleration",
    "frame_acceleration",
    "driver_acceleration",
    "suspension_displacement",
    "displacement",
    "damper_force",
    "coil_current",
]
_ChannelField = Annotated[_ChannelName, Field(description="the recorded channel that is wrong")]
_SCALES = {"damper_force": 100.0, "coil_current": 0.1, "suspension_displacement": 0.01, "displacement": 0.01}
"""Scale of a channel in its unit, about a tenth of its range on a shaken seat; 1 m/s^2 for an acceleration."""
_COMMANDS = ("current_command", "command_voltage")
_LOGGED = (*_COMMANDS, "coil_current")
"""Channels of the controller's log, and those of them that command the coil."""
_SHORTEST_LAG = 1e-6
"""s; a shorter lag counts as none: the rows cannot show it, and its equation would be too stiff."""
_ROUNDING = 1e-6
"""Rows by which a delay may exceed a whole number of rows and still count as that many."""
_LATE = (0.001, 0.003, 0.006, 0.011, 0.018, 0.028, 0.042)
_EARLY = tuple(-shift for shift in _LATE)
"""s; shifts from which a fit starts: with a stepped current it converges only from near the true shift."""


@effect("sensor.gain", source="calibration", by_channel=True, off={"error": 0.0}, forms=({"error": 0.05},))
class Gain(NamedTuple):
    """One channel reads with a wrong scale: `(1 + error)` times the truth."""

    channel: _ChannelField
    error: Annotated[float, param("-", "relative error of the scale", low=-0.5, high=1)]

    def reading(self, channel: str, step: float, values: Array) -> Array:
        """Return what the sensor says, shape (N,)."""
        return values * (1.0 + self.error) if channel == self.channel else values

    def truth(self, channel: str, step: float, values: Array) -> Array:
        """Return what is true, shape (N,)."""
        return values / (1.0 + self.error) if channel == self.channel else values


@effect(
    "sensor.bias",
    source="zero error and drift",
    by_channel=True,
    forms=({"share": 0.1}, Form({"share": 0.1, "drift": 0.01}, sizes=2)),
)
class Bias(NamedTuple):
    """One channel reads with an offset that may drift: `truth + scale (share + drift t)`.

    The scale is 1 m/s^2, 10 mm, 100 N or 0.1 A, by channel.
    """

    channel: _ChannelField
    share: Annotated[float, param("-", "offset over the channel's scale", low=-50, high=50)]
    drift: Annotated[float, param("1/s", "drift over the channel's scale", low=-1, high=1)] = 0.0

    def reading(self, channel: str, step: float, values: Array) -> Array:
        """Return what the sensor says, shape (N,)."""
        return values + self._offset(step, len(values)) if channel == self.channel else values

    def truth(self, channel: str, step: float, values: Array) -> Array:
        """Return what is true, shape (N,)."""
        return values - self._offset(step, len(values)) if channel == self.channel else values

    def _offset(self, step: float, count: int) -> Array:
        """Return the offset in the channel's unit at `count` rows."""
        rows = np.arange(count, dtype=np.float64)
        return _SCALES.get(self.channel, 1.0) * (self.share + self.drift * step * rows)


@effect("sensor.lag", source="first-order low-pass", by_channel=True, forms=({"time": 0.004},))
class SensorLag(NamedTuple):
    """One channel reads through a low-pass of first order: `time r' = truth - r`."""

    channel: _ChannelField
    time: Annotated[float, param("s", "time constant", low=0, high=0.1)]

    def reading(self, channel: str, step: float, values: Array) -> Array:
        """Return what the sensor says, shape (N,): the truth taken as linear between samples."""
        if channel != self.channel or self.time <= _SHORTEST_LAG:
            return values
        # Takes half a second to load, and few rigs have the effect.
        from scipy.signal import lfilter, lfilter_zi

        one = discretise_lag(1.0 / self.time, step)
        numerator, denominator = [one.new, one.old], [1.0, -one.keep]
        start = lfilter_zi(numerator, denominator) * values[0]
        return np.asarray(lfilter(numerator, denominator, values, zi=start)[0], dtype=np.float64)

    def truth(self, channel: str, step: float, values: Array) -> Array:
        """Return what is true, shape (N,): the reading and its slope over two rows."""
        if channel != self.channel or self.time <= _SHORTEST_LAG:
            return values
        return values + self.time * np.gradient(values, step)


@effect(
    "sensor.clock_skew",
    source="two clocks",
    forms=(
        *({"shift": shift} for shift in (*_LATE[1::2], *_EARLY[1::2])),
        {"shift": 0.003, "drift": 5e-5},
        {"shift": -0.003, "drift": 5e-5},
        *(Form({"shift": shift}, {"hold": 0.002}) for shift in (*_LATE, *_EARLY)),
        *(Form({"shift": shift, "drift": 1e-5}, {"hold": 0.002}) for shift in (*_LATE[1::2], *_EARLY[1::2])),
        *(Form({"shift": shift, "drift": -shift / 60.0}, {"hold": 0.002}) for shift in (0.003, -0.003)),
    ),
)
class ClockSkew(NamedTuple):
    """The controller's log is late by `shift + drift t` against the other channels: it says at t what was at t - shift.

    The coil current, a continuous signal, is delayed by exactly that. So is the command where `hold` is 0. A command
    that the controller changes every `hold` seconds, at rows of the log, is delayed by whole multiples of `hold`.
    """

    shift: Annotated[float, param("s", "delay of the log; negative: it runs ahead", low=-0.5, high=0.5)]
    drift: Annotated[float, param("-", "growth of the delay per second", low=-1e-3, high=1e-3)] = 0.0
    hold: Annotated[float, param("s", "interval of the commands; 0: any time", low=0, high=0.1)] = 0.0

    def reading(self, channel: str, step: float, values: Array) -> Array:
        """Return the logged values, shape (N,)."""
        if channel not in _LOGGED:
            return values
        rows = np.arange(len(values)) * step
        return np.interp(rows - self.shift - self.drift * rows, rows, values)

    def truth(self, channel: str, step: float, values: Array) -> Array:
        """Return the true command, voltage or current, shape (N,)."""
        if channel not in _LOGGED:
            return values
        rows = np.arange(len(values)) * step
        late = self.shift + self.drift * rows
        if channel in _COMMANDS and self.hold > 0.0:
            late = self.hold * np.ceil(late / self.hold - _ROUNDING)
            index = np.arange(len(values)) + np.rint(late / step).astype(int)
            return np.asarray(values[np.clip(index, 0, len(values) - 1)])
        return np.interp(rows + late, rows, values)
