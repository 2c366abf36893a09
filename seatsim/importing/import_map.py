"""`map.yaml`: which column is which channel, in which unit, and what is to be corrected; read, and written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

from seatsim.importing.readers.reading import TextLayout
from seatsim.recordings.recording import CHANNELS, DRIVERS
from seatsim.schema.errors import InputError, nearest, placed
from seatsim.schema.fields import param
from seatsim.schema.files import write_text
from seatsim.schema.text import explain_bad_name
from seatsim.schema.units import conversion
from seatsim.schema.validation import build, check_keys, is_finite_number, mapping
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import dump

Rig = Literal["seat", "damper_bench"]
Gaps = Literal["split", "fill"]
_AS_FOUND = TextLayout()
"""Layout of a text table that is left to be found."""
FILE = "map.yaml"
PRIMITIVE = {("m/s^2", 1): "m/s", ("m/s^2", 2): "m", ("m/s", 1): "m"}
"""Unit of what is differentiated so many times, by the unit of the derivative."""


class ChannelMap(NamedTuple):
    """Where a channel comes from and how it becomes SI: `sign * scale * column + offset` is in `unit`.

    `group` names the file or the group where several have the column. `minus` is a second column that is subtracted,
    `differentiate` how often the result is differentiated by time, `value` a constant in place of a column. `delay` is
    how much too late the channel is, in s; `remove_mean`, `fill` (rows that hold no number) and `despike` correct.
    """

    column: str | None = None
    unit: str | None = None
    sign: Literal[1, -1] = 1
    scale: Annotated[float, param("-", "factor before the unit")] = 1.0
    offset: Annotated[float, param("", "added after the factor, in the unit")] = 0.0
    remove_mean: bool = False
    delay: Annotated[float, param("s", "how much too late the channel is", low=-60, high=60)] = 0.0
    group: str | None = None
    minus: str | None = None
    differentiate: Literal[0, 1, 2] = 0
    value: Annotated[float | None, param("", "constant in place of a column")] = None
    fill: bool = False
    despike: bool = False
    noise_rms: Annotated[float | None, param("", "noise of the sensor in SI units", low=0)] = None


class AxisMap(NamedTuple):
    """The column of time."""

    column: str
    unit: str = ""


class _Actuator(NamedTuple):
    """Commanded current per volt of `command_voltage`."""

    gain: Annotated[float, param("A/V", "commanded current per volt")]


class _Numbers(NamedTuple):
    """The numbers at the top of a map."""

    sample_rate: Annotated[
        float | None, param("Hz", "rows per second of files that have no time", low=1e-3, high=1e6)
    ] = None
    resample: Annotated[float | None, param("Hz", "rows per second of the recording", low=1.0, high=1e6)] = None
    rig: Rig = "seat"
    gaps: Gaps | None = None


@dataclass(frozen=True)
class ImportMap:
    """The content of `map.yaml`.

    `runs` lists the files of each run, none where every file is one. `align` holds by file what is added to its times
    in s. `repeats` names by run the one that it repeats. `comments` stand behind the channels of a proposal.
    """

    channels: dict[str, ChannelMap]
    rig: Rig = "seat"
    time: AxisMap | None = None
    sample_rate: float | None = None
    csv: TextLayout = _AS_FOUND
    resample: float | None = None
    runs: dict[str, list[str]] = field(default_factory=dict)
    gaps: Gaps | None = None
    align: dict[str, float] = field(default_factory=dict)
    actuator: _Actuator | None = None
    repeats: dict[str, str] = field(default_factory=dict)
    comments: Mapping[str, str] = field(default_factory=dict)


def read_map(path: Path) -> ImportMap:
    """Read and check a map.

    Raises:
        InputError: a key, a channel or a value is not permitted.
    """
    source = Source(path)
    data = source.data
    check_keys(data, [each.name for each in fields(ImportMap) if each.name != "comments"], source, ())
    numbers: _Numbers = build(_Numbers, {key: data[key] for key in _Numbers._fields if key in data}, source, ())
    channels = mapping(data.get("channels", {}), source, ("channels",))
    rig: Rig = numbers.rig if "rig" in data else "damper_bench" if "displacement" in channels else "seat"
    repeats = mapping(data.get("repeats", {}), source, ("repeats",))
    return ImportMap(
        time=build(AxisMap, data["time"], source, ("time",)) if "time" in data else None,
        csv=build(TextLayout, data["csv"], source, ("csv",)) if "csv" in data else _AS_FOUND,
        actuator=build(_Actuator, data["actuator"], source, ("actuator",)) if "actuator" in data else None,
        channels=_channels(channels, rig, source),
        rig=rig,
        sample_rate=numbers.sample_rate,
        resample=numbers.resample,
        gaps=numbers.gaps,
        runs=_runs(data, source),
        align=_align(data, source),
        repeats={run: str(repeated) for run, repeated in repeats.items()},
    )


def _channels(entries: Mapping[str, object], rig: Rig, source: Source) -> dict[str, ChannelMap]:
    if not entries:
        raise source.error((), "key 'channels' is missing; write channels: {floor_acceleration: {column: a, unit: g}}")
    check_keys(entries, CHANNELS[rig], source, ("channels",))
    channels: dict[str, ChannelMap] = {}
    for name, entry in entries.items():
        channels[name] = build(ChannelMap, entry, source, ("channels", name))
        if (channels[name].column is None) == (channels[name].value is None):
            raise source.error(("channels", name), "give either the name of its column, or value for a constant")
        _check_unit(name, channels[name], CHANNELS[rig][name], source)
    if rig in DRIVERS and DRIVERS[rig] not in channels:
        raise source.error(("channels",), f"channel '{DRIVERS[rig]}' is missing; it drives the simulation of this rig")
    return channels


def _check_unit(name: str, entry: ChannelMap, wanted: str, source: Source) -> None:
    base = PRIMITIVE.get((wanted, entry.differentiate)) if entry.differentiate else wanted
    if base is None:
        problem = f"{entry.differentiate} is none for a channel in {wanted}; leave it out"
        raise source.error(("channels", name, "differentiate"), problem)
    if entry.unit:
        with placed(source.place(("channels", name, "unit"))):
            conversion(entry.unit, base)


def _runs(data: Mapping[str, object], source: Source) -> dict[str, list[str]]:
    runs = {}
    for name, files in mapping(data.get("runs", {}), source, ("runs",)).items():
        problem = explain_bad_name(name)
        if problem:
            raise source.error(("runs", name), f"{name!r} {problem}")
        if not isinstance(files, list) or not files or not all(isinstance(file, str) for file in files):
            raise source.error(("runs", name), "is no list of files; write run-a: [file1.csv, file2.csv]")
        runs[name] = files
    return runs


def _align(data: Mapping[str, object], source: Source) -> dict[str, float]:
    shifts = {}
    for name, value in mapping(data.get("align", {}), source, ("align",)).items():
        if not is_finite_number(value):
            raise source.error(("align", name), f"{value} is no finite number; write seconds, such as 0.25")
        shifts[name] = float(value)
    return shifts


def check_files(runs: Mapping[str, Sequence[str]], files: Sequence[str], path: Path) -> None:
    """Raise InputError at a file of a map's runs that was not given."""
    for run, names in runs.items():
        for name in names:
            if name not in files:
                problem = f"{path}, runs.{run}: '{name}' was not given{nearest(name, files)}; given: {', '.join(files)}"
                raise InputError(problem)


def write_map(path: Path, stated: ImportMap) -> Path:
    """Write a map as it is read, with a line for each channel and the comments behind them."""
    return write_text(path, render_map(stated))


def render_map(stated: ImportMap) -> str:
    """Return the text of a map."""
    content: dict[str, object] = {"rig": stated.rig, "time": stated.time and stated.time._asdict()}
    content |= {"sample_rate": stated.sample_rate, "resample": stated.resample}
    content |= {"channels": {name: _shown(channel) for name, channel in stated.channels.items()}}
    content |= {"csv": {key: value for key, value in stated.csv._asdict().items() if value is not None}}
    content |= {"gaps": stated.gaps, "actuator": stated.actuator and stated.actuator._asdict()}
    content |= {"align": {label: float(f"{value:.7g}") for label, value in stated.align.items()}}
    content |= {"repeats": stated.repeats, "runs": stated.runs}
    lines = dump({key: value for key, value in content.items() if value not in (None, {})}).splitlines()
    behind = {f"  {name}": f"   # {comment}" for name, comment in stated.comments.items()}
    return "".join(f"{line}{behind.get(line.partition(':')[0], '')}\n" for line in lines)


def _shown(channel: ChannelMap) -> dict[str, object]:
    """Return the keys of a channel that are stated, and those that a user edits."""
    shown = {"column", "unit", "sign"} if channel.value is None else {"value", "unit"}
    usual = ChannelMap._field_defaults
    return {key: value for key, value in channel._asdict().items() if key in shown or value != usual[key]}
