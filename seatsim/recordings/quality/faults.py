"""Damages that a recording may have suffered: wrong signs and units, exchanged channels, delays; each can be undone."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from seatsim.recordings.compared import LEFT_OUT
from seatsim.recordings.quality.issue import LATE, MOTION, Array, Run, Table
from seatsim.recordings.quality.residual import band, lateness

UNITS: dict[str, dict[str, float]] = {
    "acceleration": {"g": 1 / 9.81, "ft/s^2": 1 / 0.3048, "cm/s^2": 100.0, "mm/s^2": 1000.0},
    "displacement": {"inch": 1 / 0.0254, "cm": 100.0, "mm": 1000.0},
    "velocity": {"cm/s": 100.0, "mm/s": 1000.0},
    "force": {"kN": 0.001},
}
"""What a channel of motion or force reads in another unit, per SI unit, by the last word of its name."""


class Damage(NamedTuple):
    """A damage that may have been done to channels: `undo` takes the table of a run and returns it as it was."""

    kind: str
    channels: tuple[str, ...]
    says: str
    undo: Callable[[Table], Table]


def damages(run: Run, outputs: Table | None) -> Iterator[Damage]:
    """Yield every damage that a run may have suffered; delays are told by simulated outputs."""
    for channel in run.table:
        yield from _scales(channel)
    for first, second in itertools.combinations(MOTION[:3], 2):
        if first in run.table and second in run.table:
            yield exchange(first, second)
    yield from _delays(run, outputs or {})


def _scales(channel: str) -> Iterator[Damage]:
    quantity = channel.rpartition("_")[2]
    if channel in MOTION or channel == "coil_current":
        yield Damage("sign", (channel,), "its sign is swapped", _scaled(channel, -1.0))
    for unit, factor in UNITS.get(quantity, {}).items():
        yield Damage("unit", (channel,), f"reads as if in {unit}", _scaled(channel, 1.0 / factor))


def _scaled(channel: str, factor: float) -> Callable[[Table], Table]:
    return lambda table: {**table, channel: factor * table[channel]}


def exchange(first: str, second: str) -> Damage:
    """Return the damage of two channels that stand for each other."""
    says = "are exchanged for each other"
    return Damage("exchange", (first, second), says, lambda t: {**t, first: t[second], second: t[first]})


def _delays(run: Run, outputs: Table) -> Iterator[Damage]:
    """Yield the delay of each output against the simulation, and that of the floor that would explain the most."""
    skip = round(LEFT_OUT * run.rate)
    found = []
    for channel, values in outputs.items():
        late, alike = lateness(band(run, run.table[channel][skip:]), band(run, values), round(0.5 * run.rate))
        if alike > 0.8 and abs(late) > (LATE if channel in MOTION else 2.0 * LATE) * run.rate:
            found += [late] if channel in MOTION else []
            yield _delay(channel, late, run.rate)
    if found:
        yield _delay(run.driver, -int(np.median(found)), run.rate)


def _delay(channel: str, rows: int, rate: float) -> Damage:
    says = f"is {abs(rows) / rate:.3g} s {'late' if rows > 0 else 'early'}"
    return Damage("late", (channel,), says, lambda table: {**table, channel: _moved(table[channel], rows)})


def _moved(values: Array, rows: int) -> Array:
    """Return values taken `rows` earlier, held at the end that runs out."""
    return values[np.clip(np.arange(len(values)) + rows, 0, len(values) - 1)]
