"""OpenCRG roads (ASAM OpenCRG 1.2, "Road data"): elevations of tracks beside a reference line, as text or binary.

`LRFI` and `LDFI` are text with fields of 10 and 20 characters, in lines of at most 80, and a new line for every cross
section; `KRBI` and `KDBI` are single and double precision, big endian, one number after the other.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import DataFile, Group, Signal
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError

_END = re.compile(rb"^\$\$[^\n]*\n", re.MULTILINE)
_FIELD = {"LRFI": 10, "LDFI": 20}
_BINARY = {"KRBI": ">f4", "KDBI": ">f8"}
_RECORD = 80
_DISTANCE = "distance"


class _Definition(NamedTuple):
    """What the header states: kind of numbers, names of the channels, keywords of the road."""

    kind: str
    channels: tuple[str, ...]
    road: dict[str, float]


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the tracks of a road, called `z at V m`, over the distance along its reference line.

    Raises:
        InputError: the header has no end or defines no track, or the data are of another kind or truncated.
    """
    end = _END.search(content)
    if end is None:
        raise InputError(f"{path}: its header has no end ($$); the file is truncated: export it again")
    defined = _definition(content[: end.start()].decode("latin-1"))
    if defined.kind not in {*_FIELD, *_BINARY} or not any(_is_track(name) for name in defined.channels):
        permitted = f"{', '.join([*_FIELD, *_BINARY])} with long sections"
        raise InputError(
            f"{path}: its numbers are '{defined.kind}', with {len(defined.channels)} channels; permitted: {permitted}"
        )
    table = _numbers(content[end.end() :], defined)
    stated = _rows(defined.road)
    if stated and len(table) < stated:
        raise InputError(f"{path}: has {len(table)} of {stated} cross sections; the file is truncated: export it again")
    table = table[:stated] if stated else table
    step = defined.road.get("REFERENCE_LINE_INCREMENT", 0.01)
    tracks = [index for index, name in enumerate(defined.channels) if _is_track(name)]
    places = _places(defined, [defined.channels[index] for index in tracks])
    distance = Signal(_DISTANCE, "m", np.arange(len(table), dtype=np.float64) * step)
    signals = [Signal(f"z at {v:+.2f} m", "m", table[:, index]) for v, index in zip(places, tracks, strict=True)]
    return DataFile(path, "", (Group("", (distance, *signals), is_road=True),))


def _definition(header: str) -> _Definition:
    kind, channels, road, section = "", [], {}, ""
    for line in header.splitlines():
        text = line[:72].split("!")[0].strip()
        if text.startswith("$"):
            section = text[1:].strip().upper()
        elif section == "ROAD_CRG" and "=" in text:
            key, _, value = text.partition("=")
            if re.fullmatch(r"[-+.\deE]+", value.strip()):
                road[key.strip().upper()] = float(value)
        elif section == "KD_DEFINITION" and text.startswith("#:"):
            kind = text[2:].strip().upper()
        elif section == "KD_DEFINITION" and text[:2] in ("D:", "U:", "V:"):
            if text.startswith("D:"):
                channels.append(text[2:].strip())
            _reference(text, road)
    return _Definition(kind, tuple(channels), road)


def _reference(text: str, road: dict[str, float]) -> None:
    """Take start and increment of a reference line that is a virtual channel, `U:reference line u,m,0,0.01`."""
    parts = [part.strip() for part in text.split(",")]
    if text.startswith("U:") and len(parts) >= 4:
        road.setdefault("REFERENCE_LINE_START_U", float(parts[2]))
        road.setdefault("REFERENCE_LINE_INCREMENT", float(parts[3]))


def _is_track(channel: str) -> bool:
    return channel.lower().startswith("long section")


def _rows(road: dict[str, float]) -> int | None:
    """Return how many cross sections the header states, None where it leaves that open."""
    step, end = road.get("REFERENCE_LINE_INCREMENT"), road.get("REFERENCE_LINE_END_U")
    if not step or end is None:
        return None
    return round((end - road.get("REFERENCE_LINE_START_U", 0.0)) / step) + 1


def _places(defined: _Definition, tracks: list[str]) -> Array:
    """Return where the tracks lie beside the reference line, in m, positive to the left."""
    stated = [re.search(r"v\s*=\s*([-+.\deE]+)", track) for track in tracks]
    if all(stated):
        return np.array([float(found[1]) for found in stated if found])
    middle = 0.5 * (len(tracks) - 1)
    step = defined.road.get("LONG_SECTION_V_INCREMENT", 1.0)
    right = defined.road.get("LONG_SECTION_V_RIGHT", -middle * step)
    if "LONG_SECTION_V_INCREMENT" not in defined.road and "LONG_SECTION_V_LEFT" in defined.road and len(tracks) > 1:
        step = (defined.road["LONG_SECTION_V_LEFT"] - right) / (len(tracks) - 1)
    return np.asarray(right + step * np.arange(len(tracks)), dtype=np.float64)


def _numbers(body: bytes, defined: _Definition) -> Array:
    """Return the data, shape (cross sections, channels), NaN where the road was not measured."""
    count = len(defined.channels)
    if defined.kind in _BINARY:
        size = np.dtype(_BINARY[defined.kind]).itemsize
        values = np.frombuffer(body[: len(body) // size * size], dtype=_BINARY[defined.kind]).astype(np.float64)
        table = values[: len(values) // count * count].reshape(-1, count)
        # The last record is filled up with NaN, which may make further rows without any elevation.
        while len(table) and np.isnan(table[-1]).all():
            table = table[:-1]
        return table
    width = _FIELD[defined.kind]
    per_row = -(-count * width // _RECORD)
    lines = [line for line in body.decode("latin-1").splitlines() if line.strip()]
    rows = [
        "".join(line.ljust(_RECORD)[:_RECORD] for line in lines[at : at + per_row])
        for at in range(0, len(lines), per_row)
    ]
    cells = [[row[width * column : width * (column + 1)].strip() for column in range(count)] for row in rows]
    return np.array([[np.nan if cell.startswith("*") else float(cell) for cell in row] for row in cells])
