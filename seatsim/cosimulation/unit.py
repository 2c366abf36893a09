"""The native code of a unit that the user named: loaded, instantiated, and removed afterwards."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from seatsim.cosimulation.damper import FmuDamper
from seatsim.cosimulation.description import UnitDescription, describe_unit, need_fmpy, unpack
from seatsim.cosimulation.running import RunningUnit
from seatsim.schema.errors import InputError
from seatsim.schema.modules import check_in_use

if TYPE_CHECKING:
    from fmpy.fmi1 import _FMU

PATIENCE = 30.0
"""Seconds that a library may take to load and to make an instance; others take milliseconds."""
_TRIAL = """
import sys
from pathlib import Path
from seatsim.cosimulation.unit import describe_unit, load_unit
path, folder, library = map(Path, sys.argv[1:])
load_unit(path, describe_unit(path), folder, library, [])
"""
_tried: set[bytes] = set()
"""Libraries that were loaded in a process of their own."""


@contextmanager
def run_unit(damper: FmuDamper) -> Iterator[RunningUnit]:
    """Load the native code of a unit that the user named, and give it instantiated; it is ended and removed afterwards.

    Raises:
        InputError: nobody named the file, it is not what it was, or its library cannot be loaded.
    """
    path = Path(damper.file)
    check_in_use(path)
    unit = describe_unit(path)
    told: list[str] = []
    with unpack(path, unit.version, unit.identifier) as (folder, library):
        _try_to_load(path, folder, library)
        instance = load_unit(path, unit, folder, library, told)
        try:
            running = RunningUnit(damper, unit, instance, told)
            yield running
            running.end()
        finally:
            instance.freeInstance()
            instance.freeLibrary()


def load_unit(path: Path, unit: UnitDescription, folder: Path, library: Path, told: list[str]) -> _FMU:
    """Return the instance of a unit that is unpacked in a folder; what it tells is added to `told`.

    Raises:
        InputError: its library cannot be used.
    """
    try:
        return need_fmpy().instantiate_fmu(
            str(folder), unit.described, "CoSimulation", logger=_logger(told), library_path=str(library)
        )
    except Exception as error:  # FMPy raises plain exceptions
        said = "; ".join(told[-3:]) or str(error).strip().split("\n")[0]
        raise InputError(f"{path}: its library cannot be used: {said}") from error


def _try_to_load(path: Path, folder: Path, library: Path) -> None:
    """Load a library in a process of its own before it is loaded in this one: there it can be ended where it hangs.

    Raises:
        InputError: it hangs or crashes.
    """
    content = library.read_bytes()
    if content in _tried:
        return
    words = [sys.executable, "-P", "-c", _TRIAL, *map(str, (path, folder, library))]
    try:
        done = subprocess.run(words, capture_output=True, stdin=subprocess.DEVNULL, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        raise InputError(
            f"{path}: its library is not loaded after {PATIENCE:g} s; ask its supplier for another"
        ) from None
    if done.returncode < 0:
        raise InputError(f"{path}: its library crashes as it is loaded (signal {-done.returncode})")
    _tried.add(content)


def _logger(told: list[str]) -> Callable[..., None]:
    """Return what a unit tells its messages; the message is the last argument in both versions of the standard."""

    def tell(*values: object) -> None:
        message = values[-1]
        told.append(message.decode(errors="replace") if isinstance(message, bytes) else str(message))
        del told[:-10]

    return tell
