"""From files and a map to runs: groups on their clocks, channels in SI units, and one time base for all of them."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from seatsim.importing.alignment import HELD, Channel, describe_offset, estimate_offset, hold, resample
from seatsim.importing.channels import SHORTEST_RUN, Clocked, clock_groups, make_channel, no_column, split_at_gaps
from seatsim.importing.import_map import ImportMap
from seatsim.importing.signals import DataFile
from seatsim.recordings.quality.issue import Issue, place_in_run
from seatsim.recordings.quality.relations import doubt_relations
from seatsim.recordings.recording import CHANNELS
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.units import conversion

_SAME_RATE = 1e-4
"""Fraction by which rates differ that are one rate by the clocks of two loggers: nothing is said of it."""


class Assembled(NamedTuple):
    """Tables of the runs at one rate in Hz, the map as used, what was done in sentences, and doubts about the data.

    A table has channels in SI units, shape (N,) each, on one time base.
    """

    runs: dict[str, dict[str, Array]]
    rate: float
    map: ImportMap
    notes: list[str]
    doubts: list[Issue]


def assemble(files: Sequence[DataFile], stated: ImportMap) -> Assembled:
    """Return the runs that a map makes of files.

    Raises:
        InputError: a column is not there, a unit is not one of its channel, there is no time, rows are missing and the
            map says nothing about them, or nothing is left.
    """
    if "command_voltage" in stated.channels and stated.actuator is None:
        raise InputError("channels.command_voltage: needs actuator: {gain: 1.0}, the commanded current per volt in A/V")
    doubts, notes, parts = list[Issue](), list[str](), list[tuple[str, list[Clocked]]]()
    for name, members in _group_runs(files, stated):
        parts += split_at_gaps(name, clock_groups(members, stated, doubts), stated, notes)
    rate = stated.resample or max(each.axis.rate for _, clocked in parts for each in clocked)
    runs, align = dict[str, dict[str, Array]](), dict(stated.align)
    for name, clocked in parts:
        runs[name] = _tabulate(name, _use_channels(name, clocked, stated, align, doubts, notes), stated, rate, notes)
    return Assembled(runs, rate, stated._replace(align=align), list(dict.fromkeys(notes)), doubts)


def doubt_runs(assembled: Assembled) -> list[Issue]:
    """Return what the channels of each run show of each other, which an examination would find too."""
    found = {name: doubt_relations(table, assembled.rate) for name, table in assembled.runs.items()}
    return [each for name, doubts in found.items() for each in place_in_run(name, doubts)]


def _group_runs(files: Sequence[DataFile], stated: ImportMap) -> list[tuple[str, list[DataFile]]]:
    """Return the files of every run: as the map states them, else each by itself, or all where none is complete."""
    by_name = {file.path.name: file for file in files}
    if stated.runs:
        return [(run, [by_name[name] for name in names]) for run, names in stated.runs.items()]
    needed = {channel.column for channel in stated.channels.values()} - {None}
    are_complete = all(needed <= {s.name for group in file.groups for s in group.signals} for file in files)
    if len(files) == 1 or not are_complete:
        return [("run-a", list(files))]
    return [(file.path.name.split(".")[0], [file]) for file in files]


def _use_channels(
    run: str,
    clocked: Sequence[Clocked],
    stated: ImportMap,
    align: dict[str, float],
    doubts: list[Issue],
    notes: list[str],
) -> dict[str, Channel]:
    """Return the channels of a run, each taken from the first group that has its column, on the clock of the first one.

    The times of each group move by as much as is stated, as is estimated (put into `align`), or not at all. Groups of
    one file share its clock, so that what one of them lags behind another is not taken for an offset.
    """
    by_group: dict[str, dict[str, Channel]] = {each.label: {} for each in clocked}
    taken_from: dict[str, Clocked] = {}
    for name, entry in stated.channels.items():
        if entry.column is None:
            continue
        holders = [each for each in clocked if each.group.find(entry.column) and (entry.group or "") in each.label]
        if not holders:
            raise no_column(name, entry.column, entry.group, clocked)
        for each in holders:
            is_taken = each is holders[0]
            channel, found = make_channel(name, entry, each, CHANNELS[stated.rig][name], notes if is_taken else [])
            by_group[each.label][name] = channel
            doubts += place_in_run(run, found) if is_taken else []
        taken_from[name] = holders[0]
    reference = next(iter(taken_from.values()))
    for label, file in {each.label: each.file for each in taken_from.values()}.items():
        if label not in align and file != reference.file:
            offset = estimate_offset(by_group[reference.label], by_group[label])
            notes.append(describe_offset(label, reference.label, offset))
            if offset is not None:
                align[label] = offset.seconds
    taken = {name: (by_group[each.label][name], align.get(each.label, 0.0)) for name, each in taken_from.items()}
    return {name: channel._replace(start=channel.start + seconds) for name, (channel, seconds) in taken.items()}


def _tabulate(
    run: str, held: Mapping[str, Channel], stated: ImportMap, rate: float, notes: list[str]
) -> dict[str, Array]:
    """Return the table of a run on one time base, over the time that all its channels have in common."""
    begin = max(each.start for each in held.values())
    end = min(each.start + (len(each.values) - 1) / each.rate for each in held.values())
    if end - begin < SHORTEST_RUN:
        seen = f"its channels have {max(0.0, end - begin):.3g} s in common by their times, at {rate:.6g} Hz"
        remedy = "check the rate and the unit under time, or state align of its files"
        raise InputError(f"{run}: {seen}; a run needs {SHORTEST_RUN:g} s: {remedy}")
    times = begin + np.arange(int((end - begin) * rate + 1e-6) + 1) / rate
    table = {}
    for name, entry in stated.channels.items():
        unit = CHANNELS[stated.rig][name]
        if entry.value is not None:
            found = conversion(entry.unit or unit, unit)
            table[name] = np.full(len(times), found.factor * entry.value + found.zero)
            continue
        each = held[name]
        how, take = ("each value held", hold) if name in HELD else ("band-limited", partial(resample, new_rate=rate))
        if abs(each.rate / rate - 1.0) > _SAME_RATE:
            notes.append(f"{name}: resampled from {each.rate:.6g} to {rate:.6g} Hz, {how}")
        table[name] = take(each.values, each.start - entry.delay, each.rate, times)
    return table
