"""The variables of a MAT file of version 5 or 7.3 as plain values: numbers, texts, structures, and lists of them.

The elements of version 5 are read in plain Python: a damaged file ends in an error, whatever it states, where compiled
readers end the process.

After 128 bytes, of which the last two tell the byte order, come elements: a type, a number of bytes, and as many bytes,
filled up to eight. An array is an element of elements: flags, dimensions, a name, and its values, cells or fields. An
array without a name holds what objects such as tables are made of. A file of version 7.3 is one of HDF5, whose cells
and arrays of structures are references.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from seatsim.importing.readers.reading import HDF5, USER_BLOCK
from seatsim.importing.signals import as_text
from seatsim.schema.bounds import BYTES_OF_PART, check_made, permitted_of

if TYPE_CHECKING:
    import h5py

AnyArray: TypeAlias = NDArray[np.generic]
Value: TypeAlias = "AnyArray | str | dict[str, Value] | list[Value] | None"
"""Numbers, a text, a structure, cells or structures of many; None for an object and for what is none of these."""

_HEADER = 128
_ORDERS = {b"IM": "<", b"MI": ">"}
"""Bytes at the end of a header, and the order of bytes of which they tell."""
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXTS = {2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_ARRAY, _PACKED = 14, 15
"""Types of elements: numbers and texts by their types of numpy and encodings, arrays, packed elements."""
_CELLS, _STRUCTURE, _TEXT, _NUMERIC, _OPAQUE = 1, 2, 4, range(6, 16), 17
_COMPLEX = 0x0800
"""Classes of arrays, and the flag of those that have an imaginary part too."""
_DEEPEST = 32
"""How deep arrays may lie in each other."""
_REFERRED, _OBJECTS = "#refs#", "#subsystem#"
"""Folders of a file of version 7.3 that hold what its cells and structures refer to, and what its objects hold."""


class _Element(NamedTuple):
    """An element: its type and its content."""

    kind: int
    content: bytes


class _Elements:
    """Reads arrays in one order of bytes, as long as they make no more than a file of `size` bytes may."""

    def __init__(self, order: str, size: int) -> None:
        self.order, self.size, self.made = order, size, 0

    def count(self, made: int) -> None:
        """Add bytes that are about to be made; TooMuchError where they are too many."""
        self.made += made
        check_made(self.made, self.size)

    def split(self, content: bytes) -> Iterator[_Element]:
        """Yield the elements that stand one after the other."""
        at = 0
        while at < len(content):
            if at + 8 > len(content):
                raise ValueError("it ends within an element")
            kind, size = struct.unpack_from(f"{self.order}II", content, at)
            begin = at + 8
            # Packed elements are not filled up.
            end = begin + size + (0 if kind == _PACKED else -size % 8)
            if kind >> 16:  # a small one, whose content stands in the place of its size
                kind, size, begin, end = kind & 0xFFFF, kind >> 16, at + 4, at + 8
            if begin + size > len(content):
                raise ValueError(f"an element states {size} bytes, and {len(content) - begin} are left")
            self.count(BYTES_OF_PART)
            yield _Element(kind, content[begin : begin + size])
            at = end

    def unpack(self, element: _Element) -> _Element:
        """Return a variable, unpacked where it is packed."""
        if element.kind != _PACKED:
            return element
        try:
            content = zlib.decompressobj().decompress(element.content, permitted_of(self.size) + 1)
        except zlib.error as error:
            raise ValueError(f"a variable cannot be unpacked: {error}") from error
        self.count(len(content))
        return next(self.split(content), _Element(_PACKED, b""))

    def read_array(self, content: bytes, depth: int = 0) -> tuple[str, Value]:
        """Return the name and the value of an array."""
        if depth > _DEEPEST:
            raise ValueError(f"arrays lie more than {_DEEPEST} deep in each other")
        if not content:
            return "", np.empty((0, 0))
        flags, *parts = self.split(content)
        state = int(self._numbers(flags)[0])
        if state & 0xFF == _OPAQUE:
            return _text(parts[0]), None
        dimensions, name, *parts = parts
        shape = tuple(self._numbers(dimensions).astype(int).tolist())
        if any(length < 0 for length in shape):
            raise ValueError(f"an array states the dimensions {shape}")
        return _text(name), self._value(state, shape, parts, depth + 1)

    def _value(self, state: int, shape: tuple[int, ...], parts: list[_Element], depth: int) -> Value:
        kind = state & 0xFF
        if kind == _TEXT:
            return self._letters(parts[0], shape) if parts else ""
        if kind in _NUMERIC and parts and not state & _COMPLEX:
            self.count(8 * prod(shape))
            values = self._numbers(parts[0])
            if prod(shape) != len(values):
                raise ValueError(f"an array of {shape} has {len(values)} numbers")
            return np.reshape(values, shape, order="F")
        if kind == _CELLS:
            if prod(shape) != len(parts):
                raise ValueError(f"an array of {shape} has {len(parts)} cells")
            return [self.read_array(part.content, depth)[1] for part in parts]
        return self._structures(parts, shape, depth) if kind == _STRUCTURE else None

    def _structures(self, parts: list[_Element], shape: tuple[int, ...], depth: int) -> Value:
        """Return structures of the same fields: the length of their names, the names, and an array for each."""
        length, names, *arrays = parts
        width = int(self._numbers(length)[0])
        fields = [
            _text(_Element(0, names.content[at : at + width])) for at in range(0, len(names.content), max(1, width))
        ]
        if len(arrays) != len(fields) * prod(shape):
            raise ValueError(f"structures of {shape} with {len(fields)} fields have {len(arrays)} values")
        self.count(BYTES_OF_PART * prod(shape))
        values = (self.read_array(part.content, depth)[1] for part in arrays)
        return _one_or_all([{field: next(values) for field in fields} for _ in range(prod(shape))])

    def _letters(self, element: _Element, shape: tuple[int, ...]) -> Value:
        """Return a text, or one for each row of letters."""
        encoding = _TEXTS.get(element.kind, "latin-1")
        if encoding in ("utf-16", "utf-32"):
            encoding += "-le" if self.order == "<" else "-be"
        text = element.content.decode(encoding, errors="replace")
        if len(shape) != 2 or shape[0] == 1 or len(text) != prod(shape):
            return text
        return _one_or_all([text[row :: shape[0]] for row in range(shape[0])])

    def _numbers(self, element: _Element) -> AnyArray:
        """Return the numbers of an element."""
        if element.kind not in _NUMBERS:
            raise ValueError(f"an element of the type {element.kind} stands where numbers should")
        return np.frombuffer(element.content, self.order + _NUMBERS[element.kind])


def _text(element: _Element) -> str:
    return element.content.split(b"\0")[0].decode("latin-1")


def _one_or_all(values: list[Value]) -> Value:
    return values[0] if len(values) == 1 else values


def read_values(path: Path, content: bytes) -> dict[str, Value]:
    """Return the variables of a file by name.

    Raises:
        ValueError: it is damaged.
        TooMuchError: it states more than a file of its size may make.
    """
    if content.startswith(b"MATLAB 7.3") or content[USER_BLOCK : USER_BLOCK + len(HDF5)] == HDF5:
        from seatsim.importing.readers.hdf5 import open_checked  # needs a library that version 5 does not

        with open_checked(path, content, follows=True) as file:
            return {name: _read_item(item) for name, item in file.items() if name not in (_REFERRED, _OBJECTS)}
    order = _ORDERS.get(content[_HEADER - 2 : _HEADER])
    if order is None:
        raise ValueError("it does not state the order of its bytes")
    elements = _Elements(order, len(content))
    variables = (elements.unpack(each) for each in elements.split(content[_HEADER:]))
    found = dict(elements.read_array(each.content) for each in variables if each.kind == _ARRAY)
    return {name: value for name, value in found.items() if name}


def _read_item(item: h5py.Group | h5py.Dataset) -> Value:
    """Return a variable, a cell or a field of a file of version 7.3, whose arrays are transposed."""
    kind = as_text(item.attrs.get("MATLAB_class"))
    if hasattr(item, "keys"):
        fields = {name: _read_item(each) for name, each in item.items()}
        is_one = all("MATLAB_class" in each.attrs for each in item.values())
        lists = (value if isinstance(value, list) else [value] for value in fields.values())
        return fields if is_one else [dict(zip(fields, values, strict=True)) for values in zip(*lists, strict=True)]
    if "MATLAB_object_decode" in item.attrs and kind not in ("char", "logical"):
        return None
    if item.attrs.get("MATLAB_empty"):
        return [] if kind == "cell" else "" if kind == "char" else np.empty((0, 0))
    values = np.transpose(item[()])
    if values.dtype.kind == "O":
        return [_read_item(item.file[each]) for each in values.ravel(order="F")]
    if kind == "char":
        return _one_or_all(["".join(map(chr, row)) for row in np.atleast_2d(values)])
    return values if values.dtype.kind in "fiub" else None
