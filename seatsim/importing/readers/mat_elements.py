"""The elements of a MAT file of version 5, read in plain Python: a damaged file ends in an error, whatever it states.

After 128 bytes, of which the last two tell the byte order, come elements: a type, a number of bytes, and as many bytes,
filled up to eight. An array is an element of elements: flags, dimensions, a name, and its values or fields.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from math import prod
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Value = NDArray[np.generic] | str | dict[str, "Value"] | None
"""Numbers, a text, the fields of a structure; None for what is neither, such as cells and structures of many."""

HEADER = 128
NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
TEXTS = {2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
ARRAY, PACKED = 14, 15
"""Types of elements: numbers and texts by their types of numpy and encodings, arrays, packed elements."""
STRUCTURE, TEXT, NUMERIC = 2, 4, range(6, 16)
COMPLEX = 0x0800
"""Classes of arrays, and the flag of those that have an imaginary part too."""
DEEPEST = 16
LARGEST = 2**30
"""Bytes of a packed element once it is unpacked."""


class Element(NamedTuple):
    """An element: its type and its content."""

    kind: int
    content: bytes


def read_variables(content: bytes) -> dict[str, Value]:
    """Return the variables of a file by name.

    Raises:
        ValueError: the file is damaged.
    """
    order = {b"IM": "<", b"MI": ">"}.get(content[126:HEADER])
    if order is None:
        raise ValueError("it does not state the order of its bytes")
    found: dict[str, Value] = {}
    for element in split(content[HEADER:], order):
        variable = _unpack(element, order) if element.kind == PACKED else element
        if variable.kind == ARRAY:
            name, value = read_array(variable.content, order, 0)
            found[name] = value
    return found


def _unpack(element: Element, order: str) -> Element:
    try:
        content = zlib.decompressobj().decompress(element.content, LARGEST)
    except zlib.error as error:
        raise ValueError(f"a variable cannot be unpacked: {error}") from error
    return next(split(content, order), Element(PACKED, b""))


def split(content: bytes, order: str) -> Iterator[Element]:
    """Yield the elements that stand one after the other."""
    at = 0
    while at < len(content):
        if at + 8 > len(content):
            raise ValueError("it ends within an element")
        kind, size = struct.unpack_from(f"{order}II", content, at)
        begin = at + 8
        # Packed elements are not filled up.
        end = begin + size + (0 if kind == PACKED else -size % 8)
        if kind >> 16:  # a small one, whose content stands in the place of its size
            kind, size, begin, end = kind & 0xFFFF, kind >> 16, at + 4, at + 8
        if begin + size > len(content):
            raise ValueError(f"an element states {size} bytes, and {len(content) - begin} are left")
        yield Element(kind, content[begin : begin + size])
        at = end


def read_array(content: bytes, order: str, depth: int) -> tuple[str, Value]:
    """Return the name and the value of an array."""
    if depth > DEEPEST:
        raise ValueError(f"structures lie more than {DEEPEST} deep in each other")
    if not content:
        return "", None
    flags, dimensions, name, *parts = split(content, order)
    state, shape = int(numbers(flags, order)[0]), numbers(dimensions, order).astype(int).tolist()
    kind = state & 0xFF
    value: Value = None
    if kind == TEXT and parts:
        value = parts[0].content.decode(_encoding(parts[0], order), errors="replace")
    elif kind in NUMERIC and parts and not state & COMPLEX:
        value = numbers(parts[0], order)
        if any(size < 0 for size in shape) or prod(shape) != len(value):
            raise ValueError(f"an array of {shape} has {len(value)} numbers")
        value = value.reshape(shape, order="F")
    elif kind == STRUCTURE and prod(shape) == 1:
        value = _read_fields(parts, order, depth)
    return name.content.decode("latin-1"), value


def _read_fields(parts: list[Element], order: str, depth: int) -> dict[str, Value]:
    """Return the fields of a structure: the length of their names, the names, and an array for each."""
    length, names, *arrays = parts
    width = int(numbers(length, order)[0])
    if width < 1 or len(names.content) != width * len(arrays):
        raise ValueError(f"a structure names {len(names.content)} bytes of fields, and has {len(arrays)} of them")
    texts = [
        names.content[at : at + width].split(b"\0")[0].decode("latin-1") for at in range(0, len(names.content), width)
    ]
    return {text: read_array(each.content, order, depth + 1)[1] for text, each in zip(texts, arrays, strict=True)}


def numbers(element: Element, order: str) -> NDArray[np.generic]:
    """Return the numbers of an element."""
    if element.kind not in NUMBERS:
        raise ValueError(f"an element of the type {element.kind} stands where numbers should")
    return np.frombuffer(element.content, order + NUMBERS[element.kind])


def _encoding(element: Element, order: str) -> str:
    encoding = TEXTS.get(element.kind, "latin-1")
    return encoding if encoding in ("latin-1", "utf-8") else f"{encoding}-{'le' if order == '<' else 'be'}"
