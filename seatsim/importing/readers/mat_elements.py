"""The elements of a MAT file of version 5, read in plain Python: a damaged file ends in an error, whatever it states.

After 128 bytes, of which the last two tell the byte order, come elements: a type, a number of bytes, and as many bytes,
filled up to eight. An array is an element of elements: flags, dimensions, a name, and its values, cells or fields. What
objects such as tables hold lies in an array without a name, as the elements of a file of its own.
"""

import struct
import zlib
from collections.abc import Callable, Iterator
from math import prod
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.bounds import BYTES_OF_PART, check_made, permitted_of

AnyArray: TypeAlias = NDArray[np.generic]
Resolve: TypeAlias = Callable[[AnyArray, str, str], object]
"""Returns an object, of which a file holds an array that tells which it is, its system, and its class."""

_HEADER, _INNER_HEADER = 128, 8
_ORDERS = {b"IM": "<", b"MI": ">"}
"""Bytes at the end of a header, and the order of bytes of which they tell."""
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXTS = {2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_ARRAY, _PACKED = 14, 15
"""Types of elements: numbers and texts by their types of numpy and encodings, arrays, packed elements."""
_CELLS, _STRUCTURE, _OBJECT, _TEXT, _NUMERIC, _OPAQUE = 1, 2, 3, 4, range(6, 16), 17
_COMPLEX = 0x0800
"""Classes of arrays, and the flag of those that have an imaginary part too."""
_DEEPEST = 32
"""How deep arrays may lie in each other."""
_FILE_WRAPPER = "FileWrapper__"
"""Class of the array that holds what all objects of a file hold."""


class _Element(NamedTuple):
    """An element: its type and its content."""

    kind: int
    content: bytes


class _Elements:
    """Reads arrays in one order of bytes, as long as they make no more than a file of `size` bytes may."""

    def __init__(self, order: str, size: int) -> None:
        self.order, self.size, self.made = order, size, 0
        self.resolve: Resolve | None = None

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

    def read_array(self, content: bytes, depth: int = 0) -> tuple[str, object]:
        """Return the name and the value of an array; None is the value of what holds neither numbers nor others."""
        if depth > _DEEPEST:
            raise ValueError(f"arrays lie more than {_DEEPEST} deep in each other")
        if not content:
            return "", np.empty((0, 0))
        flags, *parts = self.split(content)
        state = int(self.numbers(flags)[0])
        kind = state & 0xFF
        if kind == _OPAQUE:
            name, system, class_name, value = parts
            held = self.read_array(value.content, depth + 1)[1]
            return _text(name), self._object(held, _text(system), _text(class_name))
        dimensions, name, *parts = parts
        shape = tuple(self.numbers(dimensions).astype(int).tolist())
        if any(length < 0 for length in shape):
            raise ValueError(f"an array states the dimensions {shape}")
        return _text(name), self._value(kind, state, shape, parts, depth)

    def _value(self, kind: int, state: int, shape: tuple[int, ...], parts: list[_Element], depth: int) -> object:
        if kind == _TEXT:
            return self._letters(parts[0], shape) if parts else np.empty(0, dtype=np.str_)
        if kind in _NUMERIC and parts:
            self.count(8 * prod(shape))
            values = [self.numbers(part) for part in parts[: 2 if state & _COMPLEX else 1]]
            if any(prod(shape) != len(each) for each in values):
                raise ValueError(f"an array of {shape} has {len(values[0])} numbers")
            whole = values[0] if len(values) == 1 else np.add(values[0], np.multiply(1j, values[1]))
            return np.reshape(whole, shape, order="F")
        if kind == _CELLS:
            return self._arrays(parts, shape, depth)
        if kind in (_STRUCTURE, _OBJECT):
            return self._structures(parts[1:] if kind == _OBJECT else parts, shape, depth)
        return None

    def _arrays(self, parts: list[_Element], shape: tuple[int, ...], depth: int) -> AnyArray:
        if prod(shape) != len(parts):
            raise ValueError(f"an array of {shape} has {len(parts)} cells")
        cells = np.empty(len(parts), dtype=object)
        for index, part in enumerate(parts):
            cells[index] = self.read_array(part.content, depth + 1)[1]
        return cells.reshape(shape, order="F")

    def _structures(self, parts: list[_Element], shape: tuple[int, ...], depth: int) -> AnyArray:
        """Return structures of the same fields: the length of their names, the names, and an array for each."""
        length, names, *arrays = parts
        width = int(self.numbers(length)[0])
        fields = [
            _text(_Element(0, names.content[at : at + width])) for at in range(0, len(names.content), max(1, width))
        ]
        if len(arrays) != len(fields) * prod(shape):
            raise ValueError(f"structures of {shape} with {len(fields)} fields have {len(arrays)} values")
        if not fields:
            self.count(8 * prod(shape))
            return np.empty(shape, dtype=object)
        held = np.empty(prod(shape), dtype=[(field, object) for field in fields])
        for index, part in enumerate(arrays):
            held[index // len(fields)][fields[index % len(fields)]] = self.read_array(part.content, depth + 1)[1]
        return held.reshape(shape, order="F")

    def _letters(self, element: _Element, shape: tuple[int, ...]) -> AnyArray:
        """Return a text, or one for each row of letters."""
        encoding = _TEXTS.get(element.kind, "latin-1")
        if encoding in ("utf-16", "utf-32"):
            encoding += "-le" if self.order == "<" else "-be"
        text = element.content.decode(encoding, errors="replace")
        if len(shape) != 2 or shape[0] == 1 or len(text) != prod(shape):
            return np.array([text])
        rows = np.array(list(text)).reshape(shape, order="F") if text else np.empty(shape, dtype=np.str_)
        return np.array(["".join(row) for row in rows])

    def numbers(self, element: _Element) -> AnyArray:
        """Return the numbers of an element."""
        if element.kind not in _NUMBERS:
            raise ValueError(f"an element of the type {element.kind} stands where numbers should")
        return np.frombuffer(element.content, self.order + _NUMBERS[element.kind])

    def _object(self, held: object, system: str, class_name: str) -> object:
        if class_name == _FILE_WRAPPER:
            return held
        return self.resolve(held, system, class_name) if self.resolve and isinstance(held, np.ndarray) else None


def read_variables(content: bytes, open_objects: Callable[[AnyArray, str], Resolve]) -> dict[str, object]:
    """Return the variables of a file by name, as `_Elements.read_array` does.

    `open_objects` returns what resolves objects, of the structure that holds them all and the order of bytes.

    Raises:
        ValueError: the file is damaged.
        TooMuchError: it states more than a file of its size may make.
    """
    order = _ORDERS.get(content[_HEADER - 2 : _HEADER])
    if order is None:
        raise ValueError("it does not state the order of its bytes")
    elements = _Elements(order, len(content))
    variables = [elements.unpack(each) for each in elements.split(content[_HEADER:])]
    found: dict[str, object] = {}
    # What objects hold stands last, and is needed first.
    for variable in reversed(variables):
        if variable.kind == _ARRAY:
            name, value = elements.read_array(variable.content)
            if not name and isinstance(value, np.ndarray) and value.dtype == np.uint8:
                elements.resolve = _open_objects(value.tobytes(), len(content), open_objects)
            else:
                found[name] = value
    return dict(reversed(found.items()))


def _open_objects(content: bytes, size: int, open_objects: Callable[[AnyArray, str], Resolve]) -> Resolve | None:
    order = _ORDERS.get(content[2:4])
    if order is None:
        return None
    elements = _Elements(order, size)
    for element in elements.split(content[_INNER_HEADER:]):
        variable = elements.unpack(element)
        _, value = elements.read_array(variable.content) if variable.kind == _ARRAY else ("", None)
        if isinstance(value, np.ndarray) and value.dtype.names:
            return open_objects(value, order)
    return None


def _text(element: _Element) -> str:
    return element.content.split(b"\0")[0].decode("latin-1")
