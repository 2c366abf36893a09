"""Measured accelerations of any file that `seatsim.importing` reads, or of the runs of a recording, in SI units."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.importing.clocks import read_clock
from seatsim.importing.matching import Column, channel_of
from seatsim.importing.names import read_name, unit_of_name, without_unit
from seatsim.importing.readers.reading import read_file
from seatsim.importing.signals import Array, DataFile, Group, Signal
from seatsim.recordings.bench_columns import constants
from seatsim.recordings.bench_tables import stem
from seatsim.recordings.recording import HEADER, load_recording
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.units import conversion
from seatsim.schema.yaml_source import Source

QUANTITIES = ("acceleration", "angular_acceleration")
"""What the columns hold whose units are read off the ends of their names."""
ALIASES = {
    **{axis: (axis, *(f"{a}_{axis}" for a in ("acc", "acceleration", "seat"))) for axis in ("x", "y", "z")},
    "floor.z": ("floor_acceleration", "floor_z"),
}
"""Columns that are taken for an axis where no channel is named, without the unit at their end."""
CHANNELS = {"z": "driver_acceleration", "floor.z": "floor_acceleration"}
"""Channel of a recording that stands for an axis; so does the one column whose name means it."""


class AccelerationRecord(NamedTuple):
    """One uninterrupted record: columns as they stand in their file, at `sample_rate` Hz; units are empty if unknown.

    `unit` is that of the columns whose unit the file does not state, None where nobody has stated it.
    """

    name: str
    sample_rate: float
    columns: Mapping[str, Signal]
    unit: str | None = None

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
        try:
            found = conversion(signal.unit or self.unit or wanted, wanted)
        except InputError as error:
            raise InputError(f"{self.name}, {name}: {error}") from error
        return found.factor * signal.values + found.zero

    def is_unitless(self, name: str) -> bool:
        """Say whether nobody has stated the unit of a column."""
        return not self.columns[name].unit and self.unit is None


def load_accelerations(
    path: str | Path, rate: float | None = None, unit: str | None = None, wanted: Collection[str] = ()
) -> list[AccelerationRecord]:
    """Return the record of a file, or the runs of a recording.

    The sample rate of a file is `rate` in Hz, else that of its column of time, else what its format or a sidecar of
    the same name states (`sample_rate_Hz`). Of a file with several groups the one that holds the `wanted` columns
    counts, else the one with most accelerations. `unit` is that of columns for which none is stated; None: SI.

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
    columns = {each.name: each._replace(unit=_unit(each)) for each in group.signals if not _is_time(each)}
    return [AccelerationRecord(path.name, rate or _rate(group, path), columns, unit)]


def find_axes(record: AccelerationRecord) -> dict[str, str]:
    """Return the columns of a record that have usual names, by axis.

    Raises:
        InputError: there are none.
    """
    plain = {without_unit(name, signal.unit): name for name, signal in record.columns.items()}
    found = {axis: plain[name] for axis, names in ALIASES.items() for name in names if name in plain}
    for axis, channel in CHANNELS.items():
        meant = [signal.name for signal in record.columns.values() if _channel(signal) == channel]
        if channel in meant or len(meant) == 1:
            found.setdefault(axis, channel if channel in meant else meant[0])
    if not found:
        there = ", ".join(record.columns)
        raise InputError(
            f"{record.name}: no column has a usual name; name them with --channel AXIS=COLUMN; columns: {there}"
        )
    return found


def _choose_group(file: DataFile, wanted: Collection[str]) -> Group:
    holding = [each for each in file.groups if {*wanted} <= {signal.name for signal in each.signals}]
    return max(holding or file.groups, key=lambda each: sum(_channel(signal) is not None for signal in each.signals))


def _channel(signal: Signal) -> str | None:
    """Return the channel of a seat that a column is by its name."""
    return channel_of(Column(Group("", (signal,)), signal, read_name(signal.name, signal.unit)), "seat")


def _unit(signal: Signal) -> str:
    """Return the unit of a column that its file states, or the end of its name."""
    return signal.unit or next((found for each in QUANTITIES if (found := unit_of_name(signal.name, each))), "")


def _is_time(signal: Signal) -> bool:
    return read_name(signal.name, signal.unit).quantity == "time"


def _rate(group: Group, path: Path) -> float:
    """Return the sample rate of a group in Hz: of its time, of its format, or of the sidecar of its file."""
    clock = next((signal for signal in group.signals if _is_time(signal)), None)
    if clock is not None:
        axis = read_clock(clock)
        if axis is None or len(axis.breaks) or not axis.is_even:
            raise InputError(f"{path}: {clock.name} does not rise in even steps; seatsim import resamples such files")
        return axis.rate
    sidecar = path.with_name(stem(path.name) + ".yaml")
    rate = group.rate or (constants(Source(sidecar)).get("rate") if sidecar.exists() else None)
    if rate is None:
        raise InputError(f"{path}: no column holds the time (time_s, time_ms, t), and no rate is stated; give --rate")
    return rate


def _recorded(folder: Path) -> list[AccelerationRecord]:
    """Return the runs of a recording of a seat."""
    recording = load_recording(folder)
    units = {name: entry.unit for name, entry in recording.channels.items() if name.endswith("_acceleration")}
    if not units:
        raise InputError(f"{folder / HEADER}: records no acceleration; it has {', '.join(recording.channels)}")
    tables = {run: recording.table(run) for run in recording.runs}
    return [
        AccelerationRecord(
            run, recording.header.sample_rate, {name: Signal(name, unit, table[name]) for name, unit in units.items()}
        )
        for run, table in tables.items()
    ]
