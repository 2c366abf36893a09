"""MAT files of version 5: vectors, matrices and structures of them; version 7.3 is HDF5."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import cast

import numpy as np
from scipy.io import loadmat

from seatsim.importing.readers.naming import as_text, signals_of, stated_rate, stated_unit
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import DataFile, Group, Signal, groups_by_length

VALUES = ("values", "data", "signal", "y")
"""Fields of a structure that is one channel."""


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the variables of a file; a structure is a group, or a channel where it has values and a unit."""
    stored = loadmat(cast("str", io.BytesIO(content)), squeeze_me=True)  # its stubs know names of files alone
    variables = {name: value for name, value in stored.items() if not name.startswith("__")}
    return DataFile(path, "", tuple(_groups("", variables)))


def _groups(name: str, variables: Mapping[str, object]) -> Iterator[Group]:
    """Yield the channels that stand beside each other, then those of every structure among them."""
    units = variables.get("units", variables.get("unit"))
    own = _fields(units) if units is not None else None
    signals: list[Signal] = []
    inner: list[tuple[str, Mapping[str, object]]] = []
    for key, value in variables.items():
        fields = _fields(value)
        if fields is None:
            signals += signals_of(key, np.asarray(value), as_text((own or {}).get(key, "")))
        elif (channel := next((field for field in VALUES if field in fields), None)) and stated_unit(fields):
            signals += signals_of(key, np.asarray(fields[channel]), stated_unit(fields))
        else:
            inner.append((f"{name}.{key}" if name else key, fields))
    if signals:
        yield from groups_by_length(name, signals, stated_rate(variables))
    for title, held in inner:
        yield from _groups(title, held)


def _fields(value: object) -> dict[str, object] | None:
    """Return the fields of a structure, None where a value is none."""
    array = np.asarray(value)
    if array.dtype.names is None or array.size != 1:
        return None
    record = array.reshape(-1)[0]
    return {name: record[name] for name in array.dtype.names}
