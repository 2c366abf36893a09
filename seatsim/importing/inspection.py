"""What a file or a recording holds: every channel with unit, rate, range, RMS and noise, and every doubt about it.

Of a recording that is also what `gap` and `diagnose` say of it.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.importing.doubts import doubt_channel, doubt_pairs, doubt_time
from seatsim.importing.import_map import Rig
from seatsim.importing.matching import Column, channel_of, read_columns
from seatsim.importing.names import SI_UNITS, is_of, read_name, without_unit
from seatsim.importing.readers.reading import read_file
from seatsim.importing.signals import Axis, Clock, DataFile, Group, Signal, find_clock, is_spectrum
from seatsim.recordings.quality.damage import noise_of
from seatsim.recordings.quality.examination import examine, merge_issues
from seatsim.recordings.quality.issue import Issue, doubt, place_in_run
from seatsim.recordings.quality.relations import doubt_relations
from seatsim.recordings.recording import BENCH_CHANNELS, CHANNELS, SEAT_CHANNELS, load_recording
from seatsim.schema.arrays import Array
from seatsim.schema.units import conversion

_RARE = 0.01
"""Share of rows in which a channel repeats itself, above which it is too coarse to show rows written twice."""


class ChannelSummary(NamedTuple):
    """One channel: figures in the unit that stands there; `noise` is the RMS that the high-frequency floor shows.

    `group` is that of the file, or the run; `channel` the channel of a recording that the name means, None where it
    means none.
    """

    group: str
    name: str
    unit: str
    channel: str | None
    rate: float | None
    rows: int
    low: float
    high: float
    mean: float
    rms: float
    noise: float | None


class Inspection(NamedTuple):
    """The channels of a file or a recording, group by group, and the doubts about them."""

    source: str
    format: str
    channels: list[ChannelSummary]
    doubts: list[Issue]


def inspect_file(path: Path) -> Inspection:
    """Return what a file holds.

    Raises:
        InputError: it cannot be read.
    """
    file = read_file(path)
    channels: list[ChannelSummary] = []
    doubts = [Issue("note", "left_out", note) for note in file.notes]
    columns = [column for group in file.groups for column in read_columns(group)]
    rig: Rig = "seat" if any(column.meaning.place for column in columns) else "damper_bench"
    for group in file.groups:
        summaries, found = _group(group, rig)
        channels += summaries
        doubts += found
    return Inspection(str(path), file.format, channels, [*doubts, *_doubt_repeats(file)])


def _group(group: Group, rig: Rig) -> tuple[list[ChannelSummary], list[Issue]]:
    """Return the channels of a group, and the doubts about them, their time and what they are to each other."""
    columns = read_columns(group)
    clock = find_clock(group)
    axis = clock.axis if clock else None
    rate = axis.rate if axis else group.rate
    found = list(_doubt_rows(group, clock))
    known: dict[str, Array] = {}
    quantities: dict[str, str | None] = {}
    summaries = []
    for column in columns:
        if (clock and column.signal.name == clock.column) or column.meaning.quantity == "distance":
            continue
        values, quantity = _in_si(column)
        if column.meaning.quantity != "mark":
            found += doubt_channel(column.signal.name, values, rate, quantity)
        known[column.signal.name], quantities[column.signal.name] = values, quantity
        figures = _measure(column.signal.values, rate)
        unit, channel = column.meaning.unit, channel_of(column, rig)
        summaries.append(ChannelSummary(group.name, column.signal.name, unit, channel, rate, *figures))
    parts = _longest_part(axis, known) if axis else known
    commands = {column.signal.name for column in columns if column.meaning.is_command}
    return summaries, [*found, *doubt_pairs(parts, rate, quantities, commands)]


def _doubt_rows(group: Group, clock: Clock | None) -> Iterator[Issue]:
    """Yield what is wrong with the time of a group, or that its rows are not over time."""
    if is_spectrum(group):
        yield doubt("spectrum", group.signals[0].name)
    if clock is None:
        return
    yield from (Issue("note", "time", said, clock.column) for said in clock.assumptions)
    if clock.axis is None:
        yield Issue("warning", "restart", f"{clock.column}: does not rise as a time does; no rate is taken from it")
    else:
        yield from doubt_time(clock.axis, clock.column)


def _longest_part(axis: Axis, channels: Mapping[str, Array]) -> dict[str, Array]:
    """Return the channels between two gaps that are furthest apart: a derivative across a gap means nothing."""
    edges = np.concatenate([[0], axis.breaks, [len(axis.times)]])
    longest = int(np.argmax(np.diff(edges)))
    return {name: values[edges[longest] : edges[longest + 1]] for name, values in channels.items()}


def _in_si(column: Column) -> tuple[Array, str | None]:
    """Return values in SI units with what they are, or as they stand and None where the unit is not known."""
    quantity, unit = column.meaning.quantity, column.meaning.unit
    if quantity not in SI_UNITS:
        return column.signal.values, None
    wanted = SI_UNITS[quantity]
    is_own_name = without_unit(column.signal.name, "") in {*SEAT_CHANNELS, *BENCH_CHANNELS}
    if not unit and is_own_name:
        return column.signal.values, quantity
    if not unit or not is_of(unit, quantity):
        # Without a unit its size is no reason for a doubt, but its shape is.
        return column.signal.values, quantity if quantity in ("displacement", "velocity") else None
    found = conversion(unit, wanted)
    return (column.signal.values if found == (1.0, 0.0) else found.factor * column.signal.values + found.zero), quantity


def _measure(column: Array, rate: float | None) -> tuple[int, float, float, float, float, float | None]:
    """Return how many values a channel has, the least and the greatest, the mean, the RMS and the noise."""
    values = column[np.isfinite(column)] if np.isnan(column).any() else column
    if not len(values):
        return 0, np.nan, np.nan, np.nan, np.nan, None
    noise = noise_of(values, rate) if np.ptp(values) > 0.0 else None
    rms = float(np.sqrt(values @ values / len(values)))
    return len(column), float(np.min(values)), float(np.max(values)), float(np.mean(values)), rms, noise


def _doubt_repeats(file: DataFile) -> Iterator[Issue]:
    """Yield rows that repeat the row before in every channel, where at least three vary from row to row."""
    for group in file.groups:
        steps = [np.diff(s.values) == 0.0 for s in group.signals if read_name(s.name).quantity != "time"]
        rows = np.flatnonzero(np.all(steps, axis=0)) + 1
        if sum(np.mean(same) < _RARE for same in steps) >= 3 and len(rows):
            repeat = f"repeat the row before in all channels, first row {rows[0]}; they were written twice"
            yield Issue("warning", "repeated_rows", f"{len(rows)} rows {repeat}")


def inspect_recording(folder: Path) -> Inspection:
    """Return what a recording holds.

    Raises:
        InputError: its header, a table or its nominal scenario cannot be read.
    """
    recording = load_recording(folder)
    rig, rate = recording.header.rig, recording.header.sample_rate
    channels: list[ChannelSummary] = []
    doubts: list[Issue] = []
    has_nominal = recording.nominal_file.exists()
    for run in recording.runs:
        table = recording.table(run)
        signals = tuple(Signal(name, CHANNELS[rig][name], values) for name, values in table.items())
        summaries, found = _group(Group(run, signals, rate), rig)
        channels += summaries
        doubts += place_in_run(run, [*found, *([] if has_nominal else doubt_relations(table, rate))])
    doubts = merge_issues(doubts, len(recording.runs))
    if has_nominal:
        doubts += examine(recording).issues
    else:
        text = f"{recording.header.nominal} is missing; signs, units and delays are not compared with a simulation"
        doubts.append(Issue("warning", "nominal", text))
    return Inspection(str(folder), "recording", channels, doubts)
