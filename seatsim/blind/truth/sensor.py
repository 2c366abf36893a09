"""Truth forms of sensor effects; equations in `sensors`."""

from __future__ import annotations

from numpy.random import Generator

from seatsim.blind.truth.truth import Changes, Context, Fault, Shape, Truth, seed

READ = (
    "frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force", "coil_current",
    "floor_acceleration",
)  # fmt: skip
"""Channels that a sensor fault can sit on, where they are recorded."""

NEIGHBOUR = {
    "frame_acceleration": "driver_acceleration", "driver_acceleration": "frame_acceleration",
    "suspension_displacement": "frame_acceleration", "damper_force": "suspension_displacement",
    "coil_current": "damper_force", "floor_acceleration": "frame_acceleration",
}  # fmt: skip
"""The channel that couples into each, where channels are not kept apart."""


def channel_shape(rng: Generator, c: Context) -> Shape:
    """Draw the channel (as its place in `READ`), a sign, a detail and a seed."""
    there = [k for k, name in enumerate(READ) if name in c.channels]
    return {
        "channel": float(rng.choice(there)), "sign": float(rng.choice([-1.0, 1.0])), "detail": rng.uniform(0.0, 1.0),
        "seed": seed(rng),
    }  # fmt: skip


def channel_of(q: Shape) -> str:
    """Return the drawn channel."""
    return READ[int(q["channel"])]


def fault(kind: str, q: Shape, size: float, c: Context) -> Changes:
    """Return one fault on the drawn channel."""
    name = channel_of(q)
    return Changes(faults=(Fault(kind, name, size, q["detail"], int(q["seed"]), c.spread[name]),))


def _gain(s: float, q: Shape, c: Context) -> Changes:
    return fault("gain", q, max(0.1 * s * q["sign"], -0.7), c)


def _bent_gain(s: float, q: Shape, c: Context) -> Changes:
    return fault("gain_bent", q, max(0.1 * s * q["sign"], -0.7), c)


def _offset(s: float, q: Shape, c: Context) -> Changes:
    return fault("bias", q, 0.1 * s * q["sign"] * c.spread[channel_of(q)], c)


def _wander(s: float, q: Shape, c: Context) -> Changes:
    return fault("wander", q, 0.1 * s * c.spread[channel_of(q)], c)


def _filter(s: float, q: Shape, c: Context) -> Changes:
    return fault("lag_second", q, 0.004 * s, c)


def _average(s: float, q: Shape, c: Context) -> Changes:
    return fault("lag_average", q, 0.004 * s, c)


def _skew(s: float, q: Shape, _: Context) -> Changes:
    return Changes(faults=(Fault("skew", "log", 0.006 * s * q["sign"], 0.0, int(q["seed"])),))


def _drifting_skew(s: float, q: Shape, _: Context) -> Changes:
    return Changes(faults=(Fault("skew", "log", 0.006 * s * q["sign"], 0.2 + 0.6 * q["detail"], int(q["seed"])),))


TRUTHS = (
    Truth("gain-scale", "sensor.gain", "sensor", channel_shape, _gain, (0.1, 6.0)),
    Truth("gain-bent", "sensor.gain", "sensor", channel_shape, _bent_gain, (0.1, 6.0)),
    Truth("bias-drift", "sensor.bias", "sensor", channel_shape, _offset, (0.1, 12.0)),
    Truth("bias-wander", "sensor.bias", "sensor", channel_shape, _wander, (0.1, 12.0)),
    Truth("lag-filter", "sensor.lag", "sensor", channel_shape, _filter, (0.02, 8.0)),
    Truth("lag-average", "sensor.lag", "sensor", channel_shape, _average, (0.02, 8.0)),
    Truth("skew-fixed", "sensor.clock_skew", "sensor", channel_shape, _skew, (0.05, 8.0)),
    Truth("skew-drifting", "sensor.clock_skew", "sensor", channel_shape, _drifting_skew, (0.05, 8.0)),
)
