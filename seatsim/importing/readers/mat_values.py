"""The variables of a MAT file of version 5 or 7.3 as plain values: numbers, texts, structures, and lists of them.

Objects of MATLAB, such as tables, are resolved by mat-io, which reads files of version 7.3 too.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from seatsim.importing.readers.hdf5 import open_checked
from seatsim.importing.readers.mat_elements import AnyArray, Resolve, read_variables
from seatsim.importing.readers.reading import HDF5, USER_BLOCK, need
from seatsim.importing.signals import TIME, in_seconds
from seatsim.schema.bounds import BYTES_OF_PART, LEAST, check_made

if TYPE_CHECKING:
    import pandas as pd

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
        return {name: plain.of(value) for name, value in read_variables(content, _open_objects).items()}


def _read_hdf5(path: Path, content: bytes) -> dict[str, Value]:
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
    import pandas as pd

    with pd.option_context("future.infer_string", pd.get_option("future.infer_string")):
        return need(module, kind)


def _open_objects(held: AnyArray, order: str) -> Resolve:
    return _subsystem(held, order).load_opaque_object  # type: ignore[no-any-return]


def _subsystem(held: AnyArray, order: str) -> Any:
    """Return what resolves objects, at most so many of them: objects may hold each other over and over."""
    base = _need_matio("matio.subsystem", "a table or another object of MATLAB").MatSubsystem

    class Bounded(base):  # type: ignore[misc, valid-type]
        left = _MOST_OBJECTS

        def load_opaque_object(self, metadata: object, type_system: object, classname: object = None) -> object:
            self.left -= 1
            if self.left < 0:
                raise ValueError(f"its objects hold each other more than {_MOST_OBJECTS} times")
            _check_reference(metadata)
            return super().load_opaque_object(metadata, type_system, classname)

    subsystem = Bounded(order, add_table_attrs=True)
    subsystem.load_subsystem(held)
    if any(np.min(each, initial=0) < 0 for each in (subsystem.saveobj_metadata, subsystem.nobj_metadata)):
        raise ValueError("what its objects hold is damaged")
    return subsystem


def _check_reference(numbers: object) -> None:
    """Raise ValueError where an array states more objects than it has numbers."""
    if isinstance(numbers, np.ndarray) and numbers.dtype.kind == "u" and numbers.size > 2:
        flat = numbers.ravel()
        if flat[0] == _REFERENCE and np.prod(flat[2 : 2 + int(flat[1])], dtype=float) > flat.size:
            raise ValueError("an array of objects states more of them than it has")


class _Plain:
    """Makes plain values of what mat-io or the reader of elements has made, no more than a file may make."""

    def __init__(self, size: int) -> None:
        self.size, self.parts = size, 0

    def of(self, value: object) -> Value:
        """Return a plain value; an object counts as often as something holds it."""
        import pandas as pd

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
