"""Recordings of data loggers: MDF, read by asammdf, Dewesoft, read by the compiled library of its maker, and WAV.

Every channel group of an MDF file of version 3 or 4 has its own time. A WAV file of a recorder or an analyser, read by
scipy, holds shares of a full scale that it does not state.
"""

from __future__ import annotations

import io
import logging
import struct
import warnings
import zlib
from collections.abc import Hashable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import Channels, DataFile, Group, Signal, note_left_out
from seatsim.schema.arrays import Array
from seatsim.schema.bounds import Part, check_made, check_parts
from seatsim.schema.guarded import temporary_folder

if TYPE_CHECKING:
    from asammdf import MDF
    from asammdf.blocks.mdf_common import Group as MdfGroup

_BEGIN = 64
"""Address of the first block."""
_LINKS = {1: "CA HL", 2: "SR", 3: "SI", 4: "CH DG", 5: "EV", 6: "HD CG", 8: "CN", 99: "FH AT", 10**6: "CC DL LD"}
_OWNED_4 = {f"##{kind}".encode(): count for count, kinds in _LINKS.items() for kind in kinds.split()}
_OWNED_3 = {b"HD": 3, b"DG": 4, b"CG": 3, b"CN": 5}
"""How many of its first links a block follows: those behind them refer back, to channels elsewhere."""
_PACKED = b"##DZ"
_LEADS_TO = {b"HD": (b"DG",), b"DG": (b"DG", b"CG"), b"CG": (b"CG", b"CN"), b"CN": (b"CN",)}
"""Kinds of blocks to which the first links of others lead: these are followed without a look at the kind."""
_EVENT_ABOVE = (1, 2)
"""Links of an event to the event above it and to the beginning of its range."""
_EVEN = 0
"""Type of a channel whose samples have one distance."""
_LEFT_OUT = "channels that hold no single numbers, or are not read by dwdatareader"
_UNSIGNED_ZERO = 128.0
"""What samples of 8 bits, which alone are unsigned, have at rest."""


def read_mdf(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the channel groups; groups of the same time are one."""
    asammdf = need("asammdf", "MDF")
    # What it says of damaged blocks would stand beside the one error.
    logging.getLogger("asammdf").setLevel(logging.CRITICAL + 1)
    # A conversion that numexpr refuses would be handed to sympy, which runs its text as Python.
    for blocks in (need("asammdf.blocks.v4_blocks", "MDF"), need("asammdf.blocks.v2_v3_blocks", "MDF")):
        vars(blocks)["lambdify"] = None
    # A file of which only a part could be read lacks what asammdf deletes as it closes it, which would print an error.
    for version in ("3", "4"):
        vars(need(f"asammdf.blocks.mdf_v{version}", "MDF"))[f"MDF{version}"].__del__ = _close
    vars(asammdf.blocks.mdf_v4)["debug_channel"] = lambda *_: None  # it prints a channel that cannot be read
    _check_blocks(content)
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
    size = stated.samples_byte_nr + getattr(stated, "invalidation_bytes_nr", 0)
    return int(stated.cycles_nr) * max(int(size), 8 * len(group.channels))


def _check_places(group: MdfGroup, size: int) -> None:
    """Raise ValueError where rows lie beyond the file, or a channel beyond its rows: asammdf would read on there."""
    stated = group.channel_group
    rows, held = stated.cycles_nr * stated.samples_byte_nr, sum(block.original_size for block in group.data_blocks)
    is_beyond = any(block.address + block.compressed_size > size for block in group.data_blocks)
    if group.channels and (rows > held or is_beyond):
        raise ValueError(f"{rows} bytes of rows are stated, which are not there")
    marks = getattr(stated, "invalidation_bytes_nr", 0)
    for channel in group.channels:
        if hasattr(channel, "byte_offset"):  # of version 4
            start = 8 * channel.byte_offset + channel.bit_offset
        else:
            start = 8 * getattr(channel, "additional_byte_offset", 0) + channel.start_offset
        if start + channel.bit_count > 8 * stated.samples_byte_nr:
            raise ValueError(f"channel {channel.name} lies beyond the end of its rows")
        if marks and channel.pos_invalidation_bit >= 8 * marks:
            raise ValueError(f"channel {channel.name} has its marks of invalid values beyond the end of its rows")


def _close(file: MDF) -> None:
    """Close what there is of a file."""
    with suppress(AttributeError):
        file.close()


def _check_blocks(content: bytes) -> None:
    """Raise TooMuchError where blocks refer to themselves over others, or make too much together."""
    block = _block_4 if content[8:9] == b"4" else _block_3
    check_parts([_BEGIN], lambda address: block(content, address), len(content))


def _block_4(content: bytes, address: Hashable) -> Part:
    assert isinstance(address, int)  # what this function itself has returned
    kind = content[address : address + 4]
    if kind == _PACKED:
        return Part(_unpacked(content, address))
    if kind not in _OWNED_4 or address + 24 > len(content):
        return Part(0)
    count = min(struct.unpack_from("<Q", content, address + 16)[0], _OWNED_4[kind], (len(content) - address - 24) // 8)
    links = list(struct.unpack_from(f"<{count}Q", content, address + 24))
    _check_kinds(content, kind[2:], links, 2)
    if kind == b"##EV":
        links = [link for number, link in enumerate(links) if number not in _EVENT_ABOVE]
    if kind == b"##CN" and count > 5 and content[links[5] : links[5] + 4] == b"##CG":
        del links[5]  # a group of values of any length stands beside the group of the channel
    return Part(8 * count, tuple(link for link in links if 0 < link < len(content)))


def _check_kinds(content: bytes, kind: bytes, links: Sequence[int], before: int) -> None:
    """Raise ValueError where a link leads to a block of another kind, whose letters come after `before` others."""
    for link, wanted in zip(links, _LEADS_TO.get(kind, ()), strict=False):
        if link and content[link + before : link + before + 2] != wanted:
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


def _block_3(content: bytes, address: Hashable) -> Part:
    assert isinstance(address, int)
    kind, order = content[address : address + 2], "<" if content[24:26] == b"\0\0" else ">"
    count = min(_OWNED_3.get(kind, 0), (len(content) - address - 4) // 4)
    links = struct.unpack_from(f"{order}{max(0, count)}I", content, address + 4)
    _check_kinds(content, kind, links, 0)
    return Part(4 * len(links), tuple(link for link in links if 0 < link < len(content)))


def read_dewesoft(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the channels of single numbers: those of one rate as a group, those with times of their own as others."""
    dewesoft = need("dwdatareader", "Dewesoft")
    gathered, left_out = Channels(), list[str]()
    with temporary_folder() as folder:
        copy = folder / "file.dxd"  # the library opens files, and what was unpacked is none
        copy.write_bytes(content)
        with dewesoft.DWFile(str(copy)) as file:
            for channel in file.values():
                try:
                    times, values = channel.scaled()
                except (dewesoft.DWError, AttributeError):  # of messages on a bus, and of texts
                    times, values = np.empty(0), np.empty(0)
                signal = Signal(channel.long_name, channel.unit, values)
                if not len(times) or values.shape != times.shape or values.dtype.kind != "f":
                    left_out.append(signal.name)
                elif channel.channel_type == _EVEN:
                    gathered.add(path.stem, signal, channel.sample_rate, float(times[0]))
                else:
                    gathered.add_timed(path.stem, times, [signal])
    return DataFile(path, "", gathered.groups(), note_left_out(_LEFT_OUT, left_out))


def read_wav(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the channels, in the order of the file; integers become shares of the full scale, -1 to 1."""
    from scipy.io import wavfile

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wavfile.WavFileWarning)  # of parts that hold no samples
        warnings.filterwarnings("error", "Reached EOF", wavfile.WavFileWarning)
        rate, samples = wavfile.read(io.BytesIO(content))
    columns = _scale(samples.reshape(len(samples), -1))
    signals = tuple(Signal(f"channel_{k + 1}", "", column) for k, column in enumerate(columns.T))
    note = "a WAV file states neither names nor units: state unit and scale, the value at full scale, in the map"
    return DataFile(path, "", (Group(path.stem, signals, float(rate)),), (note,))


def _scale(samples: NDArray[np.generic]) -> Array:
    """Return samples as shares of the full scale; those of 24 bits fill the upper part of 32."""
    values = samples.astype(np.float64)
    if samples.dtype.kind == "u":
        return (values - _UNSIGNED_ZERO) / _UNSIGNED_ZERO
    return values / 2.0 ** (8 * samples.dtype.itemsize - 1) if samples.dtype.kind == "i" else values
