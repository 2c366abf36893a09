"""The blocks of an MDF file and what they refer to, so that no chain of them leads back or doubles without end.

Version 4: a block states its kind (`##CN`), its length and its links, addresses of 8 bytes. Version 3: a kind of two
letters, its length in 2 bytes, then addresses of 4 bytes, in the order of bytes that the file states.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Hashable, Sequence

from seatsim.schema.bounds import Part, check_made, check_parts

BEGIN = 64
"""Address of the first block."""
OWNED_4 = {
    b"##HD": 6, b"##FH": 99, b"##CH": 4, b"##AT": 99, b"##EV": 5, b"##DG": 4, b"##CG": 6, b"##CN": 8, b"##CC": 10**6,
    b"##CA": 1, b"##SI": 3, b"##SR": 2, b"##HL": 1, b"##DL": 10**6, b"##LD": 10**6,
}  # fmt: skip
OWNED_3 = {b"HD": 3, b"DG": 4, b"CG": 3, b"CN": 5}
"""How many of its first links a block follows: those behind them refer back, to channels elsewhere."""
PACKED = b"##DZ"
LEADS_TO = {
    (b"HD", 0): b"DG", (b"DG", 0): b"DG", (b"DG", 1): b"CG", (b"CG", 0): b"CG", (b"CG", 1): b"CN", (b"CN", 0): b"CN",
}  # fmt: skip
"""Kinds of blocks to which the first links of others lead: these are followed without a look at the kind."""
EVENT_ABOVE = (1, 2)
"""Links of an event to the event above it and to the beginning of its range."""


def check_blocks(content: bytes) -> None:
    """Raise TooMuchError where blocks refer to themselves over others, or make too much together."""
    if content[8:9] == b"4":
        check_parts([BEGIN], lambda address: _block_4(content, address), len(content))
    else:
        order = "<" if content[24:26] == b"\0\0" else ">"
        check_parts([BEGIN], lambda address: _block_3(content, address, order), len(content))


def _block_4(content: bytes, address: Hashable) -> Part:
    assert isinstance(address, int)  # what this function itself has returned
    kind = content[address : address + 4]
    if kind == PACKED:
        return Part(_unpacked(content, address))
    if kind not in OWNED_4 or address + 24 > len(content):
        return Part(0)
    count = min(struct.unpack_from("<Q", content, address + 16)[0], OWNED_4[kind], (len(content) - address - 24) // 8)
    links = list(struct.unpack_from(f"<{count}Q", content, address + 24))
    _check_kinds(content, kind[2:], links, 2)
    if kind == b"##EV":
        links = [link for number, link in enumerate(links) if number not in EVENT_ABOVE]
    if kind == b"##CN" and count > 5 and content[links[5] : links[5] + 4] == b"##CG":
        del links[5]  # a group of values of any length stands beside the group of the channel
    return Part(8 * count, tuple(link for link in links if 0 < link < len(content)))


def _check_kinds(content: bytes, kind: bytes, links: Sequence[int], before: int) -> None:
    """Raise ValueError where a link leads to a block of another kind, whose letters come after `before` others."""
    for number, link in enumerate(links):
        wanted = LEADS_TO.get((kind, number))
        if link and wanted and content[link + before : link + before + 2] != wanted:
            raise ValueError(
                f"a block {kind.decode()} leads to address {link}, where no block {wanted.decode()} begins"
            )


def _unpacked(content: bytes, address: int) -> int:
    """Return how many bytes a packed block states to make; ValueError where it makes more."""
    stated, packed = struct.unpack_from("<QQ", content, address + 32)
    check_made(stated, len(content), "a packed block")
    body = content[address + 48 : address + 48 + packed]
    if len(zlib.decompressobj().decompress(body, stated + 1)) > stated:
        raise ValueError(f"a packed block makes more than the {stated} bytes that it states")
    return int(stated)


def _block_3(content: bytes, address: Hashable, order: str) -> Part:
    assert isinstance(address, int)
    kind = content[address : address + 2]
    count = min(OWNED_3.get(kind, 0), (len(content) - address - 4) // 4)
    links = struct.unpack_from(f"{order}{max(0, count)}I", content, address + 4)
    _check_kinds(content, kind, links, 0)
    return Part(4 * len(links), tuple(link for link in links if 0 < link < len(content)))
