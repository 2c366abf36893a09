"""Measured accelerations as records in SI units: a CSV table, or the runs of a recording."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.recordings.bench_columns import constants, meaning, numbers
from seatsim.recordings.bench_tables import read_frame, stem
from seatsim.recordings.recording import HEADER, load_recording
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.yaml_source import Source

Array = NDArray[np.float64]

STANDARD_GRAVITY = 9.80665
"""m/s^2"""
UNITS = {
    "m/s^2": 1.0, "m/s2": 1.0, "m/s²": 1.0, "m_s2": 1.0, "mm/s^2": 1e-3, "mm/s2": 1e-3, "mm_s2": 1e-3,
    "g": STANDARD_GRAVITY, "mg": 1e-3 * STANDARD_GRAVITY, "rad/s^2": 1.0, "rad/s2": 1.0, "rad_s2": 1.0,
    "deg/s^2": np.pi / 180, "deg/s2": np.pi / 180, "deg_s2": np.pi / 180,
}  # fmt: skip
"""Size in SI of the units that may end a column's name: `acc_z_g`, `acc_z [g]`, `acc_z (m/s^2)`."""
LARGEST_JITTER = 0.25
"""Largest deviation of a row from even spacing, in intervals."""


class AccelerationRecord(NamedTuple):
    """One uninterrupted record: accelerations in SI units by column, shape (N,) each, at `sample_rate` Hz."""

    name: str
    sample_rate: float
    columns: Mapping[str, Array]
    unitless: frozenset[str] = frozenset()
    """Columns for which no unit is stated, taken as SI units."""

    def column(self, name: str) -> Array:
        """Return a column, shape (N,).

        Raises:
            InputError: there is no such column, or a row of it is no finite number.
        """
        if name not in self.columns:
            hint = nearest(name, self.columns)
            raise InputError(f"{self.name}: no column '{name}'{hint}; columns of numbers: {', '.join(self.columns)}")
        bad = np.flatnonzero(~np.isfinite(self.columns[name]))
        if bad.size:
            raise InputError(f"{self.name}, line {bad[0] + 2}, {name}: not a finite number; {bad.size} rows are not")
        return self.columns[name]


def load_accelerations(
    path: str | Path, rate: float | None = None, unit: str | None = None
) -> list[AccelerationRecord]:
    """Return the record of a CSV table, or the runs of a recording.

    The sample rate of a table is `rate` in Hz, else that of a column `time_s` (`time`, `t`, `time_ms`), else what a
    sidecar of the same name states as `sample_rate_Hz`. `unit` is that of columns whose names state none; None: m/s^2.

    Raises:
        InputError: nothing is there, it is no table, a unit is not known, or the rows are not evenly spaced.
    """
    path = Path(path)
    if (path / HEADER).exists():
        return _recorded(path)
    if not path.is_file():
        beside = [other.name for other in path.parent.iterdir()] if path.parent.is_dir() else []
        raise InputError(
            f"{path}: no such file or recording{nearest(path.name, beside)}; give a CSV table or a recording"
        )
    if unit is not None and unit not in UNITS:
        raise InputError(f"unit '{unit}' is not known{nearest(unit, UNITS)}; permitted: {', '.join(UNITS)}")
    return [_table(path, rate, unit)]


def split_unit(column: str) -> tuple[str, str | None]:
    """Return a column's name in lower case without its unit, and that unit: one of `UNITS`, or None."""
    for unit in sorted(UNITS, key=len, reverse=True):
        found = re.fullmatch(rf"(.+?)(?:_{re.escape(unit)}|\s*[\[(]\s*{re.escape(unit)}\s*[\])])", column.strip())
        if found:
            return found[1].lower(), unit
    return column.strip().lower(), None


def _table(file: Path, rate: float | None, unit: str | None) -> AccelerationRecord:
    frame = read_frame(file)
    names = list(map(str, frame))
    time = next((name for name in names if (known := meaning(name)) and known.quantity == "time"), None)
    numeric = [name for name in names if frame[name].dtype.kind in "fiu" and name != time]
    if not numeric:
        raise InputError(f"{file}: holds no column of numbers besides the time; there are {', '.join(names)}")
    units = {name: split_unit(name)[1] or unit for name in numeric}
    columns = {name: frame[name].to_numpy(dtype=np.float64) * UNITS[units[name] or "m/s^2"] for name in numeric}
    if rate is not None and not 0 < rate < np.inf:
        raise InputError(f"a sample rate of {rate:g} Hz is not permitted; it must be above 0")
    sampled = rate or (_rate_of(numbers(frame, time, file), time, file) if time else _stated_rate(file))
    return AccelerationRecord(file.name, sampled, columns, frozenset(name for name in numeric if units[name] is None))


def _rate_of(seconds: Array, column: str, file: Path) -> float:
    """Return the sample rate in Hz of a table with a column of times."""
    interval = float(seconds[-1] - seconds[0]) / max(1, len(seconds) - 1)
    off = np.abs(seconds - seconds[0] - interval * np.arange(len(seconds)))
    if not interval > 0 or off.max() > LARGEST_JITTER * interval:
        raise InputError(f"{file}, line {int(np.argmax(off)) + 2}: {column} does not rise in even steps; resample it")
    return 1 / interval


def _stated_rate(file: Path) -> float:
    """Return the sample rate in Hz that a sidecar states."""
    sidecar = file.with_name(stem(file.name) + ".yaml")
    rate = constants(Source(sidecar)).get("rate") if sidecar.exists() else None
    if rate is None:
        raise InputError(
            f"{file}: no column holds the time (time_s, time_ms, t), and no sample rate is given; give --rate"
        )
    return rate


def _recorded(folder: Path) -> list[AccelerationRecord]:
    """Return the runs of a recording of a seat."""
    recording = load_recording(folder)
    wanted = [name for name in recording.channels if name.endswith("_acceleration")]
    if not wanted:
        raise InputError(f"{folder / HEADER}: records no acceleration; it has {', '.join(recording.channels)}")
    return [
        AccelerationRecord(run, recording.header.sample_rate, {name: recording.table(run)[name] for name in wanted})
        for run in recording.runs
    ]
