"""Fault scenarios of sensors; equations in `truth.sensors`."""

from __future__ import annotations

from numpy.random import Generator

from seatsim.blind.truth.faults.scenario import (
    Changes,
    Context,
    FaultScenario,
    SensorFault,
    SensorFaultKind,
    Shape,
    draw_seed,
)

FAULTY_CHANNELS = (
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


def draw_channel(rng: Generator, context: Context) -> Shape:
    """Draw the channel (as its place in `FAULTY_CHANNELS`), a sign, a detail and a seed."""
    there = [k for k, name in enumerate(FAULTY_CHANNELS) if name in context.channels]
    return {
        "channel": float(rng.choice(there)), "sign": float(rng.choice([-1.0, 1.0])), "detail": rng.uniform(0.0, 1.0),
        "seed": draw_seed(rng),
    }  # fmt: skip


def channel_of(shape: Shape) -> str:
    """Return the drawn channel."""
    return FAULTY_CHANNELS[int(shape["channel"])]


def fault_on_channel(kind: SensorFaultKind, shape: Shape, size: float, context: Context) -> Changes:
    """Return one fault on the drawn channel."""
    name = channel_of(shape)
    return Changes(
        sensor_faults=(SensorFault(kind, name, size, shape["detail"], int(shape["seed"]), context.spread[name]),)
    )


def _gain(severity: float, shape: Shape, context: Context) -> Changes:
    return fault_on_channel("gain", shape, max(0.1 * severity * shape["sign"], -0.7), context)


def _bent_gain(severity: float, shape: Shape, context: Context) -> Changes:
    return fault_on_channel("gain_bent", shape, max(0.1 * severity * shape["sign"], -0.7), context)


def _offset(severity: float, shape: Shape, context: Context) -> Changes:
    return fault_on_channel("bias", shape, 0.1 * severity * shape["sign"] * context.spread[channel_of(shape)], context)


def _wander(severity: float, shape: Shape, context: Context) -> Changes:
    return fault_on_channel("wander", shape, 0.1 * severity * context.spread[channel_of(shape)], context)


def _filter(severity: float, shape: Shape, context: Context) -> Changes:
    return fault_on_channel("lag_second", shape, 0.004 * severity, context)


def _average(severity: float, shape: Shape, context: Context) -> Changes:
    return fault_on_channel("lag_average", shape, 0.004 * severity, context)


def _skew(severity: float, shape: Shape, _: Context) -> Changes:
    return Changes(
        sensor_faults=(SensorFault("skew", "log", 0.006 * severity * shape["sign"], 0.0, int(shape["seed"])),)
    )


def _drifting_skew(severity: float, shape: Shape, _: Context) -> Changes:
    return Changes(
        sensor_faults=(
            SensorFault(
                "skew", "log", 0.006 * severity * shape["sign"], 0.2 + 0.6 * shape["detail"], int(shape["seed"])
            ),
        )
    )


SCENARIOS = (
    FaultScenario("gain-scale", "sensor.gain", "sensor", draw_channel, _gain, (0.1, 6.0)),
    FaultScenario("gain-bent", "sensor.gain", "sensor", draw_channel, _bent_gain, (0.1, 6.0)),
    FaultScenario("bias-drift", "sensor.bias", "sensor", draw_channel, _offset, (0.1, 12.0)),
    FaultScenario("bias-wander", "sensor.bias", "sensor", draw_channel, _wander, (0.1, 12.0)),
    FaultScenario("lag-filter", "sensor.lag", "sensor", draw_channel, _filter, (0.02, 8.0)),
    FaultScenario("lag-average", "sensor.lag", "sensor", draw_channel, _average, (0.02, 8.0)),
    FaultScenario("skew-fixed", "sensor.clock_skew", "sensor", draw_channel, _skew, (0.05, 8.0)),
    FaultScenario("skew-drifting", "sensor.clock_skew", "sensor", draw_channel, _drifting_skew, (0.05, 8.0)),
)
