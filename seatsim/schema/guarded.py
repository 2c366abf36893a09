"""Files guarded: only regular ones of a stated size are read, with one sentence where one cannot be.

Nothing is written through a link, behind which somebody else may have put a file that is not to change. Temporary
folders and half-written files are noted while they are there, so that who ends the process can remove them
(`remove_leftovers`). What is done is put in place, or kept after an interrupt, under `uncut`.
"""

from __future__ import annotations

import json
import os
import shutil
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import RLock
from typing import Any, TextIO

from seatsim.schema.errors import InputError, OutputError, nearest

_LARGEST_JSON = 64 * 2**20
_ReadWatcher = Callable[[Path, bytes], None]
"""Is called with the path and the content of a file that was read."""
_watchers: list[_ReadWatcher] = []


@contextmanager
def watch_reads(tell: _ReadWatcher) -> Iterator[None]:
    """Call `tell` with every file that is read meanwhile, on any thread, so that the inputs of an answer are known."""
    _watchers.append(tell)
    try:
        yield
    finally:
        _watchers.remove(tell)


def read_bytes(path: Path, largest: int, what: str) -> bytes:
    """Return the content of a regular file of at most `largest` bytes; `what` it should be, as errors say it.

    Raises:
        InputError: there is no such file, it is a folder, a pipe or a device, is larger, or cannot be read.
    """
    try:
        # A pipe without a writer would be waited for.
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        with os.fdopen(handle, "rb") as file:
            status = os.fstat(handle)
            if not stat.S_ISREG(status.st_mode):
                raise InputError(f"{path}: is no regular file; give the path of {what}")
            if status.st_size > largest:
                raise InputError(f"{path}: holds {in_mib(status.st_size)}; permitted: at most {in_mib(largest)}")
            content = file.read(largest)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}; give the path of {what}") from error
    except ValueError as error:
        raise InputError(f"{str(path)!r}: is no path: {error}; give the path of {what}") from error
    for tell in _watchers:
        tell(path, content)
    return content


def is_there(path: Path) -> bool:
    """Return whether there is a file or folder; nothing is where a path is longer than the system permits."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def nearest_beside(path: Path) -> str:
    """Return what `nearest` says of a missing file's name among those of its folder."""
    return nearest(path.name, (each.name for each in path.parent.iterdir())) if path.parent.is_dir() else ""


@contextmanager
def expect(path: Path | str, what: str) -> Iterator[None]:
    """Raise InputError where the content of a file, which is taken apart meanwhile, is not `what` it should be."""
    try:
        yield
    except (KeyError, TypeError, AttributeError, ValueError, IndexError) as error:
        missing = f"the key {error} is missing" if isinstance(error, KeyError) else str(error)
        raise InputError(f"{path}: is no {what}: {missing}") from error


def in_mib(size: float) -> str:
    """Return a number of bytes as it stands in a sentence."""
    for unit, bytes_of_unit in (("TiB", 2**40), ("GiB", 2**30), ("MiB", 2**20)):
        if size >= 0.976 * bytes_of_unit:  # three digits hold no more than 999 of the next smaller unit
            return f"{size / bytes_of_unit:.3g} {unit}"
    return f"{size / 2**10:.3g} KiB"


def read_json(path: Path, what: str) -> Any:  # as its file states it
    """Return the content of a JSON file.

    Raises:
        InputError: it cannot be read, or is no JSON.
    """
    content = read_bytes(path, _LARGEST_JSON, what)
    try:
        return json.loads(content)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: is no {what}: {error}") from error


def check_no_link(folder: Path, inside: Path) -> None:
    """Refuse a way from a folder to what is written in it that leads over a link, and so to somebody else's files.

    A file at the end of the way is no matter: it is put in place of a link, and never written through one.

    Raises:
        InputError: a folder on the way is a link.
    """
    for place in (inside, *inside.parents):
        if place == folder:
            return
        if place.is_symlink():
            raise InputError(f"{place}: is a link, through which nothing is written; remove it, or give another --out")


def check_links_on(way: Path) -> None:
    """Refuse a way that leads over another user's link; the user's own, and those of the system, are followed.

    Raises:
        InputError: a folder on the way is such a link. OSError, ValueError: it cannot be looked at.
    """
    for place in (way.absolute(), *way.absolute().parents):
        if place.is_symlink() and hasattr(os, "getuid") and place.lstat().st_uid not in (os.getuid(), 0):
            raise InputError(f"{place}: is another user's link, through which nothing is written; give another --out")


def open_in_place(path: Path) -> TextIO:
    """Open a file, made where it is missing, that is read and written where it lies, such as a lock.

    Raises:
        InputError: it is a link. OutputError: it cannot be written.
    """
    try:
        return os.fdopen(os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666), "r+", encoding="utf-8")
    except OSError as error:
        check_no_link(path.parent, path)
        raise OutputError(f"{path}: cannot be written: {error.strerror}") from error


_noted: set[Path] = set()
uncut = RLock()
"""Held while something is carried to its end, for which the end of the process waits."""


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """Give a temporary folder, which is removed at the end, also where the process is ended by a signal."""
    with TemporaryDirectory(prefix="seatsim-", ignore_cleanup_errors=True) as name, noted(Path(name)) as folder:
        yield folder


@contextmanager
def noted(path: Path) -> Iterator[Path]:
    """Note a file or folder that is not to stay, for as long as it may be there."""
    _noted.add(path)
    try:
        yield path
    finally:
        _noted.discard(path)


def remove_leftovers(patience: float) -> None:
    """Remove what is noted, once nothing is under way that must not be cut; it is waited for no longer than this.

    Called by whoever ends the process at once. The lock is kept, so that nothing begins after this.
    """
    uncut.acquire(timeout=patience)
    for path in list(_noted):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
