"""RPC III time histories (MTS): a header of keywords, then groups of points, channel after channel in each.

The format is recalled, and compared with open readers of it: records of 128 bytes, a keyword of 32 and a value of 96,
the first three FORMAT, NUM_HEADER_BLOCKS (of 512 bytes) and NUM_PARAMS. A group holds PTS_PER_GROUP points of
every channel. Integers are `SCALE.CHAN_n` each, times INT_FULL_SCALE / 32768.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import DataFile, Group, Signal
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError

RECORD, KEYWORD, BLOCK = 128, 32, 512
FULL_SCALE = 32768
ORDERS = {"BINARY_IEEE_LITTLE_END": "<", "BINARY_IEEE_BIG_END": ">", "BINARY": "<"}
TYPES = {"SHORT_INTEGER": "i2", "FLOATING_POINT": "f4"}
NEEDED = ("NUM_HEADER_BLOCKS", "CHANNELS", "DELTA_T", "PTS_PER_FRAME", "PTS_PER_GROUP", "FRAMES")


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the channels of a time history as one group.

    Raises:
        InputError: a keyword is missing, the numbers are of an unknown kind, or there are fewer than stated.
    """
    header = _header(path, content)
    count, frames, per_frame, per_group = (
        int(header[key]) for key in ("CHANNELS", "FRAMES", "PTS_PER_FRAME", "PTS_PER_GROUP")
    )
    if min(count, frames, per_frame, per_group) < 1:
        raise InputError(
            f"{path}: states {count} channels of {frames} frames of {per_frame} points; each is at least 1"
        )
    kind, order = header.get("DATA_TYPE", "SHORT_INTEGER"), header.get("FORMAT", "BINARY")
    if kind not in TYPES or order not in ORDERS:
        permitted = f"{', '.join(TYPES)} in {', '.join(ORDERS)}"
        raise InputError(f"{path}: numbers are {kind} in {order}; permitted: {permitted}")
    values = np.frombuffer(content[int(header["NUM_HEADER_BLOCKS"]) * BLOCK :], dtype="u1")
    table = _demultiplex(path, values, ORDERS[order] + TYPES[kind], (count, frames * per_frame, per_group))
    scales = [_scale(header, number, kind) for number in range(1, count + 1)]
    signals = tuple(
        Signal(
            header.get(f"DESC.CHAN_{number}", f"channel {number}"), header.get(f"UNITS.CHAN_{number}", ""), scale * row
        )
        for number, (scale, row) in enumerate(zip(scales, table, strict=True), 1)
    )
    kept, notes = _kept(table, per_frame)
    signals = tuple(signal._replace(values=signal.values[:kept]) for signal in signals)
    return DataFile(path, "", (Group("", signals, 1.0 / float(header["DELTA_T"])),), notes)


def _kept(table: Array, per_frame: int) -> tuple[int, tuple[str, ...]]:
    """Return how many points there are without the zeros that fill the last frame, and a sentence on them."""
    used = np.flatnonzero(table[:, -per_frame:].any(axis=0))
    filled = per_frame - 1 - int(used[-1]) if len(used) else 0
    if not filled:
        return table.shape[1], ()
    return table.shape[1] - filled, (
        f"the last {filled} points of every channel are zero: they fill the last frame and are left out",
    )


def _header(path: Path, content: bytes) -> dict[str, str]:
    header: dict[str, str] = {}
    for start in range(0, len(content) - RECORD + 1, RECORD):
        record = content[start : start + RECORD]
        key, value = (
            part.split(b"\0")[0].decode("cp1252", "replace").strip() for part in (record[:KEYWORD], record[KEYWORD:])
        )
        if key:
            header[key] = value
        if start // RECORD + 1 >= int(header.get("NUM_PARAMS", "3")):
            break
    missing = [key for key in NEEDED if key not in header]
    if missing:
        raise InputError(f"{path}: its header states no {missing[0]}; it is no RPC III time history, or truncated")
    return header


def _demultiplex(path: Path, raw: np.ndarray, kind: str, shape: tuple[int, int, int]) -> Array:
    """Return points of every channel, shape (channels, points), from groups that are filled up to the last."""
    count, points, per_group = shape
    groups = -(-points // per_group)
    wanted, size = groups * per_group * count, np.dtype(kind).itemsize
    if len(raw) < wanted * size:
        stated = f"{count} channels of {points} points need {wanted * size} bytes"
        raise InputError(f"{path}: {stated} and {len(raw)} are there; the file is truncated: export it again")
    values = raw[: wanted * size].view(kind).astype(np.float64).reshape(groups, count, per_group)
    return values.transpose(1, 0, 2).reshape(count, -1)[:, :points]


def _scale(header: Mapping[str, str], number: int, kind: str) -> float:
    if kind == "FLOATING_POINT":
        return 1.0
    return float(header[f"SCALE.CHAN_{number}"]) * float(header.get("INT_FULL_SCALE", FULL_SCALE)) / FULL_SCALE
