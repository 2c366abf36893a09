"""Files of LabVIEW: TDMS, read by npTDMS, whose wave forms state rate and start, and LVM, which is text.

In the header of a segment of LVM a line has a cell for every channel: `Delta_X`, `X0`, `Y_Unit_Label`, `Date`, `Time`.
`X_Columns` says whether there is a column of x for all channels (`One`), one for each (`Multi`), or none (`No`).
"""

from __future__ import annotations

import io
import logging
from collections.abc import Iterator, Mapping, Sequence
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.readers.text import as_utf8
from seatsim.importing.signals import Channels, DataFile, Group, Signal, scalar, signals_of, stated_unit
from seatsim.schema.arrays import Array
from seatsim.schema.bounds import BYTES_OF_PART, check_made
from seatsim.schema.errors import InputError

if TYPE_CHECKING:
    from nptdms import TdmsChannel

_START = "wf_start_time"
_NEVER_SET = np.datetime64("1904-01-02")
"""LabVIEW counts from 1904 on: a start before this was never set."""
_END, _SPECIAL, _END_SPECIAL = "***End_of_Header***", "***Start_Special***", "***End_Special***"
_X, _REMARK, _NEXT = "X_Value", "Comment", "Channels"
"""Names of columns that are no channels, and the key with which the header of a segment begins."""
_ABSOLUTE = 1e8
"""s; a larger x counts from the year 1904, not from the moment that the segment states."""


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


class _Segment(NamedTuple):
    """Cells of a segment's header by key, the names of its columns, and its rows."""

    header: Mapping[str, list[str]]
    names: list[str]
    rows: list[str]

    def cells(self, key: str) -> list[str]:
        """Return what a line of the header says of each channel."""
        columns = self.channels()
        stated = self.header.get(key, [])
        filled = [cell.strip() for cell in stated if cell.strip()]
        if len(filled) == len(columns):
            return filled
        return [stated[column - 1].strip() if column <= len(stated) else "" for column in columns]

    def channels(self) -> list[int]:
        """Return the columns of the channels."""
        return [column for column, name in enumerate(self.names) if column and name not in (_X, _REMARK, "")]


class _Piece(NamedTuple):
    """What a segment holds of a channel: values, and times in s since `begins`, None where that is not stated."""

    signal: Signal
    times: Array
    begins: np.datetime64 | None


def read_lvm(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the channels of a file, those of the same times as one group; the pieces of a channel follow each other.

    Raises:
        InputError: a segment lacks rows, its x is no time, or a channel states no interval.
    """
    lines = as_utf8(content, layout.encoding).decode(errors="replace").splitlines()
    separator = next((line[9] for line in lines[:20] if line.startswith("Separator") and line[9:]), "\t")
    first = next((number for number, line in enumerate(lines) if line.startswith(_END)), len(lines))
    head = {key: value for key, _, value in (line.partition(separator) for line in lines[:first])}
    pieces: dict[tuple[int, str, str], list[_Piece]] = {}
    for segment in _segments(lines[first + 1 :], separator):
        table = _table(segment, separator, head.get("Decimal_Separator", "").strip(separator).strip() or ".")
        for column, piece in _pieces(segment, table, head.get("X_Columns", "One").strip(separator).strip(), path):
            pieces.setdefault((column, piece.signal.name, piece.signal.unit), []).append(piece)
    return DataFile(path, "", _join(list(pieces.values())))


def _segments(lines: Sequence[str], separator: str) -> Iterator[_Segment]:
    """Yield the segments, which blank lines part."""
    header: dict[str, list[str]] = {}
    rest = iter(lines)
    for line in rest:
        key, *cells = line.split(separator)
        if key == _SPECIAL:
            list(takewhile(lambda each: not each.startswith(_END_SPECIAL), rest))
        elif key == _END:
            names = [name.strip() for name in next(rest, "").split(separator)]
            rows = list(takewhile(lambda row: row.strip() and not row.startswith(_NEXT + separator), rest))
            yield _Segment(header, names, rows)
            header = {}
        elif key:
            header[key] = cells


def _table(segment: _Segment, separator: str, decimal: str) -> Array:
    """Return the numbers of a segment, shape (rows, columns), NaN where a cell is empty."""
    import pandas as pd

    remarks = [column for column, name in enumerate(segment.names) if name == _REMARK]
    columns = [column for column in range(len(segment.names)) if column not in remarks]
    if not segment.rows:
        return np.empty((0, len(segment.names)))
    numbers, text = dict.fromkeys(columns, np.float64), io.StringIO("\n".join(segment.rows))
    names = range(len(segment.names))
    frame = pd.read_csv(text, sep=separator, decimal=decimal, index_col=False, names=names, dtype=numbers)
    table = np.full(frame.shape, np.nan)
    table[:, columns] = frame[columns]
    return table


def _pieces(segment: _Segment, table: Array, x_columns: str, path: Path) -> Iterator[tuple[int, _Piece]]:
    """Yield the column and the content of every channel of a segment."""
    dimensions = [each for each in segment.cells("X_Dimension") if each.lower() not in ("time", "")]
    if dimensions:
        raise InputError(f"{path}: its X_Dimension is {dimensions[0]}; permitted is Time: export the time history")
    steps = [float(cell.replace(",", ".") or "nan") for cell in segment.cells("Delta_X")]
    zeros = [float(cell.replace(",", ".") or "0") for cell in segment.cells("X0")]
    samples = [int(cell or "0") for cell in segment.cells("Samples")]
    if len(table) < max(samples, default=0):
        raise InputError(f"{path}: has {len(table)} of {max(samples)} rows; the file is truncated: export it again")
    described = zip(segment.channels(), segment.cells("Y_Unit_Label"), _begins(segment), steps, zeros, strict=True)
    for column, unit, begins, step, zero in described:
        values = table[:, column]
        values = values[: int(np.max(np.flatnonzero(np.isfinite(values)), initial=-1)) + 1]
        # One column of x is that of the channel with the most samples.
        longest = steps[samples.index(max(samples))]
        own_x = {"Multi": column - 1, "One": 0 if step == longest or np.isnan(step) else None}.get(x_columns)
        times = table[: len(values), own_x] if own_x is not None else zero + step * np.arange(len(values))
        if np.isnan(times).any():
            raise InputError(f"{path}, {segment.names[column]}: states neither {_X} nor Delta_X in every row")
        is_absolute = len(times) > 0 and times[0] > _ABSOLUTE
        signal = Signal(segment.names[column], unit, values)
        yield column, _Piece(signal, np.asarray(times, dtype=np.float64), None if is_absolute else begins)


def _begins(segment: _Segment) -> list[np.datetime64 | None]:
    """Return the moment from which the x of each channel counts."""
    moments: list[np.datetime64 | None] = []
    for date, time in zip(segment.cells("Date"), segment.cells("Time"), strict=True):
        stated = f"{date.replace('/', '-')}T{time.replace(',', '.')[:18]}"
        moments.append(np.datetime64(stated, "ns") if date and time else None)
    return moments


def _join(channels: Sequence[Sequence[_Piece]]) -> tuple[Group, ...]:
    """Return channels as groups of the same times, counted from the first moment that any of them states."""
    first = min((each.begins for pieces in channels for each in pieces if each.begins is not None), default=None)
    gathered = Channels()
    for pieces in channels:
        times = [_since(first, each) for each in pieces]
        signal = pieces[0].signal._replace(values=np.concatenate([each.signal.values for each in pieces]))
        gathered.add_timed("", np.concatenate(times), [signal])
    return gathered.groups()


def _since(first: np.datetime64 | None, piece: _Piece) -> Array:
    if first is None or piece.begins is None:
        return piece.times
    return piece.times + float((piece.begins - first) / np.timedelta64(1, "s"))
