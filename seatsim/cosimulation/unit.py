"""The native code of a unit that the user named: loaded, instantiated, and removed afterwards."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from seatsim.cosimulation.archive import unpack
from seatsim.cosimulation.damper import FmuDamper
from seatsim.cosimulation.description import CO_SIMULATION, describe_unit, need_fmpy
from seatsim.cosimulation.integrated import IntegratedUnit
from seatsim.cosimulation.running import RunningUnit
from seatsim.schema.errors import InputError
from seatsim.schema.modules import check_in_use


@contextmanager
def run_unit(damper: FmuDamper) -> Iterator[RunningUnit]:
    """Load the native code of a unit that the user named, and give it instantiated; it is ended and removed afterwards.

    Raises:
        InputError: nobody named the file, it is not what it was, or its library cannot be loaded.
    """
    path = Path(damper.file)
    check_in_use(path)
    unit, fmpy = describe_unit(path), need_fmpy()
    told: list[str] = []
    with unpack(path, unit.version, unit.identifier) as (folder, library):
        try:
            instance: Any = fmpy.instantiate_fmu(
                str(folder), unit.described, unit.kind, logger=_logger(told), library_path=str(library)
            )
        except Exception as error:  # FMPy raises plain exceptions
            said = "; ".join(told[-3:]) or str(error).strip().split("\n")[0]
            raise InputError(f"{path}: its library cannot be used: {said}") from error
        try:
            running = (RunningUnit if unit.kind == CO_SIMULATION else IntegratedUnit)(damper, unit, instance, told)
            yield running
            running.end()
        finally:
            instance.freeInstance()
            instance.freeLibrary()


def _logger(told: list[str]) -> Callable[..., None]:
    """Return what a unit tells its messages; the message is the last argument in both versions of the standard."""

    def tell(*values: Any) -> None:
        message = values[-1]
        told.append(message.decode(errors="replace") if isinstance(message, bytes) else str(message))
        del told[:-10]

    return tell
