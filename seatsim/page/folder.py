"""What the page may read and write: files of one folder, of a stated size."""

from __future__ import annotations

import re
from pathlib import Path

from seatsim.schema.errors import InputError

LARGEST = 50_000_000
"""Bytes of the largest file that is read."""
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._ -]{0,80}")


class NotInFolderError(InputError):
    """A path leads out of the folder, or to nothing."""


class TooLargeError(InputError):
    """A file is larger than the page reads."""


class Folder:
    """A folder from which files are read by paths relative to it; links that lead out of it are refused."""

    def __init__(self, root: Path) -> None:
        """Take a folder."""
        self.root = root.resolve()

    def find(self, relative: str) -> Path:
        """Return the path of a file or folder inside.

        Raises:
            NotInFolderError: it lies outside, is hidden, or does not exist.
            TooLargeError: it is larger than `LARGEST`.
        """
        parts = Path(relative).parts
        if "\0" in relative or any(part == ".." or part.startswith(".") for part in parts):
            raise NotInFolderError(f"{relative!r}: not a path inside {self.root.name}")
        path = (self.root / relative).resolve()
        if not path.is_relative_to(self.root) or not path.exists():
            raise NotInFolderError(f"{relative!r}: no such file in {self.root.name}")
        if path.is_file() and path.stat().st_size > LARGEST:
            raise TooLargeError(f"{relative}: larger than {LARGEST / 1e6:.0f} MB, which is the most that is read")
        return path

    def name_new(self, name: str) -> Path:
        """Return the path of a new scenario in the folder.

        Raises:
            InputError: the name cannot be used, or is taken.
        """
        stem = name.strip().removesuffix(".yaml")
        if not NAME.fullmatch(stem):
            raise InputError(f"{name!r}: a name of letters, digits, spaces, '.', '-' and '_', beginning with a letter")
        path = self.root / f"{stem}.yaml"
        if path.exists():
            raise InputError(f"{path.name}: is there already, and is not replaced; give another name")
        return path
