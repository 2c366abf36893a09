"""HDF5 files: data sets by folder, with units and rates from their attributes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import ceil, prod
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatsim.importing.readers.hdf5_parts import open_checked
from seatsim.importing.readers.naming import as_text, signals_of, stated_rate, stated_unit
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import DataFile, Group, Signal, groups_by_length

if TYPE_CHECKING:
    import h5py

COLUMNS = ("columns", "names", "channels", "channel_names", "column_names")
"""Attributes that name the columns of a matrix."""


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the data sets of a file, those of one folder together.

    Raises:
        InputError: a link leads out of the file, or numbers of a virtual data set are missing.
    """
    notes: list[str] = []
    with open_checked(path, content) as file:
        groups = tuple(_groups("", file, {}, notes))
    return DataFile(path, "", groups, tuple(notes))


def _groups(name: str, folder: h5py.Group, above: Mapping[str, object], notes: list[str]) -> Iterator[Group]:
    """Yield the data sets of a folder, then those of the folders in it; `above` holds what was stated of all."""
    import h5py

    stated = {**above, **folder.attrs}
    signals: list[Signal] = []
    inner = []
    for key, item in folder.items():
        if isinstance(item, h5py.Group):
            inner.append((f"{name}/{key}" if name else key, item))
        elif not isinstance(item, h5py.Dataset) or item.dtype.kind in "OSU" or item.shape is None:
            continue
        elif item.size == 1:
            stated[key] = item[()]
        else:
            found = _signals(key, item, notes)
            signals += found
            stated = {**stated, **{each: value for each, value in item.attrs.items() if each.lower() not in COLUMNS}}
            if not found:
                notes.append(f"'{item.name}' is left out: it holds no vector or matrix of real numbers")
    if signals:
        yield from groups_by_length(name, signals, stated_rate(stated))
    for title, item in inner:
        yield from _groups(title, item, stated, notes)


def _signals(key: str, item: h5py.Dataset, notes: list[str]) -> list[Signal]:
    lacking = _never_written(item)
    if lacking:
        notes.append(f"'{item.name}': {lacking:.0%} of it was never written, where HDF5 gives one value for all rows")
    attributes = dict(item.attrs)
    if item.dtype.names is not None:
        table = item[()]
        return [signal for name in item.dtype.names for signal in signals_of(name, np.asarray(table[name]))]
    columns = next((_texts(value) for each, value in attributes.items() if each.lower() in COLUMNS), [])
    units = next((_texts(value) for each, value in attributes.items() if each.lower() == "units"), [])
    return signals_of(key, item[()], stated_unit(attributes), columns, units)


def _never_written(item: h5py.Dataset) -> float:
    """Return the share of a data set that holds no written number."""
    if item.is_virtual or not item.size:
        return 0.0
    if item.chunks is None:
        return 1.0 if item.id.get_storage_size() == 0 else 0.0
    every = prod(ceil(length / chunk) for length, chunk in zip(item.shape, item.chunks, strict=True))
    return 1.0 - float(int(item.id.get_num_chunks()) / every)


def _texts(value: object) -> list[str]:
    return [as_text(each) for each in np.atleast_1d(np.asarray(value))]
