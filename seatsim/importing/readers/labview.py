"""TDMS files of LabVIEW, read by npTDMS; their wave forms state rate and start."""

from __future__ import annotations

import io
import logging
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import Channels, DataFile, scalar, signals_of, stated_unit
from seatsim.schema.bounds import BYTES_OF_PART, check_made
from seatsim.schema.errors import InputError

if TYPE_CHECKING:
    from nptdms import TdmsChannel

_START = "wf_start_time"
_NEVER_SET = np.datetime64("1904-01-02")
"""LabVIEW counts from 1904 on: a start before this was never set."""


def read_tdms(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the groups of a file; channels of a group with other lengths, rates or starts are a group of their own.

    Starts are counted from the earliest that a channel states.
    """
    nptdms = need("nptdms", "TDMS")
    nptdms.log.log_manager.set_level(logging.ERROR)  # what it warns of is an error here
    described = nptdms.TdmsFile.read_metadata(io.BytesIO(content))
    stated = [channel for group in described.groups() for channel in group.channels()]
    check_made(sum(BYTES_OF_PART + 8 * len(channel) for channel in stated), len(content), "what its channels state")
    file = nptdms.TdmsFile.read(io.BytesIO(content))
    status = file.file_status
    if status.incomplete_final_segment or any(
        each.read_length < each.expected_length for each in (status.channel_statuses or {}).values()
    ):
        raise InputError(f"{path}: its last segment lacks data; the file is truncated: export it again")
    channels = [channel for group in file.groups() for channel in group.channels()]
    starts = [start for channel in channels if (start := _start_time(channel)) is not None]
    notes: list[str] = []
    gathered, first = Channels(), min(starts, default=None)
    for group in file.groups():
        for channel in group.channels():
            step, begin = _step(channel), _start(channel, first)
            signals = signals_of(channel.name, channel[:], stated_unit(channel.properties)) if len(channel) else []
            if not signals:
                notes.append(f"'{channel.name}' is left out: it holds no column of numbers")
            for signal in signals:
                gathered.add(group.name, signal, 1.0 / step if step else None, begin)
    lacking = [each.name for each in channels if len(each) and _step(each) and _start_time(each) is None]
    if starts and lacking:
        notes.append(f"no {_START} is stated of {', '.join(lacking)}: laid beside the channel that begins first")
    return DataFile(path, "", gathered.groups(), tuple(notes))


def _step(channel: TdmsChannel) -> float | None:
    return scalar(channel.properties.get("wf_increment"))


def _start(channel: TdmsChannel, first: np.datetime64 | None) -> float | None:
    """Return when a channel begins, in s after the one that begins first; None where it does not say."""
    offset, start = scalar(channel.properties.get("wf_start_offset")), _start_time(channel)
    if start is None or first is None:
        return offset
    return float((start - first) / np.timedelta64(1, "s")) + (offset or 0.0)


def _start_time(channel: TdmsChannel) -> np.datetime64 | None:
    stated = channel.properties.get(_START)
    return stated if isinstance(stated, np.datetime64) and stated > _NEVER_SET else None
