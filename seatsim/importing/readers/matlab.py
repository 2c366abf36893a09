"""MAT files of versions 5 and 7.3: their variables as plain values, and the channels that programs lay out in them.

The elements of version 5 are read in plain Python: a damaged file ends in an error, whatever it states, where compiled
readers end the process. After 128 bytes, of which the last two tell the byte order, come elements: a type, a number of
bytes, and as many bytes, filled up to eight. An array is an element of elements: flags, dimensions, a name, and its
values, cells or fields. An array without a name holds what objects such as tables are made of. A file of version 7.3 is
one of HDF5, whose cells and arrays of structures are references.

Programs differ in names and nesting, not in what they state. A structure with values is a channel; its name, unit,
times or interval stand in it, or in a structure above (Simulink, dSPACE). Where all variables lie flat,
those of a channel share the beginning of their names (`Channel_1_Data`, `Channel_1_Header`).
"""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from seatsim.importing.readers.reading import HDF5, USER_BLOCK, TextLayout
from seatsim.importing.signals import (
    TIME,
    Channels,
    DataFile,
    Signal,
    as_text,
    bare,
    note_left_out,
    scalar,
    signals_of,
    stated_rate,
    stated_text,
    stated_unit,
)
from seatsim.schema.arrays import Array
from seatsim.schema.bounds import BYTES_OF_PART, check_made, permitted_of
from seatsim.schema.units import DIMENSIONS, find_conversion

if TYPE_CHECKING:
    import h5py

_AnyArray: TypeAlias = NDArray[np.generic]
Value: TypeAlias = "_AnyArray | str | dict[str, Value] | list[Value] | None"
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

    def _numbers(self, element: _Element) -> _AnyArray:
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


_Structure = Mapping[str, Value]
_VALUES = ("values", "data", "signal", "samples", "y", "ydata")
_LABELS = ("label", "signalname", "channelname", "name", "title", "blockname")
_TIMES = ("time", "t", "zeit", "temps", "timestamp", "timestamps", "tout")
_ABSCISSAS = (*_TIMES, "x", "xdata")
_STARTS = ("x0", "xoffset", "xorg", "start")
"""Fields of a structure that is a channel: its values, its name, its times in s, and the time in s of its first value.
Names stand here without underscores and capitals."""
_UNITS_OF_TIME = ("xunit", "xunits", "unitx", "timeunit", "timeunits")
"""Fields that state the unit of times."""
_BESIDE = ("header", "info", "datainfo", "capture", "meta", "metadata", "fileheader", "attributes")
"""Structures that state something of what stands beside them."""
_ENDING = re.compile(
    r"^(.+?)_(data|values|header|unit|units|time|name|label|fs|dt|dx|x0|samplerate|xdelta)$", re.IGNORECASE
)
"""A flat variable that is part of a channel: the name of the channel, and which part it is."""
_LEFT_OUT = "left out, as they hold no columns of real numbers (MATLAB exports its tables and objects by parquetwrite)"
_LATEST = 1e7
"""s; a start that is larger is a date."""


class _Clock(NamedTuple):
    """What a structure states of the channels in it: vectors of times in s, or a rate in Hz and a start in s."""

    times: tuple[Array, ...] = ()
    rate: float | None = None
    start: float | None = None


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the channels of a file; a note names the variables that give none, and what is no column of numbers."""
    reader = _Reader()
    reader.read_structure("", "", _join_flat(read_values(path, content)), _Clock())
    notes = note_left_out(_LEFT_OUT, reader.left_out)
    return DataFile(path, "", reader.gathered.groups(), notes)


class _Reader:
    """Gathers the channels of a file, by their times, or by structure, length, rate and start."""

    def __init__(self) -> None:
        self.gathered = Channels()
        self.left_out: list[str] = []

    def read_structure(self, name: str, label: str, held: _Structure, above: _Clock) -> None:
        """Take the channels of a structure, which is called `label` where it does not say how."""
        stated = _statements(held)
        channel = _channel_of(held)
        own = _clock(held, stated, _ABSCISSAS if channel else _TIMES)
        label = stated_text(stated, _LABELS) or label
        clock = own if own.times or own.rate else above
        if channel:
            signals = signals_of(label or channel, np.asarray(held[channel]), stated_unit(stated))
            self._add(name, signals, clock, name or channel)
            return
        before = len(self.gathered)
        inner = {key: value for key, value in held.items() if isinstance(value, dict | list)}
        vectors = {key: value for key, value in held.items() if isinstance(value, np.ndarray) and value.size > 1}
        # Nothing but times is there for the channels in the structures below.
        if not inner or any(bare(key) not in _TIMES for key in vectors):
            self._read_vectors(name, vectors, clock)
        for key, below in inner.items():
            if bare(key) not in _ABSCISSAS or not own.times:
                self._read_inner(name, key, label if bare(key) in _VALUES else key, below, clock)
        is_empty = len(self.gathered) == before
        for key, value in held.items():
            if value is None or (is_empty and isinstance(value, np.ndarray) and value.size == 0):
                self.left_out.append(f"{name}.{key}".strip("."))

    def _read_vectors(self, name: str, vectors: Mapping[str, _AnyArray], clock: _Clock) -> None:
        """Take vectors that stand beside each other, with their times if these are among them."""
        timed = {max(vector.shape) for key, vector in vectors.items() if bare(key) in _TIMES}
        for key, vector in vectors.items():
            # Simulink calls the times of its outputs tout.
            signals = signals_of(TIME if bare(key) == "tout" else key, vector)
            beside_times = max(vector.shape) in timed
            self._add(name, signals, _Clock((), clock.rate) if beside_times else clock, f"{name}.{key}".strip("."))

    def _read_inner(self, above: str, key: str, label: str, value: Value, clock: _Clock) -> None:
        """Take the channels of a structure or of each of a list; one without times of its own is beside the others."""
        name = f"{above}.{key}".strip(".")
        if isinstance(value, dict):
            is_beside = bool(_channel_of(value)) and not _times(value, _ABSCISSAS)
            self.read_structure(above if is_beside else name, label, _join_flat(value), clock)
        elif isinstance(value, list):
            for number, each in enumerate(value, 1):
                if isinstance(each, dict | list):
                    self._read_inner(above, key, f"{label}#{number}" if len(value) > 1 else label, each, clock)
                elif each is None or _is_vector(each):
                    self._add(name, signals_of(f"{label}#{number}", np.asarray(each)), clock, name)

    def _add(self, name: str, signals: list[Signal], clock: _Clock, place: str) -> None:
        if not signals:
            self.left_out.append(place)
        for signal in signals:
            times = next((each for each in clock.times if len(each) == len(signal.values)), None)
            if times is not None:
                self.gathered.add_timed(name, times, [signal])
            else:
                self.gathered.add(name, signal, clock.rate, clock.start)


def _channel_of(held: _Structure) -> str | None:
    """Return the field that holds the values of a channel, None where a structure is no channel."""
    key = next((each for name in _VALUES for each in held if bare(each) == name and _is_vector(held[each])), None)
    if key is None:
        return None
    length = max(np.asarray(held[key]).shape)
    others = [each for each, value in held.items() if _is_vector(value) and max(np.asarray(value).shape) == length]
    return key if all(each == key or bare(each) in _ABSCISSAS for each in others) else None


def _times(held: _Structure, names: Sequence[str]) -> tuple[Array, ...]:
    """Return the vectors of times that a structure holds under such names, or as the values of channels in it."""
    found: list[Array] = []
    for key, value in held.items():
        for each in value if isinstance(value, list) else [value]:
            channel = _channel_of(each) if isinstance(each, dict) and bare(key) in _ABSCISSAS else None
            times = each[channel] if isinstance(each, dict) and channel else each if bare(key) in names else None
            if _is_vector(times) and (vector := np.squeeze(np.asarray(times))).dtype.kind in "fiu" and vector.ndim == 1:
                steps = np.diff(vector.astype(np.float64))
                if (steps >= 0.0).all() and (steps > 0.0).any():
                    found.append(vector.astype(np.float64))
    return tuple(found)


def _clock(held: _Structure, stated: _Structure, names: Sequence[str]) -> _Clock:
    """Return what a structure states of time, in s and Hz."""
    unit = stated_text(stated, _UNITS_OF_TIME)
    found = find_conversion(unit, DIMENSIONS["time"]) if unit else None
    factor = found.factor if found else 1.0
    starts = (scalar(value) for key, value in stated.items() if bare(key) in _STARTS)
    start = next((factor * each for each in starts if each is not None and abs(each) < _LATEST), None)
    return _Clock(tuple(factor * each for each in _times(held, names)), stated_rate(stated, factor), start)


def _join_flat(variables: Mapping[str, Value]) -> dict[str, Value]:
    """Return variables, and a structure of each vector with what is called after it."""
    owners = {name: found for name in variables if (found := _owner(name, variables))}
    parts: dict[str, dict[str, Value]] = {owner: {} for owner, _ in owners.values()}
    for name, (owner, part) in owners.items():
        parts[owner][part] = variables[name]
    for owner, held in parts.items():
        if owner in variables:
            held["data"] = variables[owner]
    return {name: value for name, value in variables.items() if name not in owners} | parts


def _owner(name: str, variables: Mapping[str, Value]) -> tuple[str, str] | None:
    """Return the channel of which a variable is a part, and which part; None where it is one of itself."""
    ending = _ENDING.match(name)
    if ending:
        beginning, part = ending[1], ending[2].lower()
        if _is_vector(variables.get(beginning)):
            return None if part in _VALUES else (beginning, part)
        siblings = (variables.get(f"{beginning}_{each}") for each in ("data", "Data", "DATA", "values", "Values"))
        if beginning not in variables and any(_is_vector(each) for each in siblings):
            return beginning, part
    return None


def _is_vector(value: Value | None) -> bool:
    """Say whether a value is more than one number."""
    return isinstance(value, np.ndarray) and value.size > 1


def _statements(structure: Mapping[str, Value]) -> dict[str, Value]:
    """Return the fields of a structure, and those of the structures in it that state something of the others."""
    stated: dict[str, Value] = {}
    for name, value in structure.items():
        if bare(name) in _BESIDE and isinstance(value, dict):
            stated |= value
    return stated | dict(structure)
