"""MAT files of versions 5 and 7.3: vectors, matrices and structures of them, as many programs lay them out.

Programs differ in names and nesting, not in what they state. A structure with values is a channel; its name, unit,
times or interval stand in it, or in a structure above (Simulink, dSPACE). Where all variables lie flat,
those of a channel share the beginning of their names (`Channel_1_Data`, `Channel_1_Header`).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.importing.readers.mat_elements import AnyArray, Value, read_values
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import (
    TIME,
    Channels,
    DataFile,
    Signal,
    bare,
    note_left_out,
    scalar,
    signals_of,
    stated_rate,
    stated_text,
    stated_unit,
)
from seatsim.schema.arrays import Array
from seatsim.schema.units import DIMENSIONS, find_conversion

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

    def _read_vectors(self, name: str, vectors: Mapping[str, AnyArray], clock: _Clock) -> None:
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
