"""Records of dampers on test benches: tables of measured motion, current, temperature and force.

A table is a CSV file. A column is called by its quantity, followed by its unit where that is not the SI unit:
`displacement_mm`, `force_kN`, `velocity_m_s`, also written `Displacement [mm]` or `velocity (m/s)`. A force may name
its current, `force_0p4A_N`. Tables are split into records where the time jumps and where the column `segment`
changes; rows whose `valid` is 0 are left out. A folder with `recording.yaml` is read as it says.
"""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from seatsim.recordings.recording import HEADER, load_recording
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.fields import read_packaged
from seatsim.schema.guarded import is_there, nearest_beside
from seatsim.schema.tables import read_finite, read_table
from seatsim.schema.units import OWN_SPELLINGS, USUAL, conversion

if TYPE_CHECKING:
    import pandas as pd


_QUANTITIES = read_packaged(Path(__file__).with_name("bench_columns.yaml"), dict[str, tuple[tuple[str, ...], str]])
"""Names of every quantity, and its SI unit, in which a bare name is; usual units and spellings may follow a name."""
_DRIVES = ("current", "command", "voltage")
"""Quantities that state the damper's input, in the order of preference."""
_NEEDED = ("time", "displacement", "force")
_FORCE_AT = re.compile(r"(?:damper_)?force_(\d+(?:[p.]\d+)?)a(?:_(k?n))?")
_MISSPELT = 0.9
"""Similarity to a known name (by difflib) above which an unknown column is taken for a misspelling."""
_LISTED = 12
"""Most columns that an error lists."""


class Meaning(NamedTuple):
    """What a column holds: a quantity in a unit, that of SI where it is empty; `at`, the current in A that it names."""

    quantity: str
    unit: str = ""
    at: float | None = None

    def in_si(self, values: Array) -> Array:
        """Return values of the column in SI units (degC)."""
        if not self.unit:
            return values
        found = conversion(self.unit, _QUANTITIES[self.quantity][1])
        return values * found.factor + found.zero


def _known() -> dict[str, Meaning]:
    known = {}
    for quantity, (names, si) in _QUANTITIES.items():
        units = (*USUAL.get(si, ()), *(unit for unit in OWN_SPELLINGS.get(si, {}) if unit[0].isalpha()))
        for name in names:
            known[name] = Meaning(quantity)
            known |= {_with_unit(name, unit).lower(): Meaning(quantity, unit if unit != si else "") for unit in units}
    return known


def _with_unit(name: str, unit: str) -> str:
    """Return the name of a column that ends in a unit, such as `velocity_m_s`."""
    return f"{name}_{re.sub('[/ ]', '_', unit)}"


_KNOWN = _known()
"""Every name that a column may have, in lower case."""


def meaning(column: str) -> Meaning | None:
    """Return what a column of this name holds, None where the name is not known."""
    plain = re.sub(r"[^0-9a-z.]+", "_", column.lower()).strip("_")
    at = _FORCE_AT.fullmatch(plain)
    if at:
        return Meaning("force", "kN" if at[2] == "kn" else "", float(at[1].replace("p", ".")))
    return _KNOWN.get(plain)


def _columns_of(names: Sequence[str], file: Path) -> tuple[dict[tuple[str, float | None], str], tuple[str, ...]]:
    """Return the columns of a table by quantity and the current in their names, and those that hold no known quantity.

    Raises:
        InputError: two columns hold the same, or the name of one is misspelt.
    """
    found, unused = dict[tuple[str, float | None], str](), list[str]()
    for name in names:
        known = meaning(name)
        if known is None:
            unused.append(name)
        elif (other := found.setdefault((known.quantity, known.at), name)) != name:
            raise InputError(f"{file}: '{other}' and '{name}' both hold the {known.quantity}; rename or remove one")
    there = {quantity for quantity, _ in found}
    for name in unused:
        close = difflib.get_close_matches(name.lower(), _KNOWN, n=1, cutoff=_MISSPELT)
        if close and (quantity := _KNOWN[close[0]].quantity) not in there:
            raise InputError(f"{file}: column '{name}' is not known; name it {_spelt(quantity)}, or remove it")
    _check_needed(there, names, file)
    return found, tuple(unused)


def _numbers(frame: pd.DataFrame, column: str, file: Path) -> Array:
    """Return a column of a table in SI units, shape (N,); InputError where a row of it is no finite number."""
    known = meaning(column)
    values = read_finite(frame, column, file, "correct it, or mark such rows by 0 in a column 'valid'")
    return known.in_si(values) if known else values


def _check_needed(there: Collection[str], columns: Sequence[str], file: Path) -> None:
    """Raise InputError, with the nearest column, at the first quantity that a bench table needs and this one lacks."""
    quantity = next((each for each in _NEEDED if each not in there), None)
    if quantity is not None:
        hint, others = nearest(quantity, columns), ", ".join(_QUANTITIES[quantity][0][1:])
        there_are = f"there are {', '.join(columns[:_LISTED])}{', ...' * (len(columns) > _LISTED)}"
        name = f"name it {_spelt(quantity)} (also {others} with the unit)"
        raise InputError(f"{file}: no column holds the {quantity}{hint}; {name}; {there_are}")


def _spelt(quantity: str) -> str:
    units = USUAL.get(_QUANTITIES[quantity][1], ())
    return " or ".join(f"'{_with_unit(quantity, unit)}'" for unit in units) or f"'{quantity}'"


_Table = dict[str, Array]
_T = TypeVar("_T")

NAMED = r"(?P<current>\d+(?:[.,]\d+)?) ?A(?![a-zA-Z])|(?P<temperature>\d+(?:[.,]\d+)?) ?(?:deg)?C(?![a-zA-Z])"
"""Current and temperature as they usually stand in the names of files."""
_NAMED_GROUPS = ("current", "temperature")
_SUFFIXES = (".csv", ".csv.gz")
_GAP = 1.5
"""A pause of more median row intervals than this ends a record."""
_OFF = 1.0
"""Largest deviation of a row from the even spacing of its record, in median intervals."""
LEAST_ROWS = 20
_KEPT = 0.9
"""Least share of a table's rows that its records hold; the other rows lie in short pieces between pauses."""
_SLOPE_WINDOW = 0.02
"""s; window over which the displacement is differentiated where no velocity was recorded."""


class BenchRecord(NamedTuple):
    """One uninterrupted record of a damper on a bench; arrays of shape (N,) at `rate` Hz, SI units.

    `current` is in A, zero where it was negative. Where `commanded`, it is the command to the driver, which the coil
    follows with a lag; where `in_volts`, that is a voltage, of which 1 V counts as 1 A. `temperature` is in degC, None
    where it was not recorded. `unused` are the columns of its file, in `folder`, that hold no known quantity.
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
    unused: tuple[str, ...] = ()
    in_volts: bool = False
    folder: str = ""

    @property
    def time(self) -> Array:
        """Seconds since the first row."""
        return np.asarray(np.arange(len(self.force)) / self.rate, dtype=float)

    @property
    def mean_current(self) -> float:
        """Mean current in A."""
        return float(self.current[0] if np.ptp(self.current) == 0.0 else np.mean(self.current))

    def part(self, first: int, last: int) -> BenchRecord:
        """Return rows `first` to `last` (excluded)."""
        fields = self._asdict()
        rows: dict[str, Any] = {name: v[first:last] for name, v in fields.items() if isinstance(v, np.ndarray)}
        return self._replace(**rows)

    def liveliest(self, rows: int) -> tuple[int, int]:
        """Return first and last row (excluded) of the stretch of at most so many rows with the highest mean speed."""
        if len(self.force) <= rows:
            return 0, len(self.force)
        travel = np.concatenate([[0.0], np.cumsum(np.abs(self.velocity))])
        first = int(np.argmax(travel[rows:] - travel[:-rows]))
        return first, first + rows


def load_bench(path: str | Path, pattern: str = "") -> list[BenchRecord]:
    """Return the records of a table or of every table of a folder, in the order of their names; see `map_bench`."""
    return [record for records in map_bench(path, list, pattern) for record in records]


def map_bench(path: str | Path, look: Callable[[Iterable[BenchRecord]], _T], pattern: str = "") -> Iterator[_T]:
    """Yield what `look` returns of the records of a table, or of each table of a folder in the order of their names.

    As many tables as there are processors are read and looked at side by side. No more of them are in memory, unless
    `look` keeps their records.

    `pattern` is a regular expression for the names of the files, whose groups `current` in A and `temperature` in degC
    count where no column states these; `NAMED` reads `0.3A-2.csv` and `1.5A_80C.csv`.

    Raises:
        InputError: nothing is there, or a table is short of a column, not numeric, too short or unevenly sampled.
    """
    path = Path(path)
    if not is_there(path):
        problem = f"{path}: no such file or folder{nearest_beside(path)}; give a bench table, or a folder of them"
        raise InputError(problem)
    if (path / HEADER).exists():
        yield look(_recorded(path))
        return
    files = sorted(file for file in path.iterdir() if file.name.endswith(_SUFFIXES)) if path.is_dir() else [path]
    if not files:
        raise InputError(f"{path}: holds no table; give a folder with files that end in {', '.join(_SUFFIXES)}")
    named = _compile(pattern)
    # Threads suffice: most of the time goes into pyarrow and numpy, which leave the interpreter free.
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from pool.map(lambda file: look(_records(file, named)), files)


def _compile(pattern: str) -> re.Pattern[str] | None:
    """Return the pattern of file names.

    Raises:
        InputError: it is no regular expression with one of the groups.
    """
    try:
        found = re.compile(pattern) if pattern else None
    except re.error as error:
        problem = f"--pattern {pattern}: is no regular expression: {error}; write one such as {NAMED}"
        raise InputError(problem) from error
    if found and not set(found.groupindex) & set(_NAMED_GROUPS):
        raise InputError(f"--pattern {pattern}: has no group named current or temperature; write one such as {NAMED}")
    return found


def _read_name(name: str, pattern: re.Pattern[str] | None) -> dict[str, float]:
    """Return what the name of a file states by quantity; a decimal comma counts as a point."""
    if pattern is None:
        return {}
    stated = [(key, text) for match in pattern.finditer(name) for key, text in match.groupdict().items()]
    try:
        return {key: float(text.replace(",", ".")) for key, text in stated if text and key in _NAMED_GROUPS}
    except ValueError as error:
        raise InputError(f"--pattern {pattern.pattern}: finds no number in '{name}'; {error}") from error


def stem(file: str) -> str:
    """Return a table's file name without its endings."""
    return file.partition(".csv")[0]


def note_unused(names: Iterable[str]) -> list[str]:
    """Return a sentence on the columns that hold no known quantity, none where there are no such columns."""
    each = dict.fromkeys(names)
    return [f"columns that are not used: {', '.join(each)}"] if each else []


def _records(file: Path, pattern: re.Pattern[str] | None) -> Iterator[BenchRecord]:
    frame = read_table(file)
    columns, unused = _columns_of([*map(str, frame)], file)
    stated = _read_name(stem(file.name), pattern)
    if valid := columns.pop(("valid", None), None):
        frame = frame[_numbers(frame, valid, file) != 0.0]
    forces = {at: column for (quantity, at), column in columns.items() if quantity == "force"}
    table = {each: _numbers(frame, column, file) for (each, _), column in columns.items() if each != "force"}
    driven = any(drive in table for drive in _DRIVES)
    for quantity, value in stated.items():
        if quantity == "temperature" or not driven:
            table.setdefault(quantity, np.full(len(frame), value))
    lines = frame.index.to_numpy() + 2
    for at, column in forces.items():
        current = {} if at is None else {"current": np.full(len(frame), at)}
        for record in _split({**table, "force": _numbers(frame, column, file), **current}, file, lines):
            yield record._replace(unused=unused)


def _split(table: _Table, file: Path, lines: NDArray[np.int64]) -> Iterator[BenchRecord]:
    """Yield the uninterrupted records of a table; `lines` are the line numbers of its rows in the file."""
    time = table["time"]
    interval = np.diff(time)
    normal = float(np.median(interval)) if len(interval) else 0.0
    if len(time) < LEAST_ROWS or normal <= 0.0:
        raise InputError(f"{file}: holds {len(time)} rows of rising time; a record has at least {LEAST_ROWS}")
    jumps = (interval > _GAP * normal) | (interval <= 0.0)
    if "segment" in table:
        jumps |= np.diff(table["segment"]) != 0.0
    edges = [0, *(np.flatnonzero(jumps) + 1), len(time)]
    parts = [slice(a, b) for a, b in pairwise(edges) if b - a >= LEAST_ROWS]
    uneven = [int(np.flatnonzero(jumps)[0]) + 1] if sum(p.stop - p.start for p in parts) < _KEPT * len(time) else []
    for part in parts:
        off = np.abs(time[part] - np.linspace(time[part][0], time[part][-1], part.stop - part.start))
        uneven += [part.start + int(np.argmax(off))] if np.max(off) > _OFF * normal else []
    if uneven:
        place = f"{file}, line {lines[uneven[0]]}, {time[uneven[0]]:g} s"
        raise InputError(f"{place}: rows are not evenly spaced in time; resample them to a constant rate")
    records = [_record({name: y[part] for name, y in table.items()}, file) for part in parts]
    # Names are distinct: by the current where that is constant.
    titles = [f"{r.name}, {r.mean_current:g} A" if np.ptp(r.current) == 0.0 else r.name for r in records]
    for number, (record, title) in enumerate(zip(records, titles, strict=True), 1):
        yield record._replace(name=f"{title}, part {number}" if titles.count(title) > 1 else title)


def _record(table: Mapping[str, Array], file: Path) -> BenchRecord:
    time, x = table["time"], table["displacement"]
    rate = (len(time) - 1) / float(time[-1] - time[0])
    drive = next((name for name in _DRIVES if name in table), None)
    current = np.maximum(table[drive], 0.0) if drive else np.zeros(len(time))
    velocity = table["velocity"] if "velocity" in table else _slope(x, rate)
    commanded = drive in ("command", "voltage") and bool(np.ptp(current) > 0.0)
    name, warmth = stem(file.name), table.get("temperature")
    record = BenchRecord(name, file.name, rate, x, velocity, table["force"], current, commanded, warmth)
    return record._replace(in_volts=drive == "voltage", folder=str(file.parent))


def _slope(x: Array, rate: float) -> Array:
    """Return the derivative of a displacement by the method of Savitzky and Golay, order 3 over `_SLOPE_WINDOW`."""
    from scipy.signal import savgol_filter

    window = min(max(5, 2 * round(0.5 * _SLOPE_WINDOW * rate) + 1), 2 * ((len(x) - 1) // 2) + 1)
    return np.asarray(savgol_filter(x, window, 3, deriv=1, delta=1.0 / rate), dtype=float)


def _recorded(folder: Path) -> list[BenchRecord]:
    """Return the runs of a recording of a bench."""
    recording = load_recording(folder)
    if recording.header.rig != "damper_bench" or "damper_force" not in recording.channels:
        stated = f"rig '{recording.header.rig}' with {', '.join(recording.channels)}"
        wanted = "a damper is identified from a recording of 'rig: damper_bench' with the channel damper_force"
        raise InputError(f"{folder / HEADER}: {stated}; {wanted}")
    records = []
    for name, entry in recording.runs.items():
        if entry.set:
            problem = f"run {name} sets {', '.join(entry.set)}; one damper, as it is, is identified from all runs"
            raise InputError(f"{folder / HEADER}: {problem}: leave this one out")
        table = {_KNOWN[channel].quantity: values for channel, values in recording.table(name).items()}
        if recording.voltage_gain is not None and "voltage" in table:
            table.setdefault("command", table.pop("voltage") * recording.voltage_gain)
        table["time"] = np.arange(len(table["force"])) / recording.header.sample_rate
        records.append(_record(table, folder / name)._replace(name=name))
    return records
