"""The variables of a MAT file of version 5 or 7.3 as plain values: numbers, texts, structures, and lists of them.

The elements of version 5 are read in plain Python: a damaged file ends in an error, whatever it states.

After 128 bytes, of which the last two tell the byte order, come elements: a type, a number of bytes, and as many bytes,
filled up to eight. An array is an element of elements: flags, dimensions, a name, and its values, cells or fields. What
objects such as tables hold lies in an array without a name, as the elements of a file of its own. Objects of MATLAB,
such as tables, are resolved by mat-io, which reads files of version 7.3 too.
"""

from __future__ import annotations

import struct
import warnings
import zlib
from collections.abc import Callable, Iterator, Sequence
from math import prod
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from seatsim.importing.readers.reading import HDF5, USER_BLOCK, need
from seatsim.importing.signals import TIME, in_seconds
from seatsim.schema.bounds import BYTES_OF_PART, LEAST, check_made, permitted_of

AnyArray: TypeAlias = NDArray[np.generic]
_Resolve: TypeAlias = Callable[[AnyArray, str, str], object]
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
        self.resolve: _Resolve | None = None

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
            is_object = _text(class_name) != _FILE_WRAPPER
            if is_object and self.resolve and isinstance(held, np.ndarray):
                return _text(name), self.resolve(held, _text(system), _text(class_name))
            return _text(name), None if is_object else held
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


def _read_variables(content: bytes) -> dict[str, object]:
    """Return the variables of a file by name, as `_Elements.read_array` does.

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
                elements.resolve = _open_inner(value.tobytes(), len(content))
            else:
                found[name] = value
    return dict(reversed(found.items()))


def _open_inner(content: bytes, size: int) -> _Resolve | None:
    """Return what resolves objects, of which the inner file holds all that they hold."""
    order = _ORDERS.get(content[2:4])
    if order is None:
        return None
    elements = _Elements(order, size)
    for element in elements.split(content[_INNER_HEADER:]):
        variable = elements.unpack(element)
        _, value = elements.read_array(variable.content) if variable.kind == _ARRAY else ("", None)
        if isinstance(value, np.ndarray) and value.dtype.names:
            resolve: _Resolve = _subsystem(value, order).load_opaque_object
            return resolve
    return None


def _text(element: _Element) -> str:
    return element.content.split(b"\0")[0].decode("latin-1")


Value: TypeAlias = "AnyArray | str | dict[str, Value] | list[Value] | None"
"""Numbers, a text, a structure, cells or structures of many; None for what is none of these."""

_REFERRED, _SUBSYSTEM = "#refs#", "#subsystem#"
"""Folders of a file of version 7.3 that hold what its cells and structures refer to, and what its objects hold."""
_REFERENCE = 0xDD000000
"""First number of an array that tells which object it is."""
_MOST_OBJECTS = LEAST // BYTES_OF_PART
_UNITS_OF_TABLE = ("varUnits", "VariableUnits")
"""Attributes with which mat-io states the units of a table."""


def read_values(path: Path, content: bytes) -> dict[str, Value]:
    """Return the variables of a file by name.

    Raises:
        ValueError: it is damaged.
        TooMuchError: it states more than a file of its size may make.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what mat-io cannot resolve is None, and named by who takes no channel of it
        if content.startswith(b"MATLAB 7.3") or content[USER_BLOCK : USER_BLOCK + len(HDF5)] == HDF5:
            return _read_hdf5(path, content)
        plain = _Plain(len(content))
        return {name: plain.of(value) for name, value in _read_variables(content).items()}


def _read_hdf5(path: Path, content: bytes) -> dict[str, Value]:
    from seatsim.importing.readers.hdf5 import open_checked  # needs a library that version 5 does not

    with open_checked(path, content, follows=True) as file:
        reader = _need_matio("matio.v7.matreader7", "MAT v7.3").MatRead7(file)
        if _SUBSYSTEM in file:
            reader.subsystem = _subsystem(reader.read_struct(file[_SUBSYSTEM]), "<")
        found: dict[str, Value] = {}
        plain = _Plain(len(content))
        for name in file:
            if name not in (_REFERRED, _SUBSYSTEM):
                try:
                    found[name] = plain.of(reader.read_h5_data(file[name]))
                except NotImplementedError:  # no variable of MATLAB
                    found[name] = None
        return found


def _need_matio(module: str, kind: str) -> ModuleType:
    """Return a part of mat-io; its import changes for the whole process how pandas keeps texts, which is put back."""
    with pd.option_context("future.infer_string", pd.get_option("future.infer_string")):
        return need(module, kind)


def _subsystem(held: AnyArray, order: str) -> Any:
    """Return what resolves objects, at most so many of them: objects may hold each other over and over."""
    base = _need_matio("matio.subsystem", "a table or another object of MATLAB").MatSubsystem

    class Bounded(base):  # type: ignore[misc, valid-type]
        left = _MOST_OBJECTS

        def load_opaque_object(self, metadata: object, type_system: object, classname: object = None) -> object:
            self.left -= 1
            if self.left < 0:
                raise ValueError(f"its objects hold each other more than {_MOST_OBJECTS} times")
            if isinstance(metadata, np.ndarray) and metadata.dtype.kind == "u" and metadata.size > 2:
                flat = metadata.ravel()
                if flat[0] == _REFERENCE and np.prod(flat[2 : 2 + int(flat[1])], dtype=float) > flat.size:
                    raise ValueError("an array of objects states more of them than it has")
            return super().load_opaque_object(metadata, type_system, classname)

    subsystem = Bounded(order, add_table_attrs=True)
    subsystem.load_subsystem(held)
    if any(np.min(each, initial=0) < 0 for each in (subsystem.saveobj_metadata, subsystem.nobj_metadata)):
        raise ValueError("what its objects hold is damaged")
    return subsystem


class _Plain:
    """Makes plain values of what mat-io or the reader of elements has made, no more than a file may make."""

    def __init__(self, size: int) -> None:
        self.size, self.parts = size, 0

    def of(self, value: object) -> Value:
        """Return a plain value; an object counts as often as something holds it."""
        self.parts += 1
        check_made(BYTES_OF_PART * self.parts, self.size)
        if isinstance(value, pd.DataFrame):
            return self._of_table(value)
        if isinstance(value, dict):
            return {str(key): self.of(each) for key, each in value.items()}
        if isinstance(value, np.ndarray):
            return self._of_array(value)
        if type(value).__name__ == "MatlabCanonicalEmpty":
            return np.empty((0, 0))
        properties = getattr(value, "properties", None)  # of an object of a class that mat-io does not know
        return self.of(properties) if isinstance(properties, dict) else value if isinstance(value, str) else None

    def _of_array(self, array: AnyArray) -> Value:
        """Return numbers as an array, and what is one text or structure as it is, not as a list."""
        check_made(array.nbytes, self.size)  # an empty array may state any dimensions
        flat, kind = array.ravel(order="F"), array.dtype.kind
        if kind in "fiubMm":
            return in_seconds(array)
        several: list[Value] = []
        if names := array.dtype.names:
            several = [dict(zip(names, map(self.of, row), strict=True)) for row in flat.tolist()]
        elif kind in "UT":
            several = [str(each) for each in flat]
        elif kind == "O":
            return [self.of(each) for each in flat]
        else:
            return None
        return several[0] if len(several) == 1 else several

    def _of_table(self, frame: pd.DataFrame) -> dict[str, Value]:
        """Return the columns of a table, with its times in s if it has such, and its units by column."""
        columns: dict[str, Value] = {TIME: in_seconds(frame.index.to_numpy())} if frame.index.dtype.kind in "Mm" else {}
        columns |= {str(name): self.of(frame[name].to_numpy()) for name in frame}
        units: Sequence[object] = next((frame.attrs[key] for key in _UNITS_OF_TABLE if key in frame.attrs), ())
        if len(units) == len(frame.columns):
            columns["units"] = {str(name): str(unit) for name, unit in zip(frame, units, strict=True)}
        return columns
