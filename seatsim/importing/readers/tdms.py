"""TDMS files, read by npTDMS; rate and start come from the wave form's properties."""

from __future__ import annotations

import io
import logging
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatsim.importing.optional import need
from seatsim.importing.readers.naming import scalar, signals_of
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import Array, DataFile, Group, Signal
from seatsim.schema.errors import InputError

if TYPE_CHECKING:
    from nptdms import TdmsChannel, TdmsGroup

UNITS = ("unit_string", "unit", "NI_UnitDescription", "Unit")


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the groups of a file; channels of a group with other lengths, rates or starts are a group of their own."""
    nptdms = need("nptdms", "TDMS")
    nptdms.log.log_manager.set_level(logging.ERROR)  # what it warns of is an error here
    file = nptdms.TdmsFile.read(io.BytesIO(content))
    if file.file_status.incomplete_final_segment:
        raise InputError(f"{path}: its last segment lacks data; the file is truncated: export it again")
    return DataFile(path, "", tuple(group for each in file.groups() for group in _groups(each)))


def _groups(group: TdmsGroup) -> Iterator[Group]:
    parts: dict[tuple[int, float | None, float | None], list[Signal]] = {}
    for channel in group.channels():
        step, start = (scalar(channel.properties.get(key)) for key in ("wf_increment", "wf_start_offset"))
        for signal in signals_of(channel.name, _values(channel), _unit(channel)):
            rate = 1.0 / step if step else None
            parts.setdefault((len(signal.values), rate, start), []).append(signal)
    for (_, rate, start), signals in parts.items():
        name = group.name if len(parts) == 1 else f"{group.name}, {signals[0].name}"
        yield Group(name, tuple(signals), rate, start)


def _values(channel: TdmsChannel) -> Array:
    values = channel[:]
    if values.dtype.kind == "M":
        return np.asarray((values - values[0]) / np.timedelta64(1, "s"), dtype=np.float64)
    return np.asarray(values)


def _unit(channel: TdmsChannel) -> str:
    return next((str(channel.properties[key]) for key in UNITS if channel.properties.get(key)), "")
