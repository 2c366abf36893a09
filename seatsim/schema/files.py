"""Files that are written whole or not at all: single ones, and all that a command writes together.

What is not yet whole lies beside its place under a name that begins with `.` and has `.part` in its end.
"""

from __future__ import annotations

import gzip
import json
import os
import secrets
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path

from seatsim.schema.content import plain
from seatsim.schema.errors import InputError, OutputError
from seatsim.schema.guarded import check_links_on, check_no_link, noted, uncut


def write_whole(path: Path, write: Callable[[Path], object], lasting: bool = False) -> Path:
    """Let `write` fill a temporary file next to `path`, then put it in place at once; nothing stays where it fails.

    A `lasting` file is on the disk before it is put in place, so that it survives a loss of power.

    Raises:
        InputError: the folder or the file cannot be written. OutputError: the disk is full, or failed.
    """
    _check_place(path)
    with noted(_name_part(path)) as part:
        try:
            # As any file of the user: its mode is what the umask leaves of 0o666.
            part.touch(exist_ok=False)
            write(part)
            if lasting:
                with part.open("rb") as file:
                    os.fsync(file.fileno())
            with uncut:
                part.replace(path)
        except OSError as error:
            raise OutputError(f"{path}: cannot be written: {error.strerror or error}; nothing of it is left") from error
        finally:
            part.unlink(missing_ok=True)
    return path


def write_packed(path: Path, write: Callable[[gzip.GzipFile], object], level: int = 6) -> Path:
    """Let `write` fill a gzipped file as `write_whole` does; the file holds neither its own name nor the time."""

    def pack(part: Path) -> None:
        with part.open("wb") as file, gzip.GzipFile("", "wb", level, file, mtime=0) as packed:
            write(packed)

    return write_whole(path, pack)


def write_together(folder: Path, write: Callable[[Path], Iterable[Path]]) -> list[Path]:
    """Let `write` fill a temporary folder and return its files there; then put them in `folder`, all or none.

    A file of the same name is replaced, others in the folder stay. Returns the files in `folder`, in the same order.

    Raises:
        InputError: the folder cannot be written. OutputError: the disk is full, or failed.
    """
    folder = Path(folder)
    _check_place(folder, is_folder=True)
    # Within a folder that is there: the one above it may not be writable.
    above = folder if folder.is_dir() else folder.parent
    with noted(_name_part(above / os.path.basename(os.path.abspath(folder)))) as part:
        try:
            part.mkdir()
            names = [path.relative_to(part) for path in write(part)]
            with uncut:
                _put_in_place(part, folder, names)
        except OSError as error:
            raise OutputError(f"{folder}: cannot be written: {error.strerror or error}; it is as it was") from error
        finally:
            shutil.rmtree(part, ignore_errors=True)
    return [folder / name for name in names]


def _put_in_place(part: Path, folder: Path, names: Iterable[Path]) -> None:
    """Move a folder to its place, or where something is there already its files, and all of them back if one fails."""
    if not folder.exists():
        part.rename(folder)
        return
    before = part / ".before"
    before.mkdir()
    moved: list[tuple[Path, Path]] = []
    try:
        for number, name in enumerate(names):
            place, kept = folder / name, before / str(number)
            check_no_link(folder, place.parent)
            if place.is_dir():
                raise IsADirectoryError(f"{place} is a folder")
            place.parent.mkdir(parents=True, exist_ok=True)
            if place.exists():
                # A second name, where the disk has such: the file stays in its place until the new one takes it.
                try:
                    os.link(place, kept)
                except OSError:
                    shutil.copy2(place, kept)
            moved.append((place, kept))
            (part / name).replace(place)
    except BaseException:
        for place, kept in reversed(moved):
            # A second name of a link that leads nowhere from here is there, too.
            if kept.exists() or kept.is_symlink():
                kept.replace(place)
            else:
                place.unlink(missing_ok=True)
        raise


def make_folder(folder: Path) -> None:
    """Make a folder with those above it.

    Raises:
        InputError: it cannot be written. OutputError: the disk is full, or failed.
    """
    check_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be made: {error.strerror}") from error


def check_folder(folder: Path) -> None:
    """Refuse a folder that could not be written, before anything is done.

    Raises:
        InputError: it is a file or lies in one, may not be written, its name cannot be used, or another user's link
            leads to it.
    """
    try:
        if "\0" in str(folder):
            raise ValueError("it holds a zero byte")
        check_links_on(folder)
        there = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    except (OSError, ValueError) as error:
        raise InputError(f"{str(folder)!r}: cannot be written: {error}; give another --out") from error
    if not there.is_dir():
        raise InputError(f"{folder}: cannot be written: {there} is a file; give another --out")
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(f"{folder}: cannot be written: {there} is not yours to write in; give another --out")


def _check_place(path: Path, is_folder: bool = False) -> None:
    """Make the folder above a place, and refuse a place that is taken."""
    check_folder(path if is_folder else path.parent)
    if "\0" in path.name:
        raise InputError(f"{str(path)!r}: cannot be written: it holds a zero byte; give another --out")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if not is_folder and path.is_dir():
            raise InputError(f"{path}: is a folder, where a file is to be written; remove it, or give another --out")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{str(path)!r}: cannot be written: {reason}; give another --out") from error


def _name_part(path: Path) -> Path:
    """Return the place of what is not yet whole; its ending is kept for those who write by ending."""
    # A name may have 255 bytes.
    return path.with_name(f".{path.name[:50]}.{secrets.token_hex(8)}.part{path.suffix[:10]}")


def write_text(path: Path, text: str, lasting: bool = False) -> Path:
    """Write a text file whole; `lasting` as for `write_whole`."""
    return write_whole(path, lambda part: part.write_text(text, encoding="utf-8"), lasting)


def write_bytes(path: Path, content: bytes) -> Path:
    """Write bytes whole, as `write_whole` does."""
    return write_whole(path, lambda part: part.write_bytes(content))


def write_json(path: Path, value: object, lasting: bool = False) -> Path:
    """Write JSON whole; numbers that JSON has no word for become null. `lasting` as for `write_whole`."""
    return write_text(path, json.dumps(plain(value), indent=2, allow_nan=False) + "\n", lasting)
