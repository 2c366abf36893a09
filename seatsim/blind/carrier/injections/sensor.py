"""Sensors that read wrong: scale, offset, drift, low-pass, and a controller's log that is shifted in time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier.change import Altered, Change, with_tables
from seatsim.blind.carrier.recorded import Carrier, Table
from seatsim.blind.carrier.signals import low_pass, shifted, shifted_rows
from seatsim.schema.arrays import Array

SENSORS = (
    "floor_acceleration", "frame_acceleration", "driver_acceleration", "suspension_displacement", "displacement",
    "damper_force", "coil_current",
)  # fmt: skip
SCALES = {"damper_force": 100.0, "coil_current": 0.1, "suspension_displacement": 0.01, "displacement": 0.01}
"""Unit of a stated offset by channel; 1 m/s^2 for an acceleration."""
INPUTS = ("floor_acceleration", "displacement")
LOGGED = ("current_command", "command_voltage", "coil_current")
LARGEST_GAIN, LONGEST_LAG, LONGEST_SKEW = 0.4, 0.08, 0.04
LARGEST_OFFSET = 2.0
"""Standard deviations of the channel."""


def draw_sensor_changes(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a gain, an offset, a drift and a lag of every sensor.

    The motion of a bench has no offset, since it is counted from its first row, and the floor's accelerometer none
    that the replay would see as anything but a drift.
    """
    found: list[Change] = []
    for channel in SENSORS:
        if channel not in carrier.channels or ("velocity" in carrier.channels and channel == "displacement"):
            continue
        found += [_gain(carrier, channel, rng), _lag(carrier, channel)]
        if channel not in INPUTS:
            found += [_offset(carrier, channel, rng), _drift(carrier, channel, rng)]
    return found


def _gain(carrier: Carrier, channel: str, rng: Generator) -> Change:
    sign = -0.5 if rng.random() < 0.5 else 1.0
    return _reading(carrier, "gain", channel, LARGEST_GAIN, lambda a: ({"error": sign * a}, lambda y: y + sign * a * y))


def _lag(carrier: Carrier, channel: str) -> Change:
    step = carrier.step
    return _reading(carrier, "lag", channel, LONGEST_LAG, lambda a: ({"time": a}, lambda y: low_pass(y, a, step)))


def _offset(carrier: Carrier, channel: str, rng: Generator) -> Change:
    size = _signed(rng) * float(np.std(carrier.pooled(channel)))
    scale = SCALES.get(channel, 1.0)

    def at(amount: float) -> tuple[dict[str, float], Callable[[Array], Array]]:
        return {"share": size * amount / scale}, lambda y: y + size * amount

    return _reading(carrier, "bias", channel, LARGEST_OFFSET, at)


def _drift(carrier: Carrier, channel: str, rng: Generator) -> Change:
    """Return a drift that begins at zero in every run and has reached the amount in the mean of the runs' lengths."""
    size = _signed(rng) * float(np.std(carrier.pooled(channel)))
    scale, rows = SCALES.get(channel, 1.0), len(carrier.pooled(channel)) / len(carrier.tables)
    rate = size / (rows * carrier.step)

    def at(amount: float) -> tuple[dict[str, float], Callable[[Array], Array]]:
        drift = rate * amount
        return {"share": 0.0, "drift": drift / scale}, lambda y: y + drift * carrier.step * np.arange(len(y))

    change = _reading(carrier, "bias", channel, 2.0 * LARGEST_OFFSET, at)
    return change._replace(form="drift")


def _signed(rng: Generator) -> float:
    return -1.0 if rng.random() < 0.5 else 1.0


def _reading(
    carrier: Carrier, name: str, channel: str, largest: float,
    at: Callable[[float], tuple[dict[str, float], Callable[[Array], Array]]],
) -> Change:  # fmt: skip
    def alter(amount: float) -> Altered:
        parameters, read = at(amount)
        return Altered(with_tables(carrier, lambda table: {**table, channel: read(table[channel])}), parameters)

    return Change(f"sensor.{name}", name, channel, (0.0, largest), alter)


def draw_skewed_logs(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a log that is late: every logged channel says at t what was at t - shift.

    A log that runs ahead could as well be a delay of the coil where no current was recorded.
    """
    logged = [name for name in LOGGED if name in carrier.channels]
    if not any(_varies(carrier, name) for name in logged):
        return []
    sign = _signed(rng) if "coil_current" in logged and len(logged) > 1 else 1.0

    def alter(amount: float) -> Altered:
        rows = round(sign * amount / carrier.step)

        def late(table: Table) -> Table:
            moved = {name: shifted_rows(table[name], rows) for name in logged if name != "coil_current"}
            if "coil_current" in logged:
                moved["coil_current"] = shifted(table["coil_current"], rows * carrier.step, carrier.step)
            return {**table, **moved}

        return Altered(with_tables(carrier, late), {"shift": rows * carrier.step})

    return [Change("sensor.clock_skew", "late log" if sign > 0 else "early log", "", (0.0, LONGEST_SKEW), alter)]


def _varies(carrier: Carrier, channel: str) -> bool:
    return any(float(np.ptp(table[channel])) > 0.0 for table in carrier.tables.values())
