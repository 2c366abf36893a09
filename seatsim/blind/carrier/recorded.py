"""A measured recording as values that can be changed and written again, what a change is, and arithmetic on signals."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from scipy.signal import lfilter, savgol_filter

from seatsim.blind.make.make import encode_table, encode_yaml
from seatsim.blind.make.materiality import LEFT_OUT
from seatsim.recordings.recording import HEADER, load_recording
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.yaml_source import Source

_LEAST_ROWS = 200
"""Of a run beyond that."""
Table = Mapping[str, Array]
"""Channels of a run, shape (N,) each."""
Content = dict[str, object]
"""What a YAML file says."""
_DECIMALS = 12
"""Most digits after the point that are written."""
_SMOOTHING = 0.02
"""s; window of the polynomial whose slope is the velocity."""


class Carrier(NamedTuple):
    """A recording as read: the contents of its two YAML files, and its runs by name."""

    header: Content
    nominal: Content
    tables: Mapping[str, Table]
    decimals: Mapping[str, int] = {}
    """Digits after the point with which each channel is written."""

    @property
    def rig(self) -> str:
        """Kind of rig, `seat` or `damper_bench`."""
        return str(self.header["rig"])

    @property
    def step(self) -> float:
        """Time between rows, s."""
        return 1.0 / float(str(self.header["sample_rate"]))

    @property
    def channels(self) -> tuple[str, ...]:
        """Recorded channels."""
        return tuple(section(self.header, "channels"))

    def noise(self, channel: str) -> float:
        """Return the stated noise of a channel, RMS in its unit; 0 where none is stated."""
        return number(section(section(self.header, "channels"), channel).get("noise_rms", 0.0))

    def pooled(self, channel: str) -> Array:
        """Return a channel over all runs, without the seconds that no gap counts."""
        skip = round(LEFT_OUT / self.step)
        return np.concatenate([table[channel][skip:] for table in self.tables.values()])


def section(content: Mapping[str, object], key: str) -> Content:
    """Return the mapping below a key, empty where there is none."""
    below = content.get(key)
    return dict(below) if isinstance(below, Mapping) else {}


def number(value: object) -> float:
    """Return a number of a YAML file."""
    return float(value) if isinstance(value, int | float) else float("nan")


def read_carrier(folder: Path) -> Carrier:
    """Read a recording that is to carry cases.

    Raises:
        InputError: it is no recording of the contract, or one of its runs is too short to be compared.
    """
    recording = load_recording(folder)
    tables = {run: recording.table(run) for run in recording.runs}
    least = round(LEFT_OUT * recording.header.sample_rate) + _LEAST_ROWS
    for run, table in tables.items():
        if len(next(iter(table.values()))) < least:
            raise InputError(f"{folder}, run {run}: shorter than {least} rows; its first second is left out; drop it")
    header = Source(folder / HEADER).data
    if recording.conversions:  # tables are read in SI units, whatever the header states
        header["channels"] = {name: entry._asdict() for name, entry in recording.channels.items()}
    decimals = {name: _count_decimals([table[name] for table in tables.values()]) for name in recording.channels}
    return Carrier(header, Source(recording.nominal_file).data, tables, decimals)


def _count_decimals(runs: list[Array]) -> int:
    """Return the digits with which a channel was recorded, or those of a hundredth of its spread where that has more.

    A command that was recorded as 0 or 1 could not be changed otherwise.
    """
    values = np.concatenate(runs)
    spread = float(np.std(values))
    least = math.ceil(2.0 - math.log10(spread)) if spread > 0.0 else 0
    enough = range(min(max(least, 0), _DECIMALS), _DECIMALS)
    return next((n for n in enough if np.allclose(values, np.round(values, n), rtol=1e-14, atol=0.0)), _DECIMALS)


def encode_carrier(carrier: Carrier, runs: tuple[str, ...]) -> dict[str, bytes]:
    """Return the files of a recording folder with these runs, by name; their notes and other names are left out."""
    entries = [_entry(carrier, run, runs) for run in runs]
    header = {**carrier.header, "runs": entries, "nominal": "nominal.yaml"}
    header.pop("note", None)
    files = {"recording.yaml": encode_yaml(header), "nominal.yaml": encode_yaml(carrier.nominal)}
    return files | {f"{run}.csv.gz": _encode_table(carrier, run) for run in runs}


def _entry(carrier: Carrier, run: str, runs: tuple[str, ...]) -> Content:
    entries = carrier.header["runs"]
    found = next(e for e in entries if e["name"] == run) if isinstance(entries, list) else {}
    kept = {key: value for key, value in found.items() if key == "set" or (key == "repeat_of" and value in runs)}
    return {"name": run, "file": f"{run}.csv.gz", **kept}


def _encode_table(carrier: Carrier, run: str) -> bytes:
    """Return a run in which a channel has as many digits as were recorded: more would tell which was changed."""
    table = carrier.tables[run]
    rows = len(next(iter(table.values())))
    columns = {"time": carrier.step * np.arange(rows, dtype=np.float64), **table}
    formats = ["%.10g", *(f"%.{carrier.decimals.get(name, _DECIMALS)}f" for name in table)]
    return encode_table(columns, formats)


class Altered(NamedTuple):
    """A changed carrier with the true parameters, under the names that the effect's own parameters have."""

    carrier: Carrier
    parameters: Mapping[str, float]


class Change(NamedTuple):
    """An effect in one form: `alter` gives the carrier with the effect at an amount up to `largest`.

    `effect` is a name of the contract, `form` how it was put in, `channel` that of a sensor effect, else empty.
    """

    effect: str
    form: str
    channel: str
    largest: float
    alter: Callable[[float], Altered]


Read = Callable[[Table, float], Table]
"""Channels that an effect changes, of a run and an amount."""
Parameters = Callable[[float], Mapping[str, float]]
"""True parameters of an effect at an amount."""


def change_runs(
    carrier: Carrier, effect: tuple[str, str, str], largest: float, read: Read, parameters: Parameters
) -> Change:
    """Return an effect, by name, form and channel: `read` gives the channels that change in a run at an amount."""

    def alter(amount: float) -> Altered:
        tables = {run: {**table, **read(table, amount)} for run, table in carrier.tables.items()}
        return Altered(carrier._replace(tables=tables), parameters(amount))

    return Change(*effect, largest, alter)


def draw_sign(rng: Generator, negative: float = -1.0) -> float:
    """Draw 1 or a negative number."""
    return negative if rng.random() < 0.5 else 1.0


def slope(values: Array, step: float) -> Array:
    """Return the time derivative of a recorded signal, shape (N,), by a sliding cubic (Savitzky and Golay 1964)."""
    window = max(5, 2 * round(0.5 * _SMOOTHING / step) + 1)
    return np.asarray(savgol_filter(values, min(window, len(values) // 2 * 2 - 1), 3, deriv=1, delta=step))


def shifted(values: Array, late: Array | float, step: float) -> Array:
    """Return the signal of `late` seconds ago, linear between rows, held at the ends."""
    time = np.arange(len(values)) * step
    late_values: Array = np.interp(time - late, time, values)
    return late_values


def shifted_rows(values: Array, late: int) -> Array:
    """Return a signal that holds between rows, `late` rows later (negative: earlier), held at the ends."""
    rows = np.clip(np.arange(len(values)) - late, 0, len(values) - 1)
    return values[rows]


def low_pass(values: Array, time: float, step: float) -> Array:
    """Return the exact first-order response with time constant `time` [s] to a signal held between rows' midpoints."""
    half, a = (float(np.exp(-part * step / time)) if time > 0.0 else 0.0 for part in (0.5, 1.0))
    return np.asarray(lfilter([1.0 - half, half - a], [1.0, -a], values - values[0]) + values[0])


def slide(x: Array, travel: float) -> Array:
    """Return the Jenkins element of a motion: -1 to 1, stiff over half of `travel` [m], then sliding; shape (N,)."""
    found, anchor, half = np.empty_like(x), float(x[0]), 0.5 * travel
    for k, here in enumerate(x):
        anchor = min(max(anchor, here - half), here + half)
        found[k] = (here - anchor) / half
    return found
