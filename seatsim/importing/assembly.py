"""From files and a map to runs: groups on their clocks, channels in SI units, and one time base for all of them.

A group has the time of a column, of its format, or of a stated rate; it makes a run, or runs between its gaps. Channels
are converted to SI units and corrected.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from seatsim.importing.alignment import Channel, describe_offset, estimate_offset, evened, hold, resample
from seatsim.importing.doubts import doubt_channel, doubt_time
from seatsim.importing.import_map import PRIMITIVE, AxisMap, ChannelMap, ImportMap
from seatsim.importing.names import quantity_of
from seatsim.importing.signals import LISTED, Axis, DataFile, Group, Signal, check_is_history, find_clock, measured_axis
from seatsim.recordings.quality.issue import Issue, place_in_run
from seatsim.recordings.quality.relations import doubt_relations
from seatsim.recordings.recording import CHANNELS, COMMANDS
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, nearest, placed
from seatsim.schema.text import name_some
from seatsim.schema.units import DIMENSIONS, conversion

_SHORTEST_RUN = 1.0
"""s; parts between gaps that are shorter make no run."""
_SLOWER = 0.9
"""Share of the rows of its table below which a channel has a rate of its own."""


class _Clocked(NamedTuple):
    """A group on its own time base: the name of its file, its own label, and its axis in s."""

    file: str
    label: str
    group: Group
    axis: Axis


def _clock_groups(files: Sequence[DataFile], stated: ImportMap, doubts: list[Issue]) -> list[_Clocked]:
    """Return the groups of some files that hold a column of the map, each with its time.

    Raises:
        InputError: the time of a group is neither stated nor to be found.
    """
    every = [(file, group) for file in files for group in file.groups]
    used = [each for each in every if any(signal.name in stated.columns for signal in each[1].signals)]
    return [_clock(file, group, stated, doubts) for file, group in used or every]


def _clock(file: DataFile, group: Group, stated: ImportMap, doubts: list[Issue]) -> _Clocked:
    """Return a group with its time: of the column that the map names, of the format, or at the stated rate."""
    label = f"{file.path.name}, {group.name}" if group.name and len(file.groups) > 1 else file.path.name
    check_is_history(group, str(file.path))
    rate = stated.sample_rate or group.rate
    time = _time_column(group, stated, label, doubts)
    if time is not None:
        group, axis = _timed(label, group, time, stated.sample_rate, doubts)
        return _Clocked(file.path.name, label, group, axis)
    if rate is not None:
        return _Clocked(file.path.name, label, group, Axis((group.start or 0.0) + np.arange(group.rows) / rate, rate))
    names = [signal.name for signal in group.signals]
    lacking = f"no column '{stated.time.column}'{nearest(stated.time.column, names)}" if stated.time else "no rate"
    remedy = "write sample_rate: or time: {column: ...} in the map"
    raise InputError(f"{file.path}: states {lacking}; {remedy}; columns are {name_some(names, LISTED)}")


def _time_column(group: Group, stated: ImportMap, label: str, doubts: list[Issue]) -> AxisMap | None:
    """Return the column of time that the map names, else the one that is found: other loggers name it otherwise."""
    if stated.time is not None and group.find(stated.time.column) is not None:
        return stated.time
    clock = find_clock(group)
    if clock is None or (stated.sample_rate is not None and stated.time is None):
        return None
    doubts += [Issue("note", "time", f"{label}: {said}") for said in clock.assumptions]
    return AxisMap(clock.column, clock.unit)


def _timed(label: str, group: Group, time: AxisMap, rate: float | None, doubts: list[Issue]) -> tuple[Group, Axis]:
    """Return a group without the rows that have no time, and the times of the others.

    Of stamps that are as coarse as the rows, or coarser, a stated rate takes the place.
    """
    times = next(signal.values for signal in group.signals if signal.name == time.column)
    there = np.isfinite(times)
    group = group.take(there)
    axis = measured_axis(conversion(time.unit or "s", DIMENSIONS["time"]).factor * times[there])
    if axis is None:
        raise InputError(f"{label}: column '{time.column}' does not rise as a time does; name another one under time")
    if axis.resolution and rate is not None:
        return group, Axis(axis.times[0] + np.arange(group.rows) / rate, rate)
    found = list(doubt_time(axis, f"{label}, {time.column}"))
    if axis.resolution and not axis.is_even:
        raise InputError(found[-1].sentence)
    doubts += found
    return group, axis


def _split_at_gaps(
    name: str, clocked: list[_Clocked], stated: ImportMap, notes: list[str]
) -> list[tuple[str, list[_Clocked]]]:
    """Return a run, or the runs between its gaps, as the map says."""
    broken = next((each for each in clocked if len(each.axis.breaks)), None)
    if broken is None:
        return [(name, clocked)]
    if stated.gaps is None or len(clocked) > 1:
        said = next(doubt_time(broken.axis, broken.label)).sentence
        of_one = "write gaps: split in the map, which makes runs of the parts"
        raise InputError(f"{said}; {of_one if len(clocked) == 1 else 'cut the files of the run there'}")
    return _parts(name, broken, notes)


def _parts(name: str, broken: _Clocked, notes: list[str]) -> list[tuple[str, list[_Clocked]]]:
    """Return the runs between the gaps of a group; a sentence names those that are too short to be one."""
    parts: list[tuple[str, list[_Clocked]]] = []
    short: list[str] = []
    for begin, end in pairwise([0, *broken.axis.breaks.tolist(), len(broken.axis.times)]):
        lasts = (end - begin - 1) / broken.axis.rate
        if lasts < _SHORTEST_RUN:
            short.append(f"{lasts:.3g} s from {broken.axis.times[begin]:.6g} s on")
        else:
            axis = Axis(broken.axis.times[begin:end], broken.axis.rate, broken.axis.is_even)
            part = broken._replace(group=broken.group.take(slice(begin, end)), axis=axis)
            parts.append((f"{name}-{len(parts) + 1}", [part]))
    if not parts:
        raise InputError(f"{broken.label}: no part between its gaps lasts {_SHORTEST_RUN:g} s; nothing is left")
    if short:
        notes.append(f"{broken.label}: parts of less than {_SHORTEST_RUN:g} s are left out: {name_some(short, LISTED)}")
    return parts


def _make_channel(
    name: str, entry: ChannelMap, clocked: _Clocked, wanted: str, notes: list[str]
) -> tuple[Channel, list[Issue]]:
    """Return a channel in the wanted unit on the even time base of its group, with the doubts that the map leaves.

    Raises:
        InputError: a column is not there, a unit is not stated or wrong, or rows hold no number.
    """
    columns = (column for column in (entry.column, entry.minus) if column is not None)
    first, *minus = (_find_column(name, entry, column, clocked) for column in columns)
    values = first.values - minus[0].values if minus else first.values
    values = _in_si(name, entry, values, first.unit, wanted)
    rate = clocked.axis.rate
    # What is still to be differentiated is a position or a velocity.
    quantity = {0: quantity_of(name), 1: None, 2: "displacement"}[entry.differentiate]
    mended = {"gravity": entry.remove_mean, "offset": entry.remove_mean, "missing": entry.fill}
    doubts = [issue for issue in doubt_channel(name, values, rate, quantity) if not mended.get(issue.kind)]
    channel = _evened(name, *_filled(name, entry, values, clocked, notes), clocked.axis)
    return channel._replace(values=_corrected(name, channel.values, entry, channel.rate, notes)), doubts


def _no_column(name: str, column: str | None, group: str | None, clocked: Sequence[_Clocked]) -> InputError:
    """Return the error of a column that no group holds."""
    names = list(dict.fromkeys(signal.name for each in clocked for signal in each.group.signals))
    where = f" of group '{group}'" if group else ""
    hint = nearest(column, names)
    return InputError(f"channels.{name}: no column '{column}'{where}{hint}; columns are {name_some(names, LISTED)}")


def _find_column(name: str, entry: ChannelMap, column: str, clocked: _Clocked) -> Signal:
    signal = clocked.group.find(column)
    if signal is None:
        raise _no_column(name, column, entry.group, [clocked])
    return signal


def _in_si(name: str, entry: ChannelMap, values: Array, stated: str, wanted: str) -> Array:
    base = PRIMITIVE[wanted, entry.differentiate] if entry.differentiate else wanted
    unit = entry.unit or stated or (base if entry.column == name else "")
    if not unit:
        problem = f"channels.{name}: neither the map nor the file states the unit of '{entry.column}'; write unit"
        raise InputError(problem)
    with placed(f"channels.{name}.unit"):
        found = conversion(unit, base)
    return found.factor * (entry.sign * entry.scale * values + entry.offset) + found.zero


def _filled(name: str, entry: ChannelMap, values: Array, clocked: _Clocked, notes: list[str]) -> tuple[Array, Array]:
    """Return the rows that hold a number, with their times; inner ones that do not are interpolated if stated.

    A channel that is slower than its table holds a number in every n-th row; it keeps these as its own rows.

    Raises:
        InputError: rows hold no number and the map does not say `fill`.
    """
    there = np.flatnonzero(np.isfinite(values))
    if len(there) == len(values):
        return values, clocked.axis.times
    if len(there) < 2:
        raise InputError(f"{clocked.label}, {name}: column '{entry.column}' holds no numbers")
    every = np.diff(there)
    if every[0] > 1 and np.all(every == every[0]):
        return values[there], clocked.axis.times[there]
    inner = slice(int(there[0]), int(there[-1]) + 1)
    missing = int(np.sum(np.isnan(values[inner])))
    if missing and not entry.fill:
        at = f"the first after {clocked.axis.times[there[np.argmax(every > 1)]]:.5g} s"
        seen = f"{missing} rows hold no number, {at}; fill: true in the map interpolates them"
        raise InputError(f"{clocked.label}, {name}: {seen}")
    if missing:
        notes.append(f"{name}: {missing} rows that held no number are interpolated")
    rows = np.arange(len(values))
    return np.interp(rows, there, values[there])[inner], clocked.axis.times[inner]


def _evened(name: str, values: Array, times: Array, axis: Axis) -> Channel:
    """Return values on an even time base, with their own rate."""
    start, rate = float(times[0]), axis.rate
    share = (axis.times[-1] - axis.times[0]) / (times[-1] - start) * (len(times) - 1) / (len(axis.times) - 1)
    if share < _SLOWER:  # a slow channel in a fast table
        rate *= float(share)
    if axis.is_even:
        return Channel(values, start, rate)
    grid = start + np.arange(int((times[-1] - times[0]) * rate + 1e-6) + 1) / rate
    return Channel(evened(name, values, times, grid), start, rate)


def _corrected(name: str, values: Array, entry: ChannelMap, rate: float, notes: list[str]) -> Array:
    """Return values differentiated and without their mean, as the map says."""
    for _ in range(entry.differentiate):
        values = np.gradient(values, 1.0 / rate)
    if not entry.remove_mean:
        return values
    notes.append(f"{name}: its mean of {float(np.mean(values)):.4g} is taken out")
    return values - float(np.mean(values))


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
    doubts, notes, parts = list[Issue](), list[str](), list[tuple[str, list[_Clocked]]]()
    for name, members in _group_runs(files, stated):
        parts += _split_at_gaps(name, _clock_groups(members, stated, doubts), stated, notes)
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
    clocked: Sequence[_Clocked],
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
    taken_from: dict[str, _Clocked] = {}
    for name, entry in stated.channels.items():
        if entry.column is None:
            continue
        holders = [each for each in clocked if each.group.find(entry.column) and (entry.group or "") in each.label]
        if not holders:
            raise _no_column(name, entry.column, entry.group, clocked)
        for each in holders:
            is_taken = each is holders[0]
            channel, found = _make_channel(name, entry, each, CHANNELS[stated.rig][name], notes if is_taken else [])
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
    if end - begin < _SHORTEST_RUN:
        seen = f"its channels have {max(0.0, end - begin):.3g} s in common by their times, at {rate:.6g} Hz"
        remedy = "check the rate and the unit under time, or state align of its files"
        raise InputError(f"{run}: {seen}; a run needs {_SHORTEST_RUN:g} s: {remedy}")
    times = begin + np.arange(int((end - begin) * rate + 1e-6) + 1) / rate
    table = {}
    for name, entry in stated.channels.items():
        unit = CHANNELS[stated.rig][name]
        if entry.value is not None:
            found = conversion(entry.unit or unit, unit)
            table[name] = np.full(len(times), found.factor * entry.value + found.zero)
            continue
        each = held[name]
        take = hold if name in COMMANDS else partial(resample, new_rate=rate)
        if abs(each.rate / rate - 1.0) > _SAME_RATE:
            how = "each value held" if take is hold else "band-limited"
            notes.append(f"{name}: resampled from {each.rate:.6g} to {rate:.6g} Hz, {how}")
        table[name] = take(each.values, each.start - entry.delay, each.rate, times)
    return table
