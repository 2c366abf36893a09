"""A recording of a rig: `recording.yaml`, its nominal scenario, and a table per run."""

from __future__ import annotations

import lzma
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.errors import InputError, nearest
from seatsim.schema.fields import param
from seatsim.schema.validation import build, check_keys, mapping
from seatsim.schema.yaml_source import Source

Array = NDArray[np.float64]

SEAT_CHANNELS = {
    "floor_acceleration": "m/s^2",
    "frame_acceleration": "m/s^2",
    "driver_acceleration": "m/s^2",
    "suspension_displacement": "m",
    "damper_force": "N",
    "current_command": "A",
    "coil_current": "A",
    "damper_temperature": "degC",
}
BENCH_CHANNELS = {
    "displacement": "m",
    "velocity": "m/s",
    "damper_force": "N",
    "current_command": "A",
    "command_voltage": "V",
    "coil_current": "A",
    "damper_temperature": "degC",
}
"""Channels that a recording of each rig may have, with the unit they are in."""
HEADER = "recording.yaml"
KEYS = ("rig", "sample_rate", "parameter_tolerance", "nominal", "runs", "channels", "actuator", "note")


KEPT = 32
"""Number of files kept in memory while they are unchanged, since every simulation of a run reads them again."""
Stamp = tuple[int, int, int] | None


class Header(NamedTuple):
    """The numbers at the top of a recording."""

    rig: Literal["seat", "damper_bench"]
    sample_rate: Annotated[float, param("Hz", "rows per second", above=0, high=1e6)]
    nominal: str
    parameter_tolerance: Annotated[float, param("-", "fraction to which parameters are known", low=0, high=1)] = 0.02


class RunEntry(NamedTuple):
    """One run of a recording; `repeat_of` names the run whose excitation it repeats."""

    name: str
    file: str
    repeat_of: str | None = None
    note: str | None = None


class ChannelEntry(NamedTuple):
    """Unit of a channel, and its noise as an RMS in that unit (0 where none is stated)."""

    unit: str
    noise_rms: Annotated[float, param("", "noise of the sensor", low=0)] = 0.0


class VoltageGain(NamedTuple):
    """Gain from a command voltage to the commanded current."""

    gain: Annotated[float, param("A/V", "commanded current per volt")]


@dataclass(frozen=True)
class Recording:
    """Content of `recording.yaml`; the tables are read run by run with `table`.

    `removed` holds constants by channel that the tables are without, in the channel's unit.
    """

    folder: Path
    header: Header
    runs: dict[str, RunEntry]
    channels: dict[str, ChannelEntry]
    voltage_gain: float | None
    removed: Mapping[str, float] = field(default_factory=dict, kw_only=True)

    @property
    def nominal(self) -> Path:
        """Path of the scenario that the rig's owner assumes."""
        return self.folder / self.header.nominal

    def table(self, run: str) -> dict[str, Array]:
        """Return the recorded channels of a run, shape (N,) each, not to be written into.

        Raises:
            InputError: there is no such run, or its table is missing, empty, short of a channel, or not numeric.
        """
        if run not in self.runs:
            permitted = ", ".join(self.runs)
            raise InputError(
                f"{self.folder}: no run is called '{run}'{nearest(run, self.runs)}; permitted: {permitted}"
            )
        path = self.folder / self.runs[run].file
        table = dict(_read_table(path, tuple(self.channels), _stamp(path)))
        return table | {name: table[name] - constant for name, constant in self.removed.items()}


def _stamp(path: Path) -> Stamp:
    """Return a value that changes with the content of a file, None where there is no file."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_ino, status.st_size, status.st_mtime_ns


def load_recording(folder: str | Path) -> Recording:
    """Read and check `recording.yaml` of a folder.

    Raises:
        InputError: a key or channel is unknown, missing or of the wrong unit.
    """
    return _load(Path(folder), _stamp(Path(folder) / HEADER))


@lru_cache(maxsize=KEPT)
def _load(folder: Path, stamp: Stamp) -> Recording:
    source = Source(folder / HEADER)
    data = source.data
    check_keys(data, KEYS, source, ())
    header = build(Header, {k: data[k] for k in Header._fields if k in data}, source, ())
    gain = build(VoltageGain, data["actuator"], source, ("actuator",)).gain if "actuator" in data else None
    channels = _channels(data, source, header.rig)
    if "command_voltage" in channels and gain is None:
        raise source.error((), "key 'actuator' is missing; a command_voltage needs 'actuator: {gain: A/V}'")
    return Recording(folder, header, _runs(data, source), channels, gain)


def _runs(data: Mapping[str, object], source: Source) -> dict[str, RunEntry]:
    entries = data.get("runs")
    if not isinstance(entries, list) or not entries:
        raise source.error(("runs",), "a recording has at least one run; write '- {name: run-a, file: run-a.csv.gz}'")
    runs: dict[str, RunEntry] = {}
    for index, entry in enumerate(entries):
        run: RunEntry = build(RunEntry, entry, source, ("runs", index))
        if run.name in runs:
            raise source.error(("runs", index, "name"), f"'{run.name}' is the name of two runs; name each once")
        runs[run.name] = run
    for index, run in enumerate(runs.values()):
        if run.repeat_of is not None and run.repeat_of not in runs:
            permitted = f"{nearest(run.repeat_of, runs)}; permitted: {', '.join(runs)}"
            raise source.error(("runs", index, "repeat_of"), f"no run is called '{run.repeat_of}'{permitted}")
    return runs


def _channels(data: Mapping[str, object], source: Source, rig: str) -> dict[str, ChannelEntry]:
    known = SEAT_CHANNELS if rig == "seat" else BENCH_CHANNELS
    entries = mapping(data.get("channels", {}), source, ("channels",))
    check_keys(entries, known, source, ("channels",))
    channels = {}
    for name, entry in entries.items():
        channels[name] = build(ChannelEntry, entry, source, ("channels", name))
        if channels[name].unit != known[name]:
            problem = f"'{channels[name].unit}' is not permitted; convert the channel to {known[name]}"
            raise source.error(("channels", name, "unit"), problem)
    needed = "floor_acceleration" if rig == "seat" else "displacement"
    if needed not in channels:
        raise source.error(("channels",), f"channel '{needed}' is missing; it drives the simulation of this rig")
    return channels


@lru_cache(maxsize=KEPT)
def _read_table(path: Path, channels: tuple[str, ...], stamp: Stamp) -> dict[str, Array]:
    import pandas as pd

    try:
        frame = pd.read_csv(path)
    except (OSError, ValueError, EOFError, zlib.error, zipfile.BadZipFile, lzma.LZMAError) as error:
        raise InputError(f"{path}: cannot be read as a table: {error}") from error
    if len(frame) < 2:
        raise InputError(f"{path}: holds {len(frame)} rows; a run has at least two")
    missing = [name for name in channels if name not in frame]
    if missing:
        raise InputError(
            f"{path}: column '{missing[0]}' is missing{nearest(missing[0], map(str, frame))}; recording.yaml lists it"
        )
    table = {}
    for name in channels:
        values = pd.to_numeric(frame[name], errors="coerce").to_numpy(dtype=np.float64)
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise InputError(f"{path}, line {bad[0] + 2}, {name}: not a finite number; {bad.size} rows are not")
        values.flags.writeable = False
        table[name] = values
    return table
