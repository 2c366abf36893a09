"""Files that are written whole or not at all."""

from __future__ import annotations

import json
import math
import os
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np

from seatsim.schema.errors import InputError


@runtime_checkable
class _Named(Protocol):
    """A record, as `typing.NamedTuple` makes them."""

    def _asdict(self) -> Mapping[str, object]: ...


def write_whole(path: Path, write: Callable[[Path], object], lasting: bool = False) -> Path:
    """Let `write` fill a temporary file next to `path`, then put it in place at once; nothing stays where it fails.

    A `lasting` file is on the disk before it is put in place, so that it survives a loss of power.

    Raises:
        InputError: the folder or the file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=path.suffix)
        os.close(handle)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}; give another --out") from error
    part = Path(name)
    try:
        write(part)
        part.chmod(0o644)
        if lasting:
            _synchronise(part)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
    return path


def _synchronise(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_text(path: Path, text: str, lasting: bool = False) -> Path:
    """Write a text file whole; `lasting` as for `write_whole`."""
    return write_whole(path, lambda part: part.write_text(text, encoding="utf-8"), lasting)


def write_json(path: Path, value: object, lasting: bool = False) -> Path:
    """Write JSON whole; numbers that JSON has no word for become null. `lasting` as for `write_whole`."""
    return write_text(path, json.dumps(plain(value), indent=2, allow_nan=False) + "\n", lasting)


def plain(value: object) -> object:
    """Return nested values as JSON has them; a record becomes an object."""
    if isinstance(value, _Named):
        return plain(value._asdict())
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value.item() if isinstance(value, np.generic) else value
