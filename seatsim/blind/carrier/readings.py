"""Faults of the coil and of sensors, as changes of what was logged.

A command that was given earlier than logged, a supply that did not reach it, a slow current; scale, offset, drift and
low-pass of a sensor, and a controller's log that is shifted in time.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier.recorded import (
    Altered,
    Carrier,
    Change,
    Table,
    low_pass,
    number,
    section,
    shifted,
    shifted_rows,
    with_tables,
)
from seatsim.schema.arrays import Array

_COMMANDS = ("current_command", "command_voltage")
_LONGEST_DELAY = 0.04
"""s"""
_NEAR_TOP = 0.93
"""Share of the largest command from which on it counts as the limit."""
_SENSORS = (
    *("floor_acceleration", "frame_acceleration", "driver_acceleration", "suspension_displacement"),
    *("displacement", "damper_force", "coil_current"),
)
_SCALES = {"damper_force": 100.0, "coil_current": 0.1, "suspension_displacement": 0.01, "displacement": 0.01}
"""Unit of a stated offset by channel; 1 m/s^2 for an acceleration."""
_INPUTS = ("floor_acceleration", "displacement")
_LOGGED = ("current_command", "command_voltage", "coil_current")
_LARGEST_GAIN, _LONGEST_LAG, _LONGEST_SKEW = 0.4, 0.08, 0.04
_LARGEST_OFFSET = 2.0
"""Standard deviations of the channel."""


def draw_delays(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a coil that follows its command late: the command is logged earlier than it was given."""
    command = commanded(carrier)
    if command is None or not any(np.ptp(table[command]) > 0.0 for table in carrier.tables.values()):
        return []

    def alter(amount: float) -> Altered:
        rows = round(amount / carrier.step)
        early = with_tables(carrier, lambda table: {**table, command: shifted_rows(table[command], -rows)})
        return Altered(early, {"time": rows * carrier.step})

    return [Change("coil.delay", "command advanced", "", (0.0, _LONGEST_DELAY), alter)]


def draw_limits(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a supply at its limit: pulses or runs at the largest command are logged as more than that.

    What flowed is what was measured, so the limit is the largest true command. Only some of them are raised, by
    different amounts, so that no scale of the command does the same. Without a recorded current a limit can hardly be
    told from a saturation of the yield force.
    """
    command = commanded(carrier)
    if command is None or "coil_current" not in carrier.channels:
        return []
    gain = number(section(carrier.header, "actuator").get("gain", 1.0)) if command == "command_voltage" else 1.0
    top = max(float(np.quantile(table[command], 0.99)) for table in carrier.tables.values())
    room = number(section(carrier.nominal, "actuator").get("max_current", 1.0)) / max(gain * top, 1e-9) - 1.0
    if top <= 0.0 or room < 0.2:
        return []
    raised = {run: _raises(table[command], top, rng) for run, table in carrier.tables.items()}

    def alter(amount: float) -> Altered:
        def lifted(run: str, table: Table) -> Table:
            return {**table, command: table[command] * (1.0 + amount * raised[run])}

        tables = {run: lifted(run, table) for run, table in carrier.tables.items()}
        return Altered(dataclasses.replace(carrier, tables=tables), {"limit": gain * top})

    return [Change("coil.current_limit", "command raised above what flowed", "", (0.0, room), alter)]


def _raises(command: Array, top: float, rng: Generator) -> Array:
    """Return by which share each row is raised, 0 to 1, drawn for every pulse at the top; shape (N,)."""
    high = command >= _NEAR_TOP * top
    starts = np.flatnonzero(np.diff(high.astype(int), prepend=0) == 1)
    pulse = np.cumsum(np.isin(np.arange(len(command)), starts))
    share = np.where(rng.random(len(starts) + 1) < 0.6, rng.uniform(0.3, 1.0, len(starts) + 1), 0.0)
    return np.where(high, share[pulse], 0.0)


def commanded(carrier: Carrier) -> str | None:
    """Return the channel that commands the coil, None where none is recorded."""
    return next((name for name in _COMMANDS if name in carrier.channels), None)


def draw_sensor_changes(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a gain, an offset, a drift and a lag of every sensor.

    The motion of a bench has no offset, since it is counted from its first row, and the floor's accelerometer none
    that the replay would see as anything but a drift.
    """
    found: list[Change] = []
    for channel in _SENSORS:
        if channel not in carrier.channels or ("velocity" in carrier.channels and channel == "displacement"):
            continue
        found += [_gain(carrier, channel, rng), _lag(carrier, channel)]
        if channel not in _INPUTS:
            found += [_offset(carrier, channel, rng), _drift(carrier, channel, rng)]
    return found


def _gain(carrier: Carrier, channel: str, rng: Generator) -> Change:
    sign = -0.5 if rng.random() < 0.5 else 1.0
    return _reading(
        carrier, "gain", channel, _LARGEST_GAIN, lambda a: ({"error": sign * a}, lambda y: y + sign * a * y)
    )


def _lag(carrier: Carrier, channel: str) -> Change:
    step = carrier.step
    return _reading(carrier, "lag", channel, _LONGEST_LAG, lambda a: ({"time": a}, lambda y: low_pass(y, a, step)))


def _offset(carrier: Carrier, channel: str, rng: Generator) -> Change:
    size = _signed(rng) * float(np.std(carrier.pooled(channel)))
    scale = _SCALES.get(channel, 1.0)

    def at(amount: float) -> tuple[dict[str, float], Callable[[Array], Array]]:
        return {"share": size * amount / scale}, lambda y: y + size * amount

    return _reading(carrier, "bias", channel, _LARGEST_OFFSET, at)


def _drift(carrier: Carrier, channel: str, rng: Generator) -> Change:
    """Return a drift that begins at zero in every run and has reached the amount in the mean of the runs' lengths."""
    size = _signed(rng) * float(np.std(carrier.pooled(channel)))
    scale, rows = _SCALES.get(channel, 1.0), len(carrier.pooled(channel)) / len(carrier.tables)
    rate = size / (rows * carrier.step)

    def at(amount: float) -> tuple[dict[str, float], Callable[[Array], Array]]:
        drift = rate * amount
        return {"share": 0.0, "drift": drift / scale}, lambda y: y + drift * carrier.step * np.arange(len(y))

    change = _reading(carrier, "bias", channel, 2.0 * _LARGEST_OFFSET, at)
    return change._replace(form="drift")


def _signed(rng: Generator) -> float:
    return -1.0 if rng.random() < 0.5 else 1.0


def _reading(
    carrier: Carrier,
    name: str,
    channel: str,
    largest: float,
    at: Callable[[float], tuple[dict[str, float], Callable[[Array], Array]]],
) -> Change:
    def alter(amount: float) -> Altered:
        parameters, read = at(amount)
        return Altered(with_tables(carrier, lambda table: {**table, channel: read(table[channel])}), parameters)

    return Change(f"sensor.{name}", name, channel, (0.0, largest), alter)


def draw_skewed_logs(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a log that is late: every logged channel says at t what was at t - shift.

    A log that runs ahead could as well be a delay of the coil where no current was recorded.
    """
    logged = [name for name in _LOGGED if name in carrier.channels]
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

    return [Change("sensor.clock_skew", "late log" if sign > 0 else "early log", "", (0.0, _LONGEST_SKEW), alter)]


def _varies(carrier: Carrier, channel: str) -> bool:
    return any(float(np.ptp(table[channel])) > 0.0 for table in carrier.tables.values())
