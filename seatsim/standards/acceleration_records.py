"""Measured accelerations of any file that `seatsim.importing` reads, or of a recording, in SI units, and their axes."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.importing.doubts import doubt_time
from seatsim.importing.matching import Column, read_columns
from seatsim.importing.names import is_of, read_name, unit_of_name, without_unit
from seatsim.importing.readers.reading import read_file
from seatsim.importing.signals import Clock, DataFile, Group, Signal, check_is_history, find_clock
from seatsim.metrics.exposure import DIRECTIONS
from seatsim.recordings.recording import HEADER, load_recording
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, nearest, placed
from seatsim.schema.units import conversion, is_unit

_ALIASES = {
    **{axis: (*(f"{a}_{axis}" for a in ("acc", "acceleration", "seat")), axis) for axis in ("x", "y", "z")},
    "floor.z": ("floor_acceleration", "floor_z"),
}
"""Columns that are taken for an axis, without the unit at their end."""
_CHANNELS = {"z": "driver_acceleration", "floor.z": "floor_acceleration"}
"""Channel of a recording that stands for an axis."""
_PLACES = {"x": "driver", "y": "driver", "z": "driver", "floor.x": "floor", "floor.y": "floor", "floor.z": "floor"}
"""Where an axis is measured, as `seatsim.importing.names` calls it."""


def _fit_axes(signals: Iterable[Signal]) -> dict[str, list[str]]:
    """Return by axis the columns that fit it equally well: those of usual names, else those whose words mean it."""
    columns = [each for each in read_columns(Group("", tuple(signals))) if _may_be_acceleration(each)]
    plain = {without_unit(each.signal.name, each.meaning.unit): each.signal.name for each in columns}
    found = {}
    for axis, place in _PLACES.items():
        usual = [plain[name] for name in _ALIASES.get(axis, ()) if name in plain][:1]
        exact = [each.signal.name for each in columns if each.signal.name == _CHANNELS.get(axis)]
        if names := usual or exact or _find_meant(axis[-1], place, columns):
            found[axis] = names
    return found


def choose_axes(name: str, columns: Mapping[str, Signal], said: Sequence[str] = ()) -> dict[str, str]:
    """Return the column of each axis that is found; several that may be one of the floor are none.

    Raises:
        InputError: no column fits, or several fit an axis of the person; it ends with what was `said` of the file.
    """
    fitting = _fit_axes(columns.values())
    for axis, names in fitting.items():
        if len(names) > 1 and axis in DIRECTIONS:
            problem = f"{name}: {' and '.join(names)} may be axis {axis}; name every axis by --channel AXIS=COLUMN"
            raise InputError(problem)
    found = {axis: names[0] for axis, names in fitting.items() if len(names) == 1}
    if not found:
        there = f"name them with --channel AXIS=COLUMN; columns: {', '.join(columns) or 'none'}"
        raise InputError("; ".join([f"{name}: no column has a usual name", there, *said]))
    return found


def _may_be_acceleration(column: Column) -> bool:
    unit = column.meaning.unit
    return not unit or is_of(unit, "acceleration") or not is_unit(unit)


def _find_meant(letter: str, place: str, columns: Sequence[Column]) -> list[str]:
    """Return the accelerations along an axis at a place, for the person else those of no place.

    One that names a place and no axis is vertical.
    """
    found: dict[str | None, list[str]] = {}
    for column in columns:
        meaning = column.meaning
        is_along = meaning.axis == letter or (letter == "z" and meaning.axis is None and meaning.place is not None)
        if meaning.quantity == "acceleration" and is_along and not meaning.is_command:
            found.setdefault(meaning.place, []).append(column.signal.name)
    return found.get(place) or (found.get(None, []) if place == "driver" else [])


_QUANTITIES = ("acceleration", "angular_acceleration")
"""What the columns hold whose units are read off the ends of their names."""
_CONTRARY = 0.01
"""Fraction by which a stated rate differs from that of the times, from which it is said."""


class AccelerationRecord(NamedTuple):
    """One uninterrupted record: columns as they stand in their file, at `sample_rate` Hz; units are empty if unknown.

    `unit` is that of the columns whose unit the file does not state, None where nobody has stated it. `notes` are
    sentences on what was assumed of the file, or left out of it.
    """

    name: str
    sample_rate: float
    columns: Mapping[str, Signal]
    unit: str | None = None
    notes: tuple[str, ...] = ()

    def values(self, name: str, wanted: str) -> Array:
        """Return a column in a unit, which it is taken to be in where none is stated, shape (N,).

        Raises:
            InputError: there is no such column, its unit is of something else, or a row of it is no finite number.
        """
        if name not in self.columns:
            hint = nearest(name, self.columns)
            raise InputError(f"{self.name}: no column '{name}'{hint}; columns of numbers: {', '.join(self.columns)}")
        signal = self.columns[name]
        bad = np.flatnonzero(~np.isfinite(signal.values))
        if bad.size:
            raise InputError(f"{self.name}, row {bad[0] + 1}, {name}: not a finite number; {bad.size} rows are not")
        with placed(f"{self.name}, {name}"):
            found = conversion(signal.unit or self.unit or wanted, wanted)
        return found.factor * signal.values + found.zero

    def is_unitless(self, name: str) -> bool:
        """Say whether nobody has stated the unit of a column."""
        return not self.columns[name].unit and self.unit is None


def load_accelerations(
    path: str | Path, rate: float | None = None, unit: str | None = None, wanted: Collection[str] = ()
) -> list[AccelerationRecord]:
    """Return the record of a file, or the runs of a recording.

    The sample rate of a file is `rate` in Hz, else that of its column of time, else what its format states. Of a file
    with several groups the one that holds the `wanted` columns counts, else the one with most accelerations. `unit` is
    that of columns for which none is stated; None: SI.

    Raises:
        InputError: nothing is there, it cannot be read, the unit is none, or the rows are not evenly spaced.
    """
    path = Path(path)
    if (path / HEADER).exists():
        return _recorded(path)
    if rate is not None and not 0 < rate < np.inf:
        raise InputError(f"a sample rate of {rate:g} Hz is not permitted; it must be above 0")
    if path.is_dir():
        raise InputError(f"{path}: holds no {HEADER}; give a file of measured accelerations or a recording")
    file = read_file(path)
    group = _choose_group(file, wanted)
    check_is_history(group, str(path))
    clock = find_clock(group)
    columns = {each.name: each._replace(unit=_unit(each)) for each in group.signals if not _is_time(each, clock)}
    sample_rate, notes = _rate(group, clock, path, rate, file.notes)
    notes = [*file.notes, *notes, *([] if wanted else _say_other_groups(file, group))]
    return [AccelerationRecord(path.name, sample_rate, columns, unit, tuple(notes))]


def _choose_group(file: DataFile, wanted: Collection[str]) -> Group:
    holding = [each for each in file.groups if {*wanted} <= {signal.name for signal in each.signals}]
    return max(holding or file.groups, key=_count_axes)


def _count_axes(group: Group) -> tuple[int, int]:
    """Return how many axes of the person a group holds, and how many of any place."""
    found = _fit_axes(group.signals)
    return len({*found} & {*DIRECTIONS}), len(found)


def _say_other_groups(file: DataFile, chosen: Group) -> list[str]:
    """Return a sentence on accelerations of groups that are not evaluated.

    Raises:
        InputError: they are along an axis of the person that the chosen group lacks: the total would be too small.
    """
    here = _fit_axes(chosen.signals)
    others = {each.name: _fit_axes(each.signals) for each in file.groups if each is not chosen}
    for name, found in others.items():
        lacking = [axis for axis in found if axis in DIRECTIONS and axis not in here]
        if lacking:
            raise InputError(
                f"{file.path}: {found[lacking[0]][0]} of '{name}' has another time than {', '.join(here)} of"
                f" '{chosen.name}'; seatsim import puts them on one, --channel AXIS=COLUMN takes columns of one alone"
            )
    left_out = ", ".join(f"'{name}'" for name, found in others.items() if found)
    return [f"'{chosen.name}' is evaluated alone; accelerations stand in {left_out}, too"] if left_out else []


def _unit(signal: Signal) -> str:
    """Return the unit of a column that its file states, or the end of its name."""
    return signal.unit or next((found for each in _QUANTITIES if (found := unit_of_name(signal.name, each))), "")


def _is_time(signal: Signal, clock: Clock | None) -> bool:
    is_clock = clock is not None and signal.name == clock.column
    return is_clock or read_name(signal.name, signal.unit).quantity == "time"


def _rate(
    group: Group, clock: Clock | None, path: Path, stated: float | None, said: Sequence[str]
) -> tuple[float, list[str]]:
    """Return the sample rate of a group in Hz, and what is to be said of it.

    It is the stated one, else that of its time, else that of its format. An error ends with what the reader has `said`
    of the file.
    """
    axis = clock.axis if clock else None
    if stated is not None:
        found = axis.rate if axis and clock and clock.unit and axis.is_even else group.rate
        is_contrary = found is not None and abs(stated / found - 1.0) > _CONTRARY
        notes = [f"the file states {found:.6g} Hz; the stated {stated:g} Hz is taken"] if is_contrary else []
        lost = doubt_time(axis, clock.column) if axis and clock and len(axis.breaks) else ()
        return stated, [*notes, *(issue.sentence for issue in lost)]
    if clock is None and group.rate is not None:
        return group.rate, []
    if clock is None:
        lacking = "no column holds the time (time_s, time_ms, t), and no rate is stated; give --rate"
        raise InputError("; ".join([f"{path}: {lacking}", *said]))
    if axis is None or clock.open:
        problem = f"{path}: {clock.open}; give --rate, or state its unit under time in the map of seatsim import"
        raise InputError(problem)
    doubts = [issue.sentence for issue in doubt_time(axis, clock.column)]
    if len(axis.breaks) or not axis.is_even:
        problem = f"{path}: {clock.column} does not rise in even steps ({'; '.join(doubts)})"
        raise InputError(f"{problem}; seatsim import resamples such files")
    return axis.rate, [*clock.assumptions, *doubts]


def _recorded(folder: Path) -> list[AccelerationRecord]:
    """Return the runs of a recording of a seat."""
    recording = load_recording(folder)
    units = {name: entry.unit for name, entry in recording.channels.items() if name.endswith("_acceleration")}
    if not units:
        raise InputError(f"{folder / HEADER}: records no acceleration; it has {', '.join(recording.channels)}")
    tables = {run: recording.table(run) for run in recording.runs}
    found = []
    for run, table in tables.items():
        signals = {name: Signal(name, unit, table[name]) for name, unit in units.items()}
        found.append(AccelerationRecord(run, recording.header.sample_rate, signals))
    return found
