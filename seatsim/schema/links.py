"""Nothing is written through a link, behind which somebody else may have put a file that is not to change."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TextIO

from seatsim.schema.errors import InputError, OutputError


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
