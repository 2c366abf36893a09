"""The lock of a sweep's folder: it names its owner, and dies with it."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from seatsim.schema.errors import InputError
from seatsim.schema.files import make_folder
from seatsim.schema.links import check_no_link, open_in_place


@contextmanager
def hold_folder(folder: Path, share: str = "") -> Iterator[None]:
    """Hold the folder of a sweep; commands for different shares of its runs, such as `2/8`, hold it together.

    The system releases the locks (flock) when the process ends, however that happens. The files stay.

    Raises:
        InputError: another process holds the folder, or the same share of it; the message names that process. Or
            something in it is a link, through which rows would be written.
    """
    make_folder(folder)
    for place in folder.iterdir():
        check_no_link(folder, place)
    if not share:
        with hold_file(folder / ".lock"):
            yield
        return
    with hold_file(folder / ".lock", alone=False), hold_file(folder / f".lock-{share.replace('/', '-of-')}"):
        yield


@contextmanager
def hold_file(path: Path, alone: bool = True, wait: bool = False) -> Iterator[None]:
    """Hold one lock file, alone or together with others that do the same; `wait` until that is possible, or fail.

    Raises:
        InputError: another process holds it.
    """
    try:
        import fcntl
    except ImportError as error:
        raise InputError(
            "a sweep locks its folder with flock, which this system has not; use Linux, macOS, or Windows' WSL"
        ) from error
    with open_in_place(path) as file:
        how = (fcntl.LOCK_EX if alone else fcntl.LOCK_SH) | (0 if wait else fcntl.LOCK_NB)
        try:
            fcntl.flock(file, how)
        except BlockingIOError as error:
            owner = file.read().strip() or "another process"
            raise InputError(
                f"{path.parent}: {owner} works on this sweep; wait for it, end it, or choose another --out"
            ) from error
        file.truncate(0)
        with suppress(OSError):  # who holds a folder is told where the disk lets it
            file.write(f"process {os.getpid()} on {socket.gethostname()}" if alone else "a command for a share of it")
            file.flush()
        yield
