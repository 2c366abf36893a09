"""Files of data loggers and test stands: MDF 4, TDMS of LabVIEW, universal files (UFF58), and RPC III (MTS).

MDF is read by asammdf, TDMS by npTDMS, UFF58 by pyuff. Every channel group of MDF has its own time; wave forms of TDMS
state rate and start. In RPC III a header of keywords comes before groups of points, channel after channel in each. The
format is recalled, and compared with open readers of it: records of 128 bytes, a keyword of 32 and a value of 96, the
first three FORMAT, NUM_HEADER_BLOCKS (of 512 bytes) and NUM_PARAMS. A group holds PTS_PER_GROUP points of every
channel. Integers are `SCALE.CHAN_n` each, times INT_FULL_SCALE / 32768.
"""

from __future__ import annotations

import io
import logging
import struct
import tempfile
import zlib
from collections.abc import Hashable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import Channels, DataFile, Group, Signal, note_left_out, scalar, signals_of, stated_unit
from seatsim.schema.arrays import Array
from seatsim.schema.bounds import BYTES_OF_PART, Part, check_made, check_parts
from seatsim.schema.errors import InputError
from seatsim.schema.units import DIMENSIONS, conversion

if TYPE_CHECKING:
    from asammdf import MDF
    from asammdf.blocks.mdf_common import Group as MdfGroup
    from nptdms import TdmsChannel

_BEGIN = 64
"""Address of the first block."""
_LINKS = {1: "CA HL", 2: "SR", 3: "SI", 4: "CH DG", 5: "EV", 6: "HD CG", 8: "CN", 99: "FH AT", 10**6: "CC DL LD"}
_OWNED = {f"##{kind}".encode(): count for count, kinds in _LINKS.items() for kind in kinds.split()}
"""How many of its first links a block follows: those behind them refer back, to channels elsewhere."""
_PACKED = b"##DZ"
_LEADS_TO = {b"HD": (b"DG",), b"DG": (b"DG", b"CG"), b"CG": (b"CG", b"CN"), b"CN": (b"CN",)}
"""Kinds of blocks to which the first links of others lead: these are followed without a look at the kind."""
_EVENT_ABOVE = (1, 2)
"""Links of an event to the event above it and to the beginning of its range."""

_START = "wf_start_time"
_NEVER_SET = np.datetime64("1904-01-02")
"""LabVIEW counts from 1904 on: a start before this was never set."""


def read_mdf(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the channel groups; groups of the same time are one."""
    asammdf = need("asammdf", "MDF")
    # What it says of damaged blocks would stand beside the one error.
    logging.getLogger("asammdf").setLevel(logging.CRITICAL + 1)
    # A conversion that numexpr refuses would be handed to sympy, which runs its text as Python.
    vars(asammdf.blocks.v4_blocks)["lambdify"] = None
    # A file of which only a part could be read lacks what asammdf deletes as it closes it, which would print an error.
    asammdf.blocks.mdf_v4.MDF4.__del__ = _close
    vars(asammdf.blocks.mdf_v4)["debug_channel"] = lambda *_: None  # it prints a channel that cannot be read
    if content[8:9] != b"4":
        version = content[8:12].decode("latin-1")
        raise InputError(f"{path}: is MDF of version {version}; save it as version 4 (.mf4), or export it as CSV")
    check_parts([_BEGIN], lambda address: _follow_block(content, address), len(content))
    gathered = Channels()
    left_out: list[str] = []
    with asammdf.MDF(io.BytesIO(content)) as file:
        check_made(sum(_bytes_of(group) for group in file.groups), len(content), "what its groups state")
        for index, group in enumerate(file.groups):
            _check_places(group, len(content))
            master = file.masters_db.get(index)
            wanted = [(None, index, number) for number in range(len(group.channels)) if number != master]
            chosen = file.select(wanted, ignore_value2text_conversions=True) if wanted else []
            found = [each for each in chosen if each.samples.dtype.kind in "fiu" and each.samples.ndim == 1]
            left_out += [each.name for each in chosen if not any(each is other for other in found)]
            if found:
                signals = [Signal(each.name, each.unit or "", each.samples.astype(np.float64)) for each in found]
                gathered.add_timed(f"group {index + 1}", found[0].timestamps.astype(np.float64), signals)
    return DataFile(path, "", gathered.groups(), note_left_out("channels that hold no single numbers", left_out))


def _bytes_of(group: MdfGroup) -> int:
    """Return how many bytes the rows of a group make, as they stand and as numbers."""
    stated = group.channel_group
    size = stated.samples_byte_nr + stated.invalidation_bytes_nr
    return int(stated.cycles_nr) * max(int(size), 8 * len(group.channels))


def _check_places(group: MdfGroup, size: int) -> None:
    """Raise ValueError where rows lie beyond the file, or a channel beyond its rows: asammdf would read on there."""
    stated = group.channel_group
    rows, held = stated.cycles_nr * stated.samples_byte_nr, sum(block.original_size for block in group.data_blocks)
    is_beyond = any(block.address + block.compressed_size > size for block in group.data_blocks)
    if group.channels and (rows > held or is_beyond):
        raise ValueError(f"{rows} bytes of rows are stated, which are not there")
    marks = stated.invalidation_bytes_nr
    for channel in group.channels:
        if 8 * channel.byte_offset + channel.bit_offset + channel.bit_count > 8 * stated.samples_byte_nr:
            raise ValueError(f"channel {channel.name} lies beyond the end of its rows")
        if marks and channel.pos_invalidation_bit >= 8 * marks:
            raise ValueError(f"channel {channel.name} has its marks of invalid values beyond the end of its rows")


def _close(file: MDF) -> None:
    """Close what there is of a file."""
    with suppress(AttributeError):
        file.close()


def _follow_block(content: bytes, address: Hashable) -> Part:
    """Return what a block makes, and the blocks that it owns."""
    assert isinstance(address, int)  # what this function itself has returned
    kind = content[address : address + 4]
    if kind == _PACKED:
        return Part(_unpacked(content, address))
    if kind not in _OWNED or address + 24 > len(content):
        return Part(0)
    count = min(struct.unpack_from("<Q", content, address + 16)[0], _OWNED[kind], (len(content) - address - 24) // 8)
    links = list(struct.unpack_from(f"<{count}Q", content, address + 24))
    _check_kinds(content, kind[2:], links)
    if kind == b"##EV":
        links = [link for number, link in enumerate(links) if number not in _EVENT_ABOVE]
    if kind == b"##CN" and count > 5 and content[links[5] : links[5] + 4] == b"##CG":
        del links[5]  # a group of values of any length stands beside the group of the channel
    return Part(8 * count, tuple(link for link in links if 0 < link < len(content)))


def _check_kinds(content: bytes, kind: bytes, links: Sequence[int]) -> None:
    """Raise ValueError where a link leads to a block of another kind."""
    for link, wanted in zip(links, _LEADS_TO.get(kind, ()), strict=False):
        if link and content[link + 2 : link + 4] != wanted:
            problem = f"a block {kind.decode()} leads to address {link}, where no block {wanted.decode()} begins"
            raise ValueError(problem)


def _unpacked(content: bytes, address: int) -> int:
    """Return how many bytes a packed block states to make; ValueError where it makes more."""
    stated, packed = struct.unpack_from("<QQ", content, address + 32)
    check_made(stated, len(content), "a packed block")
    body = content[address + 48 : address + 48 + packed]
    if len(zlib.decompressobj().decompress(body, stated + 1)) > stated:
        raise ValueError(f"a packed block makes more than the {stated} bytes that it states")
    return int(stated)


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
