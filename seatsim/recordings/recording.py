"""A recording of a rig: `recording.yaml`, its nominal scenario, a table per run, and the channels that it may have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Annotated, NamedTuple

from seatsim.recordings.header import Header, RunEntry, check_against, read_runs, read_tolerances
from seatsim.scenario.loading import single
from seatsim.scenario.numbers import change_numbers, list_numbers
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, nearest, placed
from seatsim.schema.fields import param
from seatsim.schema.guarded import is_there
from seatsim.schema.tables import numbers, read_table
from seatsim.schema.units import Conversion, conversion
from seatsim.schema.validation import build, check_keys, mapping
from seatsim.schema.yaml_source import Source

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
CHANNELS = {"seat": SEAT_CHANNELS, "damper_bench": BENCH_CHANNELS}
"""Channels by rig, each with its unit."""
DRIVERS = {"seat": "floor_acceleration", "damper_bench": "displacement"}
"""Channel of the excitation by rig, without which no recording of it can be replayed."""
ACCELEROMETERS = ("floor_acceleration", "frame_acceleration", "driver_acceleration")
MOTION = (*ACCELEROMETERS, "suspension_displacement", "displacement", "velocity", "damper_force")
"""Channels of motion and force, which swing about zero and are never at rest for long."""
COMMANDS = ("current_command", "command_voltage")
"""Channels that are logged and not measured, so that they have no noise."""
CURRENTS = (*COMMANDS, "coil_current")
"""Channels of which one drives the coil or the damper."""


HEADER = "recording.yaml"
_KEYS = (*Header._fields, "runs", "channels", "actuator", "note")

_KEPT = 32
"""Number of files kept in memory while they are unchanged, since every simulation of a run reads them again."""
_Stamp = tuple[int, int, int] | None


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

    `conversions` holds the channels whose tables are in another unit than the SI one, in which everything here is;
    `removed` holds constants by channel that the tables are without.
    """

    folder: Path
    header: Header
    runs: dict[str, RunEntry]
    channels: dict[str, ChannelEntry]
    voltage_gain: float | None
    conversions: Mapping[str, Conversion] = field(default_factory=dict, kw_only=True)
    removed: Mapping[str, float] = field(default_factory=dict, kw_only=True)

    @property
    def nominal_file(self) -> Path:
        """Path of the scenario that the rig's owner assumes."""
        return self.folder / self.header.nominal

    @cached_property
    def nominal(self) -> Scenario:
        """The scenario that the rig's owner assumes, read when it is first asked for.

        Raises:
            InputError: there is none, or there is an error in it.
        """
        return single(self.nominal_file)

    @cached_property
    def nominal_numbers(self) -> Mapping[str, float]:
        """The numbers of that scenario by dotted key."""
        return list_numbers(self.nominal)

    def table(self, run: str) -> dict[str, Array]:
        """Return the recorded channels of a run in SI units, shape (N,) each, not to be written into.

        Raises:
            InputError: there is no such run, or its table is missing, empty, short of a channel, or not numeric.
        """
        if run not in self.runs:
            permitted = ", ".join(self.runs)
            problem = f"{self.folder}: no run is called '{run}'{nearest(run, self.runs)}; permitted: {permitted}"
            raise InputError(problem)
        path = self.folder / self.runs[run].file
        table = dict(_read_table(path, tuple(self.channels), _stamp(path)))
        table |= {name: table[name] * factor + zero for name, (factor, zero) in self.conversions.items()}
        return table | {name: table[name] - constant for name, constant in self.removed.items()}

    def scenario_of(self, run: str, scenario: Scenario) -> Scenario:
        """Return a scenario with what the rig's owner changed for a run; see `seatsim.scenario.numbers.change_numbers`.

        Raises:
            InputError: the scenario does not have a number that the run sets.
        """
        changes = self.runs[run].set
        if not changes:
            return scenario
        own = list_numbers(scenario)
        for key in changes:
            if key not in own:
                problem = f"sets '{key}', which scenario '{scenario.name}' does not have{nearest(key, own)}"
                raise InputError(f"{self.folder / HEADER}, run {run}: {problem}")
        return change_numbers(scenario, changes, self.nominal_numbers)


def _stamp(path: Path) -> _Stamp:
    """Return a value that changes with the content of a file, None where there is no file."""
    try:
        status = path.stat()
    except (OSError, ValueError):
        return None
    return status.st_ino, status.st_size, status.st_mtime_ns


def load_recording(folder: str | Path) -> Recording:
    """Read and check `recording.yaml` of a folder.

    Raises:
        InputError: a key or channel is unknown, missing or of the wrong unit.
    """
    kept, source = _load(Path(folder), _stamp(Path(folder) / HEADER))
    # A recording of its own, since its nominal scenario may have changed, or code that it names.
    recording = replace(kept)
    # The nominal scenario is read here only where something refers to its keys.
    if recording.header.own_tolerances or any(run.set for run in recording.runs.values()):
        check_against(recording.nominal, recording.header, recording.runs.values(), source)
    return recording


@lru_cache(maxsize=_KEPT)
def _load(folder: Path, stamp: _Stamp) -> tuple[Recording, Source]:
    if not is_there(folder / HEADER):
        lacks = "holds no recording.yaml" if folder.is_dir() else "no such folder with a recording.yaml"
        raise InputError(f"{folder}: {lacks}; give the folder of a recording, which seatsim import makes of your files")
    source = Source(folder / HEADER)
    data = source.data
    check_keys(data, _KEYS, source, ())
    stated = {name: data[name] for name in Header._fields if name in data}
    if "parameter_tolerance" in stated:
        stated["parameter_tolerance"] = read_tolerances(stated["parameter_tolerance"], source)
    header = build(Header, stated, source, ())
    gain = build(VoltageGain, data["actuator"], source, ("actuator",)).gain if "actuator" in data else None
    channels, conversions = _channels(data, source, header.rig)
    if "command_voltage" in channels and gain is None:
        raise source.error((), "key 'actuator' is missing; a command_voltage needs 'actuator: {gain: A/V}'")
    runs = read_runs(data.get("runs"), source)
    return Recording(folder, header, runs, channels, gain, conversions=conversions), source


def _channels(
    data: Mapping[str, object], source: Source, rig: str
) -> tuple[dict[str, ChannelEntry], dict[str, Conversion]]:
    """Return the channels with their noise in SI units, and conversions of those that are recorded in others."""
    known, needed = CHANNELS[rig], DRIVERS[rig]
    entries = mapping(data.get("channels", {}), source, ("channels",))
    check_keys(entries, known, source, ("channels",))
    channels, conversions = {}, {}
    for name, entry in entries.items():
        stated: ChannelEntry = build(ChannelEntry, entry, source, ("channels", name))
        with placed(source.place(("channels", name, "unit"))):
            found = conversion(stated.unit, known[name])
        channels[name] = ChannelEntry(known[name], abs(found.factor) * stated.noise_rms)
        if found != Conversion(1.0):
            conversions[name] = found
    if needed not in channels:
        raise source.error(("channels",), f"channel '{needed}' is missing; it drives the simulation of this rig")
    return channels, conversions


@lru_cache(maxsize=_KEPT)
def _read_table(path: Path, channels: tuple[str, ...], stamp: _Stamp) -> dict[str, Array]:
    frame = read_table(path)
    if len(frame) < 2:
        raise InputError(f"{path}: holds {len(frame)} rows; a run has at least two")
    missing = [name for name in channels if name not in frame]
    if missing:
        raise InputError(
            f"{path}: column '{missing[0]}' is missing{nearest(missing[0], map(str, frame))}; recording.yaml lists it"
        )
    table = {}
    for name in channels:
        values, bad = numbers(frame, name)
        if bad.size:
            raise InputError(f"{path}, line {bad[0] + 2}, {name}: not a finite number; {bad.size} rows are not")
        values.flags.writeable = False
        table[name] = values
    return table
