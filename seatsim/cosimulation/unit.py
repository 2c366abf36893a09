"""A unit that the user named: its native code is loaded, runs, and is removed afterwards.

Parameters and inputs go in, its force comes out.
"""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from seatsim.cosimulation import description
from seatsim.cosimulation.damper import FmuDamper
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.modules import check_in_use

if TYPE_CHECKING:
    from fmpy.fmi1 import _FMU

_T = TypeVar("_T")


class RunningUnit:
    """A unit between its start and its end; motion, current and temperature in, force out, all in SI units and degC."""

    def __init__(self, damper: FmuDamper, unit: description.UnitDescription, instance: _FMU, told: list[str]) -> None:
        self.repeats = unit.saves
        self.takes_acceleration = "acceleration" in dict(damper.inputs)
        self._file, self._unit, self._instance, self._told = damper.file, unit, instance, told
        self._inputs = [
            (quantity, found.valueReference, description.find_conversion_of(found, quantity))
            for quantity, name in damper.inputs
            for found in [description.find_variable(unit, name, "input")]
        ]
        output = description.find_variable(unit, damper.output, "output")
        self._output, self._force = output.valueReference, description.find_conversion_of(output, description.FORCE)

    def start(self, damper: FmuDamper, given: Mapping[str, float]) -> float:
        """Initialise the unit with its parameters and the inputs at time zero; return its force in N.

        Raises:
            RunError: the unit refuses, or its force is no finite number.
        """
        if self._unit.version == 2:
            self._call(lambda: self._instance.setupExperiment(startTime=0.0), "its set-up")
        for name, value in damper.parameters:
            self._call(partial(self._set_parameter, name, value), f"parameter {name} = {value}")
        self._call(self._instance.enterInitializationMode, "its initialisation")
        self._give(given, 0.0)
        self._call(self._instance.exitInitializationMode, "the end of its initialisation")
        return self._read(0.0)

    def step(self, time: float, length: float, given: Mapping[str, float]) -> float:
        """Step from `time` by `length`, both in s, with inputs that are held; return the force in N at the end.

        Raises:
            RunError: the unit refuses the step, stops before its end, or its force is no finite number.
        """
        self._give(given, time)
        ended = self._call(lambda: self._instance.doStep(time, length, not self.repeats), f"the step from {time:.6g} s")
        if ended is not None and (ended[1] or ended[2]):
            raise RunError(f"{self._file}: the unit ended at {ended[3]:.6g} s, before the run does")
        return self._read(time + length)

    def save(self) -> object:
        """Return the unit's state, to which `restore` goes back."""
        return self._call(self._instance.getFMUState, "saving its state")

    def restore(self, state: object) -> None:
        """Go back to a saved state."""
        self._call(lambda: self._instance.setFMUState(state), "restoring its state")

    def drop(self, state: object) -> None:
        """Free a saved state."""
        self._call(lambda: self._instance.freeFMUState(state), "freeing its state")

    def end(self) -> None:
        """Tell the unit that the run is over; some write their results then."""
        self._call(self._instance.terminate, "its end")

    def _give(self, given: Mapping[str, float], time: float) -> None:
        references = [reference for _, reference, _ in self._inputs]
        values = [(given[quantity] - how.zero) / how.factor for quantity, _, how in self._inputs]
        put = self._instance.setReal if self._unit.version == 2 else self._instance.setFloat64
        self._call(lambda: put(references, values), f"its inputs at {time:.6g} s")

    def _read(self, time: float) -> float:
        get = self._instance.getReal if self._unit.version == 2 else self._instance.getFloat64
        (value,) = self._call(lambda: get([self._output]), f"reading its force at {time:.6g} s")
        force = float(self._force.factor * value + self._force.zero)
        if not math.isfinite(force):
            raise RunError(f"{self._file}: the unit gives a force of {force} N at {time:.6g} s")
        return force

    def _set_parameter(self, name: str, value: float) -> None:
        found = self._unit.variables[name]
        word = "Real" if found.type in description.REAL and self._unit.version == 2 else found.type
        getattr(self._instance, f"set{word}")([found.valueReference], [value])

    def _call(self, what: Callable[[], _T], of: str) -> _T:
        """Call the unit; what it says where it fails stands in the error."""
        try:
            return what()
        except RunError:
            raise
        except Exception as error:  # FMPy raises plain exceptions too
            said = "; ".join(self._told[-3:]) or str(error).strip().split("\n")[0]
            raise RunError(f"{self._file}: the unit failed at {of}: {said}") from error


PATIENCE = 180.0
"""Seconds in which a process must have started, loaded a library and made an instance, on a slow computer too."""
_TRIAL = """
import sys
from pathlib import Path
from seatsim.cosimulation import description
from seatsim.cosimulation.unit import load_unit
path, folder, library = map(Path, sys.argv[1:])
load_unit(path, description.describe_unit(path), folder, library, [])
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
    unit = description.describe_unit(path)
    told: list[str] = []
    with description.unpack(path, unit.version, unit.identifier) as (folder, library):
        _try_to_load(path, folder, library)
        instance = load_unit(path, unit, folder, library, told)
        try:
            running = RunningUnit(damper, unit, instance, told)
            yield running
            running.end()
        finally:
            instance.freeInstance()
            instance.freeLibrary()


def load_unit(path: Path, unit: description.UnitDescription, folder: Path, library: Path, told: list[str]) -> _FMU:
    """Return the instance of a unit that is unpacked in a folder; what it tells is added to `told`.

    Raises:
        InputError: its library cannot be used.
    """
    try:
        return description.need_fmpy().instantiate_fmu(
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
        problem = f"{path}: its library is not loaded after {PATIENCE:g} s; ask its supplier for another"
        raise InputError(problem) from None
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
