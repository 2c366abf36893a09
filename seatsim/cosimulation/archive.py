"""The archive of a functional mock-up unit, read with suspicion: nothing of it is written outside a temporary folder.

Nothing of a unit runs here: `check_archive` looks at names and sizes, `unpack` writes what is needed to run it.
"""

from __future__ import annotations

import io
import platform
import stat
import sys
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath

from seatsim.schema.errors import InputError
from seatsim.schema.guarded import in_mib, read_bytes
from seatsim.schema.leftovers import temporary_folder
from seatsim.schema.modules import LARGEST_UNIT

UNPACKED = 4
"""What an archive holds may be this much larger than the largest archive."""
LARGEST_DESCRIPTION = 16 * 2**20
MOST_FILES = 10_000
DESCRIPTION = "modelDescription.xml"
SYSTEMS = {"Linux": ("linux", "linux", ".so"), "Darwin": ("darwin", "darwin", ".dylib"),
           "Windows": ("win", "windows", ".dll")}  # fmt: skip
"""Names of an operating system in versions 2 and 3, and the ending of its libraries."""
MACHINES = {"AMD64": "x86_64", "arm64": "aarch64", "x86_64": "x86_64", "aarch64": "aarch64"}


@contextmanager
def open_archive(path: Path) -> Iterator[zipfile.ZipFile]:
    """Open the archive of a unit whose names and sizes are as they must be.

    Raises:
        InputError: it is unreadable, is no archive or has no description, holds links, too much, or a path elsewhere.
    """
    content = read_bytes(path, LARGEST_UNIT, "a functional mock-up unit (.fmu)")
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            _check_entries(path, archive.infolist())
            yield archive
    except (zipfile.BadZipFile, NotImplementedError, EOFError, RuntimeError, ValueError, zlib.error) as error:
        raise InputError(f"{path}: is no archive of a functional mock-up unit: {error}") from error


def _check_entries(path: Path, entries: list[zipfile.ZipInfo]) -> None:
    if len(entries) > MOST_FILES:
        raise InputError(f"{path}: holds {len(entries)} files; permitted: at most {MOST_FILES}")
    size = sum(entry.file_size for entry in entries)
    if size > UNPACKED * LARGEST_UNIT:
        raise InputError(f"{path}: holds {in_mib(size)} unpacked; permitted: at most {in_mib(UNPACKED * LARGEST_UNIT)}")
    for entry in entries:
        name = entry.orig_filename
        parts = PurePosixPath(name).parts
        if ".." in parts or name.startswith("/") or any(sign in name for sign in "\\:\0"):
            raise InputError(f"{path}: holds {name!r}, which lies outside the unit's folder; nothing was unpacked")
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise InputError(f"{path}: holds {name!r}, which is a link; a unit has files and folders only")
    if DESCRIPTION not in {entry.filename for entry in entries}:
        raise InputError(f"{path}: has no {DESCRIPTION}, so that it is no functional mock-up unit")


def read_description(path: Path, archive: zipfile.ZipFile) -> bytes:
    """Return the text of `modelDescription.xml`, without what an XML parser could be made to follow.

    Raises:
        InputError: it is too large, or declares a document type.
    """
    if archive.getinfo(DESCRIPTION).file_size > LARGEST_DESCRIPTION:
        raise InputError(f"{path}: its {DESCRIPTION} has more than {in_mib(LARGEST_DESCRIPTION)}")
    text = archive.read(DESCRIPTION)
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        raise InputError(f"{path}: its {DESCRIPTION} declares a document type, which the standard does not have")
    return text


def find_library(path: Path, archive: zipfile.ZipFile, version: int, identifier: str) -> str:
    """Return the name within the archive of the library for this machine.

    Raises:
        InputError: there is none; the error names the platforms that the unit is for.
    """
    older, newer, ending = SYSTEMS.get(platform.system(), SYSTEMS["Linux"])
    machine = MACHINES.get(platform.machine(), platform.machine())
    here = f"{older}{64 if sys.maxsize > 2**32 else 32}" if version == 2 else f"{machine}-{newer}"
    name = f"binaries/{here}/{identifier}{ending}"
    if name in archive.namelist():
        return name
    found = sorted({entry.split("/")[1] for entry in archive.namelist() if entry.startswith("binaries/")} - {""})
    other = f"it has libraries for {', '.join(found)}" if found else "it has no library at all"
    raise InputError(
        f"{path}: has no {name}, the library for this machine; {other}; ask its supplier for this platform"
    )


@contextmanager
def unpack(path: Path, version: int, identifier: str) -> Iterator[tuple[Path, Path]]:
    """Unpack libraries of this machine and resources to a temporary folder; give it and the library.

    The folder is removed afterwards, also where a run is interrupted.
    """
    with temporary_folder("seatsim-fmu-") as name:
        folder = Path(name)
        with open_archive(path) as archive:
            library = find_library(path, archive, version, identifier)
            wanted = (f"{library.rpartition('/')[0]}/", "resources/")
            archive.extractall(folder, [entry for entry in archive.namelist() if entry.startswith(wanted)])
        (folder / "resources").mkdir(exist_ok=True)
        yield folder, folder / library
