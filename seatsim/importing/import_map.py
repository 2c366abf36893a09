"""`map.yaml`: which column is which channel, in which unit, and what is to be corrected; read, and written."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field

from seatsim.importing.readers.reading import TextLayout
from seatsim.recordings.recording import CHANNELS, DRIVERS, VoltageGain
from seatsim.schema.errors import InputError, nearest, placed
from seatsim.schema.fields import param
from seatsim.schema.files import write_text
from seatsim.schema.text import explain_bad_name
from seatsim.schema.units import conversion
from seatsim.schema.validation import build, check_keys, mapping
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import dump

Rig = Literal["seat", "damper_bench"]
FILE = "map.yaml"
PRIMITIVE = {("m/s^2", 1): "m/s", ("m/s^2", 2): "m", ("m/s", 1): "m"}
"""Unit of what is differentiated so many times, by the unit of the derivative."""


class ChannelMap(NamedTuple):
    """Where a channel comes from and how it becomes SI: `sign * scale * column + offset` is in `unit`.

    `group` names the file or the group where several have the column. `minus` is a second column that is subtracted,
    `differentiate` how often the result is differentiated by time, `value` a constant in place of a column. `delay` is
    how much too late the channel is, in s; `remove_mean` and `fill` (rows that hold no number) correct.
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
    noise_rms: Annotated[float | None, param("", "noise of the sensor in SI units", low=0)] = None


class AxisMap(NamedTuple):
    """The column of time."""

    column: str
    unit: str = ""


class ImportMap(NamedTuple):
    """The content of `map.yaml`.

    `runs` lists the files of each run, none where every file is one. `align` holds by file what is added to its times
    in s. `repeats` names by run the one that it repeats.
    """

    channels: Mapping[str, ChannelMap]
    rig: Rig = "seat"
    time: AxisMap | None = None
    sample_rate: Annotated[
        float | None, param("Hz", "rows per second of files that have no time", low=1e-3, high=1e6)
    ] = None
    resample: Annotated[float | None, param("Hz", "rows per second of the recording", low=1.0, high=1e6)] = None
    csv: TextLayout = TextLayout()
    gaps: Literal["split"] | None = None
    actuator: VoltageGain | None = None
    align: Mapping[str, float] = {}
    repeats: Mapping[str, str] = {}
    runs: Mapping[str, Annotated[tuple[str, ...], Field(min_length=1)]] = {}

    @property
    def columns(self) -> set[str | None]:
        """Columns that channels are taken from."""
        return {name for entry in self.channels.values() for name in (entry.column, entry.minus)}


_KEYS = ("rig", "time", "sample_rate", "resample", "channels", "csv", "gaps", "actuator", "align", "repeats", "runs")
"""Keys of a file, in the order in which they are written."""
_PARTS: Mapping[str, type] = {"time": AxisMap, "csv": TextLayout, "actuator": VoltageGain}


def read_map(path: Path) -> ImportMap:
    """Read and check a map.

    Raises:
        InputError: a key, a channel or a value is not permitted.
    """
    source = Source(path)
    check_keys(source.data, _KEYS, source, ())
    channels = mapping(source.data.get("channels", {}), source, ("channels",))
    stated = {"rig": "damper_bench" if "displacement" in channels else "seat", **source.data, "channels": {}}
    parts: dict[str, Any] = {  # records of several kinds, each checked for keys that it does not know
        key: build(part, stated.pop(key), source, (key,)) for key, part in _PARTS.items() if key in stated
    }
    found: ImportMap = build(ImportMap, stated, source, ())
    for name in found.runs:
        if problem := explain_bad_name(name):
            raise source.error(("runs", name), f"{name!r} {problem}")
    return found._replace(channels=_channels(channels, found.rig, source), **parts)


def _channels(entries: Mapping[str, object], rig: Rig, source: Source) -> dict[str, ChannelMap]:
    if not entries:
        raise source.error((), "key 'channels' is missing; write channels: {floor_acceleration: {column: a, unit: g}}")
    check_keys(entries, CHANNELS[rig], source, ("channels",))
    channels: dict[str, ChannelMap] = {}
    for name, content in entries.items():
        entry = channels[name] = build(ChannelMap, content, source, ("channels", name))
        if (entry.column is None) == (entry.value is None):
            raise source.error(("channels", name), "give either the name of its column, or value for a constant")
        wanted, times = CHANNELS[rig][name], entry.differentiate
        base = PRIMITIVE.get((wanted, times)) if times else wanted
        if base is None:
            problem = f"{times} is none for a channel in {wanted}; leave it out"
            raise source.error(("channels", name, "differentiate"), problem)
        with placed(source.place(("channels", name, "unit"))):
            conversion(entry.unit or base, base)
    if DRIVERS[rig] not in channels:
        raise source.error(("channels",), f"channel '{DRIVERS[rig]}' is missing; it drives the simulation of this rig")
    return channels


def check_files(runs: Mapping[str, Sequence[str]], files: Sequence[str], path: Path) -> None:
    """Raise InputError at a file of a map's runs that was not given."""
    for run, names in runs.items():
        for name in names:
            if name not in files:
                problem = f"{path}, runs.{run}: '{name}' was not given{nearest(name, files)}; given: {', '.join(files)}"
                raise InputError(problem)


def write_map(path: Path, stated: ImportMap) -> Path:
    """Write a map as it is read, with a line for each channel."""
    return write_text(path, render_map(stated))


def render_map(stated: ImportMap) -> str:
    """Return the text of a map."""
    parts = {key: part._asdict() if (part := getattr(stated, key)) else {} for key in _PARTS}
    content = stated._asdict()
    content |= {key: {name: value for name, value in part.items() if value is not None} for key, part in parts.items()}
    content["channels"] = {name: _shown(channel) for name, channel in stated.channels.items()}
    content["align"] = {label: float(f"{value:.7g}") for label, value in stated.align.items()}
    content["runs"] = {name: list(files) for name, files in stated.runs.items()}
    return dump({key: content[key] for key in _KEYS if content[key] not in (None, {})})


def _shown(channel: ChannelMap) -> dict[str, object]:
    """Return the keys of a channel that are stated, and those that a user edits."""
    shown = {"column", "unit", "sign"} if channel.value is None else {"value", "unit"}
    usual = ChannelMap._field_defaults
    return {key: value for key, value in channel._asdict().items() if key in shown or value != usual[key]}
