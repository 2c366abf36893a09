"""Time histories of test stands: universal files (UFF58), read by pyuff, and RPC III (MTS).

In RPC III a header of keywords comes before groups of points, channel after channel in each. The format is recalled,
and compared with open readers of it: records of 128 bytes, a keyword of 32 and a value of 96, the first three FORMAT,
NUM_HEADER_BLOCKS (of 512 bytes) and NUM_PARAMS. A group holds PTS_PER_GROUP points of every channel. Integers are
`SCALE.CHAN_n` each, times INT_FULL_SCALE / 32768.
"""

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TypeAlias

import numpy as np

from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import Channels, DataFile, Group, Signal, note_left_out
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.units import DIMENSIONS, conversion

_DataSet: TypeAlias = Mapping[str, "float | str | Array"]
_FUNCTION = 58
"""Type of a data set that is a function."""
_OVER_TIME, _TIME_AXIS = (0, 1), (0, 17)
"""Types of functions, and of the quantity along the abscissa (0 is not stated)."""
_OF_LINE = 6
"""Values of a line, up to which the last one is filled with zeros."""
_NAMES = ("rsp_ent_name", "id1", "id5", "ordinate_axis_lab", "id2")
_NONE = ("", "none", "notset", "not set", "general", "unknown")
_RECORD, _KEYWORD, _BLOCK = 128, 32, 512
_FULL_SCALE = 32768
_ORDERS = {"BINARY_IEEE_LITTLE_END": "<", "BINARY_IEEE_BIG_END": ">", "BINARY": "<"}
_TYPES = {"SHORT_INTEGER": "i2", "FLOATING_POINT": "f4"}
_NEEDED = ("NUM_HEADER_BLOCKS", "CHANNELS", "DELTA_T", "PTS_PER_FRAME", "PTS_PER_GROUP", "FRAMES")


def read_uff(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the time responses, those of equal length, step and start, or of the same times, as one group."""
    pyuff = need("pyuff", "UFF58")
    if not content.rstrip().endswith(b"-1"):
        raise InputError(f"{path}: its last data set has no end (-1); the file is truncated: export it again")
    gathered = Channels()
    others = []
    with tempfile.NamedTemporaryFile(suffix=".uff") as file:  # pyuff reads names of files alone
        file.write(content)
        file.flush()
        sets = pyuff.UFF(file.name)
        kinds = [int(kind) for kind in sets.get_set_types()]
        for index, kind in enumerate(kinds):
            held = sets.read_sets(index) if kind == _FUNCTION else {}
            reason = _why_not(kind, held)
            if reason:
                others.append(f"data set {index + 1} is {reason}")
                continue
            signal, times = _signal(f"{path}, data set {index + 1}", held)
            if held.get("abscissa_spacing") == 0:
                gathered.add_timed("", times, [signal])
            else:
                step = round(float(np.mean(np.diff(times))), 12) if len(times) > 1 else 0.0
                gathered.add("", signal, 1.0 / step if step else None, float(times[0]) if len(times) else 0.0)
    return DataFile(path, "", gathered.groups(), note_left_out("left out, as they are no responses over time", others))


def _why_not(kind: int, held: _DataSet) -> str:
    """Return what a data set is if it is no response over time, else an empty text."""
    if kind != _FUNCTION:
        return f"no function, but of type {kind}"
    function, axis = (int(held[key] or 0) for key in ("func_type", "abscissa_spec_data_type"))
    if function not in _OVER_TIME:
        return f"a function of type {function}, such as a spectrum"
    return "" if axis in _TIME_AXIS else f"a function over {str(held['abscissa_axis_lab']).strip() or axis}"


def _signal(place: str, held: _DataSet) -> tuple[Signal, Array]:
    """Return a channel and its times in s."""
    values, times = (np.real(np.asarray(held[key])).astype(np.float64) for key in ("data", "x"))
    stated = int(held["num_pts"])
    if min(len(values), len(times)) < stated:
        raise InputError(f"{place}: has {len(values)} of {stated} values; the file is truncated: export it again")
    if len(values) >= stated + _OF_LINE:
        raise InputError(f"{place}: has {len(values)} values where it states {stated}; correct the number of them")
    texts = {key: text for key, value in held.items() if (text := str(value).strip()).lower() not in _NONE}
    node = f"{held.get('rsp_node', '')}:{held.get('rsp_dir', '')}"
    name = next((texts[key] for key in _NAMES if key in texts), node)
    of_time = conversion(texts.get("abscissa_axis_units_lab", "s"), DIMENSIONS["time"]).factor
    return Signal(name, texts.get("ordinate_axis_units_lab", ""), values[:stated]), of_time * times[:stated]


def read_rpc(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the channels of a time history as one group.

    Raises:
        InputError: a keyword is missing, the numbers are of an unknown kind, or there are fewer than stated.
    """
    header = _header(path, content)
    keys = ("CHANNELS", "FRAMES", "PTS_PER_FRAME", "PTS_PER_GROUP")
    count, frames, per_frame, per_group = (int(header[key]) for key in keys)
    if min(count, frames, per_frame, per_group) < 1:
        stated = f"{count} channels of {frames} frames of {per_frame} points"
        raise InputError(f"{path}: states {stated}; each is at least 1")
    kind, order = header.get("DATA_TYPE", "SHORT_INTEGER"), header.get("FORMAT", "BINARY")
    if kind not in _TYPES or order not in _ORDERS:
        permitted = f"{', '.join(_TYPES)} in {', '.join(_ORDERS)}"
        raise InputError(f"{path}: numbers are {kind} in {order}; permitted: {permitted}")
    values = np.frombuffer(content[int(header["NUM_HEADER_BLOCKS"]) * _BLOCK :], dtype="u1")
    table = _demultiplex(path, values, _ORDERS[order] + _TYPES[kind], (count, frames * per_frame, per_group))
    used = np.flatnonzero(table[:, -per_frame:].any(axis=0))
    filled = per_frame - 1 - int(used[-1]) if len(used) else 0
    note = f"the last {filled} points of every channel are zero: they fill the last frame and are left out"
    whole = float(header.get("INT_FULL_SCALE", _FULL_SCALE))
    signals = []
    for number, row in enumerate(table[:, : table.shape[1] - filled], 1):
        name = header.get(f"DESC.CHAN_{number}", f"channel {number}")
        scale = 1.0 if kind == "FLOATING_POINT" else float(header[f"SCALE.CHAN_{number}"]) * whole / _FULL_SCALE
        signals.append(Signal(name, header.get(f"UNITS.CHAN_{number}", ""), scale * row))
    group = Group("", tuple(signals), 1.0 / float(header["DELTA_T"]))
    return DataFile(path, "", (group,), (note,) if filled else ())


def _header(path: Path, content: bytes) -> dict[str, str]:
    header: dict[str, str] = {}
    for start in range(0, len(content) - _RECORD + 1, _RECORD):
        record = content[start : start + _RECORD]
        parts = record[:_KEYWORD], record[_KEYWORD:]
        key, value = (part.split(b"\0")[0].decode("cp1252", "replace").strip() for part in parts)
        if key:
            header[key] = value
        if start // _RECORD + 1 >= int(header.get("NUM_PARAMS", "3")):
            break
    missing = [key for key in _NEEDED if key not in header]
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
