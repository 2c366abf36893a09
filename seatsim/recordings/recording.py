"""A recording of a rig: `recording.yaml`, its nominal scenario, a table per run, and the channels that it may have.

Two recordings of one rig can be taken as one.
"""

from collections.abc import Iterator, Mapping
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
from seatsim.schema.fields import param, read_packaged
from seatsim.schema.guarded import is_there
from seatsim.schema.tables import read_finite, read_table
from seatsim.schema.units import Conversion, conversion
from seatsim.schema.validation import build, check_keys, mapping
from seatsim.schema.yaml_source import Source

CHANNELS = read_packaged(Path(__file__).with_name("channels.yaml"), dict[str, dict[str, str]])
"""Channels by rig, each with its unit."""
SEAT_CHANNELS, BENCH_CHANNELS = CHANNELS["seat"], CHANNELS["damper_bench"]
DRIVERS = {"seat": "floor_acceleration", "damper_bench": "displacement"}
"""Channel of the excitation by rig, without which no recording of it can be replayed."""
ACCELEROMETERS = ("floor_acceleration", "frame_acceleration", "driver_acceleration")
MOTION = (*ACCELEROMETERS, "suspension_displacement", "displacement", "velocity", "damper_force")
"""Channels of motion and force, which swing about zero and are never at rest for long."""
COMMANDS = ("current_command", "command_voltage")
"""Channels that are logged and not measured: they have no noise, and hold each value until the next row."""
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
        hint = nearest(missing[0], map(str, frame))
        raise InputError(f"{path}: column '{missing[0]}' is missing{hint}; recording.yaml lists it")
    table = {}
    for name in channels:
        values = read_finite(frame, name, path, "correct it, or cut the run there")
        values.flags.writeable = False
        table[name] = values
    return table


def join_recordings(first: Recording, second: Recording) -> tuple[Recording, list[str]]:
    """Return the runs of two recordings as one recording, and sentences on what differs between them.

    Nominal scenario, tolerances and model error are those of the first; what either accepts is accepted. A run of the
    second whose name is taken gets `after-` before it; the larger noise of a channel counts.

    Raises:
        InputError: rig, sample rate or nominal scenario differ, or the recordings share no channel of the current.
    """
    _check_alike(first, second)
    shared = [name for name in first.channels if name in second.channels]
    both = {name: (first.channels[name], second.channels[name]) for name in shared}
    channels = {name: max(entries, key=lambda entry: entry.noise_rms) for name, entries in both.items()}
    runs = first.runs | {entry.name: entry for entry in _rename(first, second)}
    header = first.header._replace(accept=(*first.header.accept, *second.header.accept))
    return replace(first, header=header, runs=runs, channels=channels), [*_say(first, second, shared)]


def _check_alike(first: Recording, second: Recording) -> None:
    """Raise InputError where two recordings cannot be of one rig, driven in one way."""
    place = second.folder / HEADER
    for key in ("rig", "sample_rate"):
        stated, other = getattr(second.header, key), getattr(first.header, key)
        if stated != other:
            raise InputError(f"{place}, {key}: {stated} is not permitted beside {first.folder / HEADER}: {key} {other}")
    if first.voltage_gain != second.voltage_gain and {"command_voltage"} <= set(first.channels) & set(second.channels):
        gains = f"{second.voltage_gain:g} A/V is not permitted beside {first.voltage_gain:g} A/V"
        raise InputError(f"{place}, actuator.gain: {gains} of {first.folder / HEADER}")
    for name in first.channels:
        if name in second.channels and first.conversions.get(name) != second.conversions.get(name):
            problem = f"{place}, channels.{name}.unit: is another one than in {first.folder / HEADER}; use one unit"
            raise InputError(problem)
    _check_nominals(first, second)
    driven = [{name for name in CURRENTS if name in each.channels} for each in (first, second)]
    if any(driven) and not driven[0] & driven[1]:
        named = [" and ".join(sorted(each)) or "no current" for each in driven]
        problem = f"has {named[1]}, and {first.folder / HEADER} has {named[0]}; record one of them in both"
        raise InputError(f"{place}, channels: {problem}")


def _check_nominals(first: Recording, second: Recording) -> None:
    one, other = first.nominal, second.nominal
    if type(one.damper.record) is not type(other.damper.record) or one.effects != other.effects:
        raise InputError(f"{second.nominal_file}: has another damper model or other effects than {first.nominal_file}")
    numbers, others = first.nominal_numbers, second.nominal_numbers
    for key in [*numbers, *others]:
        if numbers.get(key) != others.get(key):
            text = f"{key}: {others.get(key)} is not permitted beside {numbers.get(key)} of {first.nominal_file}"
            advice = "state under 'set' of its runs what was changed on purpose"
            raise InputError(f"{second.nominal_file}, {text}; {advice}")


def _rename(first: Recording, second: Recording) -> Iterator[RunEntry]:
    """Yield the runs of the second recording under free names, with the full paths of their tables."""
    names: dict[str, str] = {}
    for name in second.runs:
        free = name
        while free in first.runs or free in names.values():
            free = f"after-{free}"
        names[name] = free
    for name, entry in second.runs.items():
        repeated = names[entry.repeat_of] if entry.repeat_of is not None else None
        file = str((second.folder / entry.file).resolve())
        yield entry._replace(name=names[name], file=file, repeat_of=repeated)


def _say(first: Recording, second: Recording, shared: list[str]) -> Iterator[str]:
    """Yield a sentence on each thing that differs and is not an error."""
    for one, other in ((first, second), (second, first)):
        dropped = [name for name in one.channels if name not in shared]
        if dropped:
            remedy = f"what it alone shows needs a diagnosis of {one.folder.name} alone"
            yield f"{', '.join(dropped)}: left out, since {other.folder.name} does not have it; {remedy}"
    for name in shared:
        noises = first.channels[name].noise_rms, second.channels[name].noise_rms
        if noises[0] != noises[1]:
            yield f"{name}: noise_rms is stated as {noises[0]:g} and {noises[1]:g}; the larger counts"
    for key in ("parameter_tolerance", "model_error"):
        if getattr(first.header, key) != getattr(second.header, key):
            yield f"{key}: that of {first.folder.name} counts, {second.folder.name} states another"
