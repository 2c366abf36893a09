"""Which column is which channel: a map proposed from names and units, and what could not be matched.

A sign is never guessed. Where two columns fit a channel equally well, or a unit is not stated, the proposal leaves it
open and says what to write.
"""

import re
from collections.abc import Sequence
from typing import NamedTuple

from seatsim.importing.import_map import AxisMap, ChannelMap, ImportMap, Rig
from seatsim.importing.names import SI_UNITS, Meaning, is_of, read_name, without_unit
from seatsim.importing.signals import LISTED, DataFile, Group, Signal, check_is_history, find_clock, is_spectrum
from seatsim.recordings.recording import ACCELEROMETERS, CHANNELS
from seatsim.schema.text import name_some
from seatsim.schema.units import USUAL

_NEEDED = {"seat": ("floor_acceleration",), "damper_bench": ("displacement", "damper_force")}
_CHANNEL_OF = {
    "seat": {"acceleration": "{}_acceleration", "displacement": "suspension_displacement"},
    "damper_bench": {"displacement": "displacement", "velocity": "velocity", "voltage": "command_voltage"},
}
_OF_BOTH = {"force": "damper_force", "temperature": "damper_temperature"}
"""Channel that a quantity is, at a place, by rig and on any."""


class Column(NamedTuple):
    """A column with what its name says."""

    group: Group
    signal: Signal
    meaning: Meaning


def propose(files: Sequence[DataFile]) -> tuple[ImportMap, list[str]]:
    """Return the map of some files that belong to one rig, and sentences on what is open: without any it can be used.

    Raises:
        InputError: they hold nothing but spectra.
    """
    groups = [group for file in files for group in file.groups]
    if all(is_spectrum(group) for group in groups):
        check_is_history(groups[0], str(files[0].path))
    columns = [column for group in groups for column in read_columns(group)]
    chosen = _rig_of(columns)
    candidates = _candidates(columns, chosen)
    channels, open_ends = {}, []
    for name, unit in CHANNELS[chosen].items():
        if name in candidates:
            channels[name], problem = _entry(name, candidates[name], unit)
            open_ends.append(problem)
        elif name in _NEEDED[chosen]:
            open_ends.append(_missing(name, columns, channels))
            channels[name] = ChannelMap()
    if "command_voltage" in channels:
        open_ends.append("command_voltage: write actuator: {gain: 1.0}, with the commanded current per volt in A/V")
    holding = [column.group for held in candidates.values() for column in held]
    time, problem, has_gaps = _time([c for c in columns if any(c.group is group for group in holding)], len(files) == 1)
    found = ImportMap(channels, chosen, time, gaps="split" if has_gaps else None)
    return found, list(filter(None, [*open_ends, problem]))


def read_columns(group: Group) -> list[Column]:
    """Return the columns of a group with what their names say.

    Where names differ by x, y and z alone these are axes, so that x is no displacement and z no elevation.
    """
    names = {signal.name for signal in group.signals}
    columns = []
    for signal in group.signals:
        meaning = read_name(signal.name, signal.unit)
        if not signal.unit and meaning.quantity in ("displacement", "elevation") and names >= _along_axes(signal.name):
            meaning = meaning._replace(quantity=None, unit="")
        columns.append(Column(group, signal, meaning))
    return columns


def _along_axes(name: str) -> set[str]:
    """Return a name with x, y and z in place of the letter of an axis that stands alone in it."""
    parts = re.split(r"(?<![A-Za-z])[xyzXYZ](?![A-Za-z])", name)
    is_capital = any(letter in name for letter in "XYZ")
    return {letter.join(parts) for letter in ("XYZ" if is_capital else "xyz")} if len(parts) == 2 else {""}


def _rig_of(columns: Sequence[Column]) -> Rig:
    """Return the rig that the columns are of: a bench has force and displacement, and no acceleration of a place."""
    quantities = {column.meaning.quantity for column in columns}
    is_of_seat = any(_named_channel(column, "seat") in ACCELEROMETERS for column in columns)
    return "damper_bench" if {"displacement", "force"} <= quantities and not is_of_seat else "seat"


def channel_of(column: Column, rig: Rig) -> str | None:
    """Return the channel that a column may be, None where its name does not say so, or its unit contradicts."""
    return None if column.meaning.is_contradicted else _named_channel(column, rig)


def _named_channel(column: Column, rig: Rig) -> str | None:
    meaning, place = column.meaning, column.meaning.place
    exact = without_unit(column.signal.name, meaning.unit)
    if exact in CHANNELS[rig]:
        return exact
    if meaning.quantity == "current":
        return "current_command" if meaning.is_command else "coil_current"
    if meaning.is_command and meaning.quantity in ("force", "displacement", "velocity"):
        return None
    # A force or a temperature of the seat or the floor is not the damper's, unless it says so.
    is_elsewhere = {
        "force": place is not None and not meaning.is_damper,
        "temperature": place is not None and not meaning.is_damper,
        "acceleration": place is None or meaning.is_lateral,
        "displacement": place == "floor" and rig == "seat",
    }
    quantity = meaning.quantity or ""
    channel = (_CHANNEL_OF[rig] | _OF_BOTH).get(quantity, "").format(place)
    return None if is_elsewhere.get(quantity) else channel or None


def _candidates(columns: Sequence[Column], rig: Rig) -> dict[str, list[Column]]:
    """Return the columns that each channel may be; those of another unit only where there are no others."""
    found: dict[str, list[Column]] = {}
    for column in sorted(columns, key=lambda each: each.meaning.is_contradicted):
        channel = _named_channel(column, rig)
        if channel is not None and (channel not in found or not column.meaning.is_contradicted):
            found.setdefault(channel, []).append(column)
    return found


def _entry(name: str, candidates: Sequence[Column], unit: str) -> tuple[ChannelMap, str]:
    """Return the entry of a channel, and what is open in it."""
    exact = [each for each in candidates if without_unit(each.signal.name, each.meaning.unit) == name]
    fitting = exact or list(candidates)
    names = list(dict.fromkeys(each.signal.name for each in fitting))
    first, examples = fitting[0], " or ".join(USUAL[unit][:3])
    quantity = next(name for name, each in SI_UNITS.items() if each == unit)
    stated = first.meaning.unit if first.meaning.unit and is_of(first.meaning.unit, quantity) else ""
    if not stated and without_unit(first.signal.name, "") == name:
        stated = unit
    entry = ChannelMap(first.signal.name, stated or None)
    if len(names) > 1 and not exact:
        return entry, f"{name}: {name_some(names, LISTED)} fit equally well; keep one as its column"
    if first.meaning.is_contradicted:
        seen = f"'{first.signal.name}' is stated in {first.meaning.unit}, which is no unit of it"
        return entry, f"{name}: {seen}; write unit, such as {examples}, with scale and offset, or leave it out"
    if not stated:
        seen = f"the file states no unit of '{first.signal.name}'"
        return entry, f"{name}: {seen}; write it as unit, such as {examples}"
    return entry, ""


def _missing(name: str, columns: Sequence[Column], channels: dict[str, ChannelMap]) -> str:
    taken = {entry.column for entry in channels.values()}
    names = dict.fromkeys(column.signal.name for column in columns if column.meaning.quantity != "time")
    left = [each for each in names if each not in taken]
    listed = ", ".join(left[:LISTED]) + (", ..." if len(left) > LISTED else "") or "none"
    return f"{name}: no column is it by name; write channels: {{{name}: {{column: ..., unit: ...}}}}; left are {listed}"


def _time(columns: Sequence[Column], is_one_file: bool) -> tuple[AxisMap | None, str, bool]:
    """Return the column of time, what is open about it, and whether it has gaps.

    Formats that state their rate need no column.
    """
    clock = next((found for column in columns if (found := find_clock(column.group))), None)
    if clock is None:
        problem = "time: no column holds the time; write sample_rate: in Hz, or time: {column: ..., unit: s}"
        return None, "" if all(column.group.rate for column in columns) else problem, False
    has_gaps = clock.axis is not None and len(clock.axis.breaks) > 0 and is_one_file
    problem = f"time: {clock.open}; write time: {{column: {clock.column}, unit: ms}} or s" if clock.open else ""
    return AxisMap(clock.column, clock.unit), problem, has_gaps
