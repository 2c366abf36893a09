"""Faults of the coil: a command that was given earlier than logged, a supply that did not reach it, a slow current."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier.change import Altered, Change, with_tables
from seatsim.blind.carrier.recorded import Carrier, Table, number, section
from seatsim.blind.carrier.signals import shifted_rows
from seatsim.schema.arrays import Array

COMMANDS = ("current_command", "command_voltage")
LONGEST_DELAY = 0.04
"""s"""
FASTEST = 3000.0
"""1/s; a coil that is faster follows at once."""
NEAR_TOP = 0.93
"""Share of the largest command from which on it counts as the limit."""


def draw_delays(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a coil that follows its command late: the command is logged earlier than it was given."""
    command = commanded(carrier)
    if command is None or not any(np.ptp(table[command]) > 0.0 for table in carrier.tables.values()):
        return []

    def alter(amount: float) -> Altered:
        rows = round(amount / carrier.step)
        early = with_tables(carrier, lambda table: {**table, command: shifted_rows(table[command], -rows)})
        return Altered(early, {"time": rows * carrier.step})

    return [Change("coil.delay", "command advanced", "", (0.0, LONGEST_DELAY), alter)]


def draw_faster_coils(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a nominal that believes in a faster coil than was identified, so that the rig's lags behind it.

    The recorded command cannot be sharpened in its stead: a switched one would leave the range of the supply. As the
    nominal tells what was done, this is no change for a set whose labels are sealed.
    """
    command = commanded(carrier)
    coil = section(carrier.nominal, "actuator")
    rate = number(coil.get("rate", 130.0))
    if command is None or not any(np.ptp(table[command]) > 0.0 for table in carrier.tables.values()):
        return []
    longest = 1.0 / rate - 1.0 / FASTEST

    def alter(amount: float) -> Altered:
        faster = {**carrier.nominal, "actuator": {**coil, "rate": float(f"{1.0 / (1.0 / rate - amount):.6g}")}}
        return Altered(dataclasses.replace(carrier, nominal=faster), {"time": amount})

    return [Change("coil.lag", "coil of the nominal made faster", "", (0.0, longest), alter)] if longest > 0.0 else []


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
    high = command >= NEAR_TOP * top
    starts = np.flatnonzero(np.diff(high.astype(int), prepend=0) == 1)
    pulse = np.cumsum(np.isin(np.arange(len(command)), starts))
    share = np.where(rng.random(len(starts) + 1) < 0.6, rng.uniform(0.3, 1.0, len(starts) + 1), 0.0)
    return np.where(high, share[pulse], 0.0)


def commanded(carrier: Carrier) -> str | None:
    """Return the channel that commands the coil, None where none is recorded."""
    return next((name for name in COMMANDS if name in carrier.channels), None)
