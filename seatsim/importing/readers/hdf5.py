"""HDF5 files: data sets by folder, with units and rates from their attributes."""

from __future__ import annotations

import io
from collections.abc import Hashable, Iterator, Mapping
from contextlib import contextmanager
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import Channels, DataFile, Signal, as_text, signals_of, stated_rate, stated_unit
from seatsim.schema.bounds import BYTES_OF_NUMBER, Part, check_made, check_parts
from seatsim.schema.errors import InputError

if TYPE_CHECKING:
    import h5py
else:
    h5py = need("h5py", "HDF5")
_COLUMNS = ("columns", "names", "channels", "channel_names", "column_names")
"""Attributes that name the columns of a matrix."""


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the data sets of a file, those of one folder together.

    Raises:
        InputError: a link leads out of the file, or numbers lie elsewhere.
    """
    notes: list[str] = []
    gathered = Channels()
    with open_checked(path, content) as file:
        _gather("", file, {}, gathered, notes)
    return DataFile(path, "", gathered.groups(), tuple(notes))


def _gather(name: str, folder: h5py.Group, above: Mapping[str, object], gathered: Channels, notes: list[str]) -> None:
    """Gather the data sets of a folder, then those of the folders in it; `above` holds what was stated of all."""
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
            signals += (found := _signals(key, item))
            stated |= {each: value for each, value in item.attrs.items() if each.lower() not in _COLUMNS}
            if not found:
                notes.append(f"'{item.name}' is left out: it holds no vector or matrix of real numbers")
    for signal in signals:
        gathered.add(name, signal, stated_rate(stated))
    for title, item in inner:
        _gather(title, item, stated, gathered, notes)


def _signals(key: str, item: h5py.Dataset) -> list[Signal]:
    attributes = dict(item.attrs)
    if item.dtype.names is not None:
        table = item[()]
        return [signal for name in item.dtype.names for signal in signals_of(name, np.asarray(table[name]))]
    texts = {each.lower(): [as_text(text) for text in np.atleast_1d(value)] for each, value in attributes.items()}
    columns = next((texts[each] for each in texts if each in _COLUMNS), [])
    return signals_of(key, item[()], stated_unit(attributes), columns, texts.get("units", []))


@contextmanager
def open_checked(path: Path, content: bytes, follows: bool = False) -> Iterator[h5py.File]:
    """Open a file whose every part was checked; `follows` says that what its data sets refer to will be read too.

    Raises:
        InputError: it links to another file or keeps numbers elsewhere.
        TooMuchError: it states more than a file of its size may make.
    """
    with h5py.File(io.BytesIO(content), "r") as file:
        check_parts([file["/"]], lambda item: _part(item, path, len(content), follows), len(content))
        yield file


def _part(item: Hashable, path: Path, size: int, follows: bool) -> Part:
    """Return what an object makes and refers to."""
    place = f"{path}, {getattr(item, 'name', None) or 'an object without a name'}"
    made = sum(_bytes_of(item.attrs.get_id(name)) for name in item.attrs) if isinstance(item, h5py.HLObject) else 0
    if isinstance(item, h5py.Group):
        return Part(made, tuple(_members(item, place)))
    if not isinstance(item, h5py.Dataset):
        return Part(made)
    if item.external:
        raise InputError(f"{place}: keeps its numbers in another file ({item.external[0][0]}), which is not read")
    if item.is_virtual:
        raise InputError(f"{place}: is virtual, made of other data sets; copy what it shows into one of its own")
    made += _bytes_of(item.id)
    check_made(made, size, str(item.name))
    holds_references = h5py.check_ref_dtype(item.dtype) is h5py.Reference
    referred = (item.file[each] for each in np.ravel(item[()]) if each) if follows and holds_references else ()
    return Part(made, tuple(referred))


def _bytes_of(array: h5py.Dataset) -> int:
    """Return how many bytes a data set or an attribute makes."""
    shape = array.shape or ()
    return prod(shape) * int(max(BYTES_OF_NUMBER, array.dtype.itemsize))


def _members(group: h5py.Group, place: str) -> Iterator[h5py.HLObject]:
    """Yield what lies in a group."""
    for name in group:
        link = group.get(name, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            raise InputError(f"{place}: '{name}' is a link to another file ({link.filename}), which is not followed")
        item = group.get(name)
        if item is None:
            raise InputError(f"{place}: '{name}' is a link to '{link.path}', which is not there")
        yield item
