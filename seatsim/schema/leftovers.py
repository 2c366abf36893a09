"""What a process that is ended in the middle must not leave behind, and what it must not be ended in the middle of.

Temporary folders and half-written files are noted while they are there, so that who ends the process can remove them
(`remove_leftovers`). What is done is put in place, or kept after an interrupt, under `uncut`.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import RLock

_noted: set[Path] = set()
_uncut = RLock()


@contextmanager
def temporary_folder(prefix: str = "seatsim-") -> Iterator[Path]:
    """Give a temporary folder, which is removed at the end, also where the process is ended by a signal."""
    with TemporaryDirectory(prefix=prefix, ignore_cleanup_errors=True) as name, noted(Path(name)) as folder:
        yield folder


@contextmanager
def noted(path: Path) -> Iterator[Path]:
    """Note a file or folder that is not to stay, for as long as it may be there."""
    _noted.add(path)
    try:
        yield path
    finally:
        _noted.discard(path)


@contextmanager
def uncut() -> Iterator[None]:
    """Carry something to its end, for which the end of the process waits."""
    with _uncut:
        yield


def remove_leftovers(patience: float) -> None:
    """Remove what is noted, once nothing is under way that must not be cut; it is waited for no longer than this.

    Called by whoever ends the process at once. The lock is kept, so that nothing begins after this.
    """
    _uncut.acquire(timeout=patience)
    for path in list(_noted):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
