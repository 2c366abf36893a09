"""Faults that data may have: wrong signs and units, exchanged channels, delays; each with its correction."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from seatsim.recordings.channel_units import BENCH_CHANNELS, SEAT_CHANNELS
from seatsim.recordings.compared import LEFT_OUT
from seatsim.recordings.quality.residual import filter_band, find_delay
from seatsim.recordings.quality.run_under_test import LATE, MOTION, Array, RunUnderTest, Table
from seatsim.schema.units import USUAL, conversion

TOGETHER = (("floor_acceleration", "frame_acceleration", "driver_acceleration"), ("displacement", "velocity"))
"""Channels whose axis may point down for all of them."""
LONGEST_DELAY = 0.5
"""s; largest delay that is sought: half a period of the slowest motion considered."""
ALIKE = 0.8
"""Least correlation with the simulation for a channel to be its delayed copy: below it may be another motion."""


class DataFault(NamedTuple):
    """A fault that channels may have: `correct` takes the table of a run and returns it as it should be."""

    kind: str
    channels: tuple[str, ...]
    says: str
    correct: Callable[[Table], Table]


def list_faults(run: RunUnderTest, outputs: Table | None) -> Iterator[DataFault]:
    """Yield every fault that a run may have; delays are relative to simulated outputs."""
    for channel in run.table:
        yield from _scales(channel)
    for channels in TOGETHER:
        swapped = tuple(channel for channel in channels if channel in run.table)
        if len(swapped) > 1:
            yield DataFault("sign", swapped, "all their signs are swapped", _swapped(swapped))
    for first, second in itertools.combinations(MOTION[:3], 2):
        if first in run.table and second in run.table:
            yield exchange_fault(first, second)
    yield from _delays(run, outputs or {})


def _scales(channel: str) -> Iterator[DataFault]:
    if channel in MOTION or channel == "coil_current":
        yield DataFault("sign", (channel,), "its sign is swapped", _scaled(channel, -1.0))
    if channel in MOTION:
        wanted = (SEAT_CHANNELS | BENCH_CHANNELS)[channel]
        for unit in USUAL[wanted][1:]:
            factor = conversion(unit, wanted).factor
            yield DataFault("unit", (channel,), f"reads as if in {unit}", _scaled(channel, factor))


def _scaled(channel: str, factor: float) -> Callable[[Table], Table]:
    return lambda table: {**table, channel: factor * table[channel]}


def _swapped(channels: Sequence[str]) -> Callable[[Table], Table]:
    return lambda table: {**table, **{channel: -table[channel] for channel in channels}}


def exchange_fault(first: str, second: str) -> DataFault:
    """Return the fault of two channels that are exchanged."""
    says = "are exchanged for each other"
    return DataFault("exchange", (first, second), says, lambda t: {**t, first: t[second], second: t[first]})


def _delays(run: RunUnderTest, outputs: Table) -> Iterator[DataFault]:
    """Yield each output's delay relative to the simulation, and the delay of the floor that explains the most."""
    skip = round(LEFT_OUT * run.rate)
    found = []
    for channel, values in outputs.items():
        recorded, simulated = filter_band(run, run.table[channel][skip:]), filter_band(run, values)
        late, alike = find_delay(recorded, simulated, round(LONGEST_DELAY * run.rate))
        if alike > ALIKE and abs(late) > (LATE if channel in MOTION else 2.0 * LATE) * run.rate:
            found += [late] if channel in MOTION else []
            yield _delay(channel, late, run.rate)
    if found:
        yield _delay(run.driver, -int(np.median(found)), run.rate)


def _delay(channel: str, rows: int, rate: float) -> DataFault:
    says = f"is {abs(rows) / rate:.3g} s {'late' if rows > 0 else 'early'}"
    return DataFault("late", (channel,), says, lambda table: {**table, channel: _moved(table[channel], rows)})


def _moved(values: Array, rows: int) -> Array:
    """Return values shifted `rows` earlier; the end that becomes empty repeats the edge value."""
    return values[np.clip(np.arange(len(values)) + rows, 0, len(values) - 1)]
