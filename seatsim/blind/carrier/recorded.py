"""A measured recording as values that can be changed and written again."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from seatsim.blind.make.folder import encode_yaml, pack
from seatsim.recordings.recording import HEADER, load_recording
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.yaml_source import Source

LEFT_OUT = 1.0
"""s; start of each run that no gap counts (contract, section 4)."""
LEAST_ROWS = 200
"""Of a run beyond that."""
Table = Mapping[str, Array]
"""Channels of a run, shape (N,) each."""
Content = dict[str, object]
"""What a YAML file says."""
DECIMALS = 12
"""Most digits after the point that are written."""


@dataclass(frozen=True)
class Carrier:
    """A recording as read: the contents of its two YAML files, and its runs by name."""

    header: Content
    nominal: Content
    tables: Mapping[str, Table]
    decimals: Mapping[str, int] = field(default_factory=dict)
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
    least = round(LEFT_OUT * recording.header.sample_rate) + LEAST_ROWS
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
    enough = range(min(max(least, 0), DECIMALS), DECIMALS)
    return next((n for n in enough if np.allclose(values, np.round(values, n), rtol=1e-14, atol=0.0)), DECIMALS)


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
    """Return a run as a gzipped CSV whose bytes depend on nothing but the numbers.

    A channel has as many digits as were recorded: more of them would tell which channel was changed.
    """
    table = carrier.tables[run]
    rows = len(next(iter(table.values())))
    columns = {"time": np.arange(rows) * carrier.step, **table}
    formats = ["%.10g", *(f"%.{carrier.decimals.get(name, DECIMALS)}f" for name in table)]
    text = io.StringIO()
    np.savetxt(text, np.column_stack(list(columns.values())), formats, ",", header=",".join(columns), comments="")
    return pack(text.getvalue().encode())
