"""HDF5 files and MAT files of version 7.3: data sets by folder, with units and rates from their attributes."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatsim.importing.optional import need
from seatsim.importing.readers.naming import as_text, signals_of, stated_rate, stated_unit
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import DataFile, Group, Signal, groups_by_length

if TYPE_CHECKING:
    import h5py

COLUMNS = ("columns", "names", "channels", "channel_names", "column_names")
"""Attributes that name the columns of a matrix."""
TEXT_CLASS = "char"
"""Class that MATLAB states of a data set that holds a text as numbers."""


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the data sets of a file, those of one folder together."""
    h5py = need("h5py", "HDF5")
    with h5py.File(io.BytesIO(content), "r") as file:
        return DataFile(path, "", tuple(_groups("", file, {}, h5py.Group)))


def _groups(name: str, folder: h5py.Group, above: Mapping[str, object], kind: type[h5py.Group]) -> Iterator[Group]:
    """Yield the data sets of a folder, then those of the folders in it; `above` holds what was stated of all."""
    stated = {**above, **folder.attrs}
    signals: list[Signal] = []
    inner = []
    for key, item in folder.items():
        if key.startswith("#"):
            continue
        if isinstance(item, kind):
            inner.append((f"{name}/{key}" if name else key, item))
        elif _is_text(item) or item.shape is None:
            continue
        elif item.size == 1:
            stated[key] = item[()]
        else:
            signals += _signals(key, item)
            stated = {**stated, **{each: value for each, value in item.attrs.items() if each.lower() not in COLUMNS}}
    if signals:
        yield from groups_by_length(name, signals, stated_rate(stated))
    for title, item in inner:
        yield from _groups(title, item, stated, kind)


def _is_text(item: h5py.Dataset) -> bool:
    return as_text(item.attrs.get("MATLAB_class", "")) == TEXT_CLASS or item.dtype.kind in "OSU"


def _signals(key: str, item: h5py.Dataset) -> list[Signal]:
    attributes = dict(item.attrs)
    if item.dtype.names is not None:
        table = item[()]
        return [signal for name in item.dtype.names for signal in signals_of(name, np.asarray(table[name]))]
    columns = next((_texts(value) for each, value in attributes.items() if each.lower() in COLUMNS), [])
    units = next((_texts(value) for each, value in attributes.items() if each.lower() == "units"), [])
    return signals_of(key, item[()], stated_unit(attributes), columns, units)


def _texts(value: object) -> list[str]:
    return [as_text(each) for each in np.atleast_1d(np.asarray(value))]
