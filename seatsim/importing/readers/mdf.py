"""MDF files of versions 3 and 4, read by asammdf; every channel group has its own time."""

from __future__ import annotations

import io
import logging
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from seatsim.importing.readers.mdf_blocks import check_blocks
from seatsim.importing.readers.naming import note_left_out
from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import DataFile, Group, Signal, add_channels
from seatsim.schema.bounds import check_made


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
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
    check_blocks(content)
    groups: list[Group] = []
    left_out: list[str] = []
    with asammdf.MDF(io.BytesIO(content)) as file:
        check_made(sum(_bytes_of(group) for group in file.groups), len(content), "what its groups state")
        for index, group in enumerate(file.groups):
            _check_places(group, len(content))
            master = file.masters_db.get(index)
            wanted = [(None, index, number) for number in range(len(group.channels)) if number != master]
            chosen = file.select(wanted, ignore_value2text_conversions=True) if wanted else []
            found = [each for each in chosen if each.samples.dtype.kind in "fiu" and each.samples.ndim == 1]
            left_out += [each.name for each in chosen if each.samples.dtype.kind not in "fiu" or each.samples.ndim != 1]
            if found:
                signals = [Signal(each.name, each.unit or "", each.samples.astype(np.float64)) for each in found]
                add_channels(groups, f"group {index + 1}", found[0].timestamps.astype(np.float64), signals)
    return DataFile(path, "", tuple(groups), note_left_out("channels that hold no single numbers", left_out))


def _bytes_of(group: Any) -> int:
    """Return how many bytes the rows of a group make, as they stand and as numbers."""
    stated = group.channel_group
    size = stated.samples_byte_nr + getattr(stated, "invalidation_bytes_nr", 0)
    return int(stated.cycles_nr) * max(int(size), 8 * len(group.channels))


def _check_places(group: Any, size: int) -> None:
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


def _close(file: Any) -> None:
    """Close what there is of a file."""
    with suppress(AttributeError):
        file.close()
