"""Records of dampers on test benches: tables of measured motion, current, temperature and force.

A table is a CSV file whose columns are named by what they hold and by the unit where it is not the SI unit: `time_s`,
`displacement_mm`, `velocity_m_s`, `force_kN`, `current_A`, `voltage_V`, `temperature_C`. A force column may name its
current, `force_0p4A_N`, so that one motion has several. What is constant over a table may stand in a sidecar of the same
name, `sine.yaml` beside `sine.csv`, under the same names. Tables are split into records where the time jumps, where the
column `segment` changes, and where `valid` is 0. A folder with `recording.yaml` is read as it says.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from fnmatch import fnmatch
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.errors import InputError, nearest
from seatsim.recording import HEADER, load_recording
from seatsim.yaml_source import Source

Array = NDArray[np.float64]

UNITS = {
    "mm_s": 1e-3, "cm_s": 1e-2, "m_s": 1.0, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "kN": 1e3, "N": 1.0, "mA": 1e-3,
    "A": 1.0, "mV": 1e-3, "V": 1.0, "ms": 1e-3, "s": 1.0, "Hz": 1.0, "degC": 1.0, "C": 1.0, "K": 1.0,
}  # fmt: skip
"""Units that a column's name may end in, and the SI unit (degC for temperatures) in them."""
ROLES = {
    "time": ("time", "t"),
    "displacement": ("displacement", "stroke", "position", "x"),
    "velocity": ("velocity", "speed", "v"),
    "force": ("force", "damper_force", "f"),
    "current": ("current", "coil_current", "i"),
    "command": ("current_command", "current_cmd", "command"),
    "voltage": ("voltage", "command_voltage"),
    "temperature": ("temperature", "damper_temperature"),
    "segment": ("segment",),
    "valid": ("valid",),
}
"""Names by which a quantity is known."""
NAMES = {name: role for role, names in ROLES.items() for name in names}
FORCE_AT = re.compile(r"force_(\d+(?:[p.]\d+)?)A", re.IGNORECASE)
SUFFIXES = (".csv", ".csv.gz", ".csv.bz2", ".csv.xz", ".csv.zip")
GAP = 1.5
"""Median intervals between rows that make a gap."""
LEAST_ROWS = 20
SLOPE_WINDOW = 0.02
"""Seconds over which a velocity that was not recorded is derived from the displacement."""


class BenchRecord(NamedTuple):
    """One uninterrupted record of a damper on a bench; arrays of shape (N,) at `rate` Hz, SI units.

    `current` is in A; where `commanded`, it is what was asked of the driver (a voltage counts as so many A), which the
    coil follows with a lag. `temperature` is in degC, None where it was not recorded.
    """

    name: str
    file: str
    rate: float
    displacement: Array
    velocity: Array
    force: Array
    current: Array
    commanded: bool
    temperature: Array | None

    @property
    def time(self) -> Array:
        """Seconds since the first row."""
        return np.asarray(np.arange(len(self.force)) / self.rate, dtype=float)

    @property
    def mean_current(self) -> float:
        """Mean current in A."""
        return float(np.mean(self.current))

    def part(self, first: int, last: int) -> BenchRecord:
        """Return rows `first` to `last` (excluded)."""
        cut = slice(first, last)
        warmth = None if self.temperature is None else self.temperature[cut]
        arrays = {name: getattr(self, name)[cut] for name in ("displacement", "velocity", "force", "current")}
        return self._replace(temperature=warmth, **arrays)


def load_bench(path: str | Path) -> list[BenchRecord]:
    """Return the records of a table or of every table of a folder, in the order of their names.

    Raises:
        InputError: nothing is there, or a table is short of a column, not numeric, too short or unevenly sampled.
    """
    path = Path(path)
    if (path / HEADER).exists():
        return _recorded(path)
    files = sorted(file for file in path.iterdir() if file.name.endswith(SUFFIXES)) if path.is_dir() else [path]
    if not files:
        raise InputError(f"{path}: holds no table; a bench table is a file that ends in {', '.join(SUFFIXES)}")
    return [record for file in files for record in _records(file)]


def matching(records: list[BenchRecord], patterns: list[str]) -> list[BenchRecord]:
    """Return the records whose file, or whose own name, matches one of the globs.

    Raises:
        InputError: a pattern matches nothing.
    """
    chosen: list[BenchRecord] = []
    for pattern in patterns:
        found = [r for r in records if any(fnmatch(name, pattern) for name in (r.file, stem(r.file), r.name))]
        if not found:
            known = list(dict.fromkeys(stem(record.file) for record in records))
            raise InputError(f"--test {pattern}: matches no record; there are {', '.join(known)}")
        chosen += [record for record in found if not any(record is other for other in chosen)]
    return chosen


def stem(file: str) -> str:
    """Return a table's file name without its endings."""
    return file.partition(".csv")[0]


def _records(file: Path) -> Iterator[BenchRecord]:
    import pandas as pd

    try:
        frame = pd.read_csv(file)
    except (OSError, ValueError, EOFError) as error:
        raise InputError(f"{file}: cannot be read as a table: {error}") from error
    table: dict[str, Array] = {}
    forces: dict[float | None, Array] = {}
    for column in map(str, frame):
        role, scale, at = _role(column)
        if role and role not in table:
            values = pd.to_numeric(frame[column], errors="coerce").to_numpy(dtype=float) * scale
            bad = np.flatnonzero(~np.isfinite(values))
            if bad.size:
                raise InputError(f"{file}, line {bad[0] + 2}, {column}: not a finite number; {bad.size} rows are not")
            if role == "force":
                forces[at] = values
            else:
                table[role] = values
    _complete(table, _sidecar(file), len(frame))
    for role, there in (("displacement", "displacement" in table), ("force", bool(forces)), ("time", "time" in table)):
        if not there:
            hint = nearest(role, map(str, frame))
            raise InputError(f"{file}: no column holds the {role}{hint}; name it '{role}' or with its unit")
    for at, force in forces.items():
        whole = table | {"force": force} | ({} if at is None else {"current": np.full(len(force), at)})
        yield from _split(whole, file)


def _role(column: str) -> tuple[str | None, float, float | None]:
    """Return what a column holds, the SI unit in its unit, and the current that its name states."""
    name, scale = column.strip(), 1.0
    for unit in sorted(UNITS, key=len, reverse=True):
        if name.endswith("_" + unit):
            name, scale = name[: -len(unit) - 1], UNITS[unit]
            break
    at = FORCE_AT.fullmatch(name)
    if at:
        return "force", scale, float(at[1].lower().replace("p", "."))
    return NAMES.get(name.lower()), scale, None


def _sidecar(file: Path) -> Mapping[str, Any]:
    path = file.with_name(stem(file.name) + ".yaml")
    return Source(path).data if path.exists() else {}


def _complete(table: dict[str, Array], sidecar: Mapping[str, Any], rows: int) -> None:
    """Add to a table what its sidecar states of it."""
    for key, value in sidecar.items():
        role, scale, _ = _role(str(key))
        if role in ("current", "command", "voltage", "temperature") and isinstance(value, int | float):
            table.setdefault(role, np.full(rows, value * scale))
    rate = sidecar.get("sample_rate_Hz", sidecar.get("sample_rate"))
    if isinstance(rate, int | float) and rate > 0:
        table.setdefault("time", np.arange(rows) / rate)


def _split(table: dict[str, Array], file: Path) -> Iterator[BenchRecord]:
    """Yield the uninterrupted records of a table."""
    kept = np.flatnonzero(table["valid"] != 0.0) if "valid" in table else np.arange(len(table["time"]))
    time = table["time"][kept]
    interval = np.diff(time)
    normal = float(np.median(interval)) if len(interval) else 0.0
    if len(time) < LEAST_ROWS or normal <= 0.0:
        raise InputError(f"{file}: holds {len(time)} valid rows of rising time; a record has at least {LEAST_ROWS}")
    jumps = (interval > GAP * normal) | (interval <= 0.0)
    if "segment" in table:
        jumps |= np.diff(table["segment"][kept]) != 0.0
    edges = [0, *(np.flatnonzero(jumps) + 1), len(kept)]
    parts = [kept[a:b] for a, b in pairwise(edges) if b - a >= LEAST_ROWS]
    if sum(map(len, parts)) < 0.9 * len(kept):
        raise InputError(f"{file}: the rows are unevenly spaced in time; resample them to a constant rate")
    records = [_record({role: values[rows] for role, values in table.items()}, file) for rows in parts]
    for number, record in enumerate(records, 1):
        title = f"{stem(file.name)}, {record.mean_current:g} A" if np.ptp(record.current) == 0.0 else stem(file.name)
        taken = sum(np.ptp(r.current) == 0.0 and r.mean_current == record.mean_current for r in records) > 1
        yield record._replace(name=f"{title}, part {number}" if len(records) > 1 and taken else title)


def _record(table: Mapping[str, Array], file: Path) -> BenchRecord:
    time, x = table["time"], table["displacement"]
    rate = (len(time) - 1) / float(time[-1] - time[0])
    given = next((role for role in ("current", "command", "voltage") if role in table), None)
    current = np.maximum(table[given], 0.0) if given else np.zeros(len(time))
    velocity = table["velocity"] if "velocity" in table else _slope(x, rate)
    commanded = given in ("command", "voltage") and bool(np.ptp(current) > 0.0)
    return BenchRecord(
        stem(file.name), file.name, rate, x, velocity, table["force"], current, commanded, table.get("temperature")
    )


def _slope(x: Array, rate: float) -> Array:
    """Return the derivative of a displacement by the method of Savitzky and Golay, order 3 over `SLOPE_WINDOW`."""
    from scipy.signal import savgol_filter

    window = max(5, 2 * round(0.5 * SLOPE_WINDOW * rate) + 1)
    return np.asarray(savgol_filter(x, window, 3, deriv=1, delta=1.0 / rate), dtype=float)


def _recorded(folder: Path) -> list[BenchRecord]:
    """Return the runs of a recording of a bench."""
    recording = load_recording(folder)
    if recording.header.rig != "damper_bench" or "damper_force" not in recording.channels:
        raise InputError(f"{folder}: a damper is identified from a recording of 'rig: damper_bench' with damper_force")
    records = []
    for name in recording.runs:
        table = {role: values for channel, values in recording.table(name).items() if (role := NAMES.get(channel))}
        if recording.voltage_gain is not None and "voltage" in table:
            table["voltage"] = table["voltage"] * recording.voltage_gain
        table["time"] = np.arange(len(table["force"])) / recording.header.sample_rate
        records.append(_record(table, folder / name)._replace(name=name))
    return records
