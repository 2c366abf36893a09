"""HDF5 files: data sets by folder, with units and rates from their attributes."""

from __future__ import annotations

import io
from collections.abc import Hashable, Iterator, Mapping
from contextlib import contextmanager
from math import ceil, prod
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import Channels, DataFile, Signal, as_text, signals_of, stated_rate, stated_unit
from seatsim.schema.bounds import BYTES_OF_NUMBER, Part, check_made, check_parts
from seatsim.schema.errors import InputError
from seatsim.schema.guarded import is_there, read_bytes
from seatsim.schema.tables import LARGEST_FILE

if TYPE_CHECKING:
    import h5py
else:
    h5py = need("h5py", "HDF5")
_COLUMNS = ("columns", "names", "channels", "channel_names", "column_names")
"""Attributes that name the columns of a matrix."""
_HERE = "."
"""How a virtual data set names its own file."""


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the data sets of a file, those of one folder together.

    Raises:
        InputError: a link leads out of the file, or numbers of a virtual data set are missing.
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
            signals += (found := _signals(key, item, notes))
            stated |= {each: value for each, value in item.attrs.items() if each.lower() not in _COLUMNS}
            if not found:
                notes.append(f"'{item.name}' is left out: it holds no vector or matrix of real numbers")
    for signal in signals:
        gathered.add(name, signal, stated_rate(stated))
    for title, item in inner:
        _gather(title, item, stated, gathered, notes)


def _signals(key: str, item: h5py.Dataset, notes: list[str]) -> list[Signal]:
    lacking = _never_written(item)
    if lacking:
        notes.append(f"'{item.name}': {lacking:.0%} of it was never written, where HDF5 gives one value for all rows")
    attributes = dict(item.attrs)
    if item.dtype.names is not None:
        table = item[()]
        return [signal for name in item.dtype.names for signal in signals_of(name, np.asarray(table[name]))]
    texts = {each.lower(): [as_text(text) for text in np.atleast_1d(value)] for each, value in attributes.items()}
    columns = next((texts[each] for each in texts if each in _COLUMNS), [])
    return signals_of(key, item[()], stated_unit(attributes), columns, texts.get("units", []))


def _never_written(item: h5py.Dataset) -> float:
    """Return the share of a data set that holds no written number."""
    if item.is_virtual or not item.size:
        return 0.0
    if item.chunks is None:
        return 1.0 if item.id.get_storage_size() == 0 else 0.0
    every = prod(ceil(length / chunk) for length, chunk in zip(item.shape, item.chunks, strict=True))
    return 1.0 - float(int(item.id.get_num_chunks()) / every)


@contextmanager
def open_checked(path: Path, content: bytes, follows: bool = False) -> Iterator[h5py.File]:
    """Open a file whose every part was checked; `follows` says that what its data sets refer to will be read too.

    Raises:
        InputError: it links to another file or keeps numbers there, or numbers of a virtual data set are missing.
        TooMuchError: it states more than a file of its size may make.
    """
    with h5py.File(io.BytesIO(content), "r") as file:
        sources: set[Path] = set()
        check_parts([file["/"]], lambda item: _part(item, path, len(content), follows, sources), len(content))
        if not sources:
            yield file
            return
    if path.stat().st_size != len(content):
        raise InputError(f"{path}: is packed, and its virtual data sets lie in files beside it; unpack it")
    with h5py.File(path, "r", locking=False) as file:  # HDF5 finds files beside a file by its path alone
        yield file


def _part(item: Hashable, path: Path, size: int, follows: bool, sources: set[Path]) -> Part:
    """Return what an object makes and refers to, and add the files of its virtual data sets to `sources`."""
    place = f"{path}, {getattr(item, 'name', None) or 'an object without a name'}"
    made = sum(_bytes_of(item.attrs.get_id(name)) for name in item.attrs) if isinstance(item, h5py.HLObject) else 0
    if isinstance(item, h5py.Group):
        return Part(made, tuple(_members(item, place)))
    if not isinstance(item, h5py.Dataset):
        return Part(made)
    if item.external:
        raise InputError(f"{place}: keeps its numbers in another file ({item.external[0][0]}), which is not read")
    made += _bytes_of(item.id)
    check_made(made, size, str(item.name))
    if item.is_virtual:
        return Part(made, tuple(_sources(item, place, path, sources)))
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


def _sources(item: h5py.Dataset, place: str, path: Path, sources: set[Path]) -> Iterator[h5py.HLObject]:
    """Yield the data sets of the same file of which a virtual one is made, and check those of the files beside it."""
    covered = 0
    for each in item.virtual_sources():
        needed = each.vspace.get_select_npoints()
        covered += needed
        missing = f"{place}: takes numbers from '{each.dset_name}' of '{each.file_name}', which is not there"
        if each.file_name == _HERE:
            source = item.file.get(each.dset_name)
            if not isinstance(source, h5py.Dataset) or source.size < needed:
                raise InputError(missing)
            yield source
        else:
            beside = path.parent / each.file_name
            if Path(each.file_name).name != each.file_name or not is_there(beside):
                raise InputError(f"{missing}; its files must lie beside it")
            sources.add(beside)
            _check_source(beside, each.dset_name, needed, missing)
    if covered < item.size:
        problem = f"{place}: {item.size - covered} of its {item.size} numbers have no source; HDF5 would give zeros"
        raise InputError(problem)


def _check_source(path: Path, name: str, needed: int, missing: str) -> None:
    """Check a file from which a virtual data set takes numbers, which may hold no virtual data set itself."""
    content = read_bytes(path, LARGEST_FILE, "a file of measured data")
    with open_checked(path, content) as file:
        source = file.get(name)
        if not isinstance(source, h5py.Dataset) or source.is_virtual or source.size < needed:
            raise InputError(missing)
