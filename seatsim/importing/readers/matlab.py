"""MAT files of version 5: vectors, matrices and structures of them; version 7.3 is HDF5."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from seatsim.importing.readers.mat_elements import Value, read_variables
from seatsim.importing.readers.naming import as_text, signals_of, stated_rate, stated_unit
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import DataFile, Group, Signal, groups_by_length

VALUES = ("values", "data", "signal", "y")
"""Fields of a structure that is one channel."""


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the variables of a file; a structure is a group, or a channel where it has values and a unit."""
    return DataFile(path, "", tuple(_groups("", read_variables(content))))


def _groups(name: str, variables: Mapping[str, Value]) -> Iterator[Group]:
    """Yield the channels that stand beside each other, then those of every structure among them."""
    units = variables.get("units", variables.get("unit"))
    own = units if isinstance(units, dict) else {}
    signals: list[Signal] = []
    inner: list[tuple[str, Mapping[str, Value]]] = []
    for key, value in variables.items():
        if not isinstance(value, dict):
            signals += signals_of(key, np.asarray(value), as_text(own.get(key, "")))
        elif (channel := next((field for field in VALUES if field in value), None)) and stated_unit(value):
            signals += signals_of(key, np.asarray(value[channel]), stated_unit(value))
        else:
            inner.append((f"{name}.{key}" if name else key, value))
    if signals:
        yield from groups_by_length(name, signals, stated_rate(variables))
    for title, held in inner:
        yield from _groups(title, held)
