"""Faults of the coil and of sensors, as changes of what was logged.

A command that was given earlier than logged, a supply that did not reach it, a slow current; scale, offset, drift and
low-pass of a sensor, and a controller's log that is shifted in time.
"""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier import recorded
from seatsim.blind.carrier.recorded import Altered, Carrier, Change, Table, change_runs, number, section
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
    if command is None or not _varies(carrier, command):
        return []

    def early(table: Table, amount: float) -> Table:
        return {command: recorded.shifted_rows(table[command], -round(amount / carrier.step))}

    def state(amount: float) -> dict[str, float]:
        return {"time": round(amount / carrier.step) * carrier.step}

    return [change_runs(carrier, ("coil.delay", "command advanced", ""), _LONGEST_DELAY, early, state)]


def draw_limits(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a supply at its limit: pulses or runs at the largest command are logged as more than that.

    What flowed is what was measured, so the limit is the largest true command. Only some of them are raised, by
    different amounts, so that no scale of the command does the same. Without a recorded current a limit can hardly be
    told from a saturation of the yield force.
    """
    command = commanded(carrier)
    if command is None or "coil_current" not in carrier.channels:
        return []
    gain = command_gain(carrier, command)
    top = max(float(np.quantile(table[command], 0.99)) for table in carrier.tables.values())
    room = number(section(carrier.nominal, "actuator").get("max_current", 1.0)) / max(gain * top, 1e-9) - 1.0
    if top <= 0.0 or room < 0.2:
        return []
    raised = {run: _raises(table[command], top, rng) for run, table in carrier.tables.items()}

    def alter(amount: float) -> Altered:
        tables = {
            run: {**table, command: table[command] * (1.0 + amount * raised[run])}
            for run, table in carrier.tables.items()
        }
        return Altered(carrier._replace(tables=tables), {"limit": gain * top})

    return [Change("coil.current_limit", "command raised above what flowed", "", room, alter)]


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


def command_gain(carrier: Carrier, command: str) -> float:
    """Return the current of a command, A/V of a voltage."""
    return number(section(carrier.header, "actuator").get("gain", 1.0)) if command == "command_voltage" else 1.0


def draw_sensor_changes(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a gain, an offset, a drift and a lag of every sensor.

    The motion of a bench has no offset, since it is counted from its first row, and the floor's accelerometer none
    that the replay would see as anything but a drift.
    """
    found: list[Change] = []
    for channel in _SENSORS:
        if channel in carrier.channels and not ("velocity" in carrier.channels and channel == "displacement"):
            found += _misread(carrier, channel, rng)
    return found


def _misread(carrier: Carrier, channel: str, rng: Generator) -> list[Change]:
    """Return the changes of a sensor; its drift is zero at first, and the amount in the mean of the runs' lengths."""
    step, scale, pooled = carrier.step, _SCALES.get(channel, 1.0), carrier.pooled(channel)

    def change(
        effect: str, form: str, largest: float, read: Callable[[Array, float], Array], parameters: recorded.Parameters
    ) -> Change:
        named = (f"sensor.{effect}", form, channel)
        return change_runs(carrier, named, largest, lambda table, a: {channel: read(table[channel], a)}, parameters)

    sign = recorded.draw_sign(rng, -0.5)
    found = [
        change("gain", "gain", _LARGEST_GAIN, lambda u, a: u + sign * a * u, lambda a: {"error": sign * a}),
        change("lag", "lag", _LONGEST_LAG, lambda u, a: recorded.low_pass(u, a, step), lambda a: {"time": a}),
    ]
    if channel in _INPUTS:
        return found
    offset, last = (recorded.draw_sign(rng) * float(np.std(pooled)) for _ in range(2))
    rate = last / (len(pooled) / len(carrier.tables) * step)

    def drifting(u: Array, amount: float) -> Array:
        return u + rate * amount * step * np.arange(len(u))

    def rates(amount: float) -> dict[str, float]:
        return {"share": 0.0, "drift": rate * amount / scale}

    return [
        *found,
        change("bias", "bias", _LARGEST_OFFSET, lambda u, a: u + offset * a, lambda a: {"share": offset * a / scale}),
        change("bias", "drift", 2.0 * _LARGEST_OFFSET, drifting, rates),
    ]


def draw_skewed_logs(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a log that is late: every logged channel says at t what was at t - shift.

    A log that runs ahead could as well be a delay of the coil where no current was recorded.
    """
    logged = [name for name in _LOGGED if name in carrier.channels]
    if not any(_varies(carrier, name) for name in logged):
        return []
    sign = recorded.draw_sign(rng) if "coil_current" in logged and len(logged) > 1 else 1.0

    def rows(amount: float) -> int:
        return round(sign * amount / carrier.step)

    def late(table: Table, amount: float) -> Table:
        moved = {name: recorded.shifted_rows(table[name], rows(amount)) for name in logged}
        if "coil_current" in logged:
            moved["coil_current"] = recorded.shifted(table["coil_current"], rows(amount) * carrier.step, carrier.step)
        return moved

    named = ("sensor.clock_skew", "late log" if sign > 0 else "early log", "")
    return [change_runs(carrier, named, _LONGEST_SKEW, late, lambda a: {"shift": rows(a) * carrier.step})]


def _varies(carrier: Carrier, channel: str) -> bool:
    return any(float(np.ptp(table[channel])) > 0.0 for table in carrier.tables.values())
