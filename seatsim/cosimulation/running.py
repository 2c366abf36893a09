"""A unit that runs: parameters and inputs in, its force out."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from seatsim.cosimulation.damper import FmuDamper
from seatsim.cosimulation.description import FORCE, REAL, UnitDescription, find_conversion_of, find_variable
from seatsim.schema.errors import RunError

if TYPE_CHECKING:
    from fmpy.fmi1 import _FMU

_T = TypeVar("_T")


class RunningUnit:
    """A unit between its start and its end; motion, current and temperature in, force out, all in SI units and degC."""

    def __init__(self, damper: FmuDamper, unit: UnitDescription, instance: _FMU, told: list[str]) -> None:
        self.repeats = unit.saves
        self.takes_acceleration = "acceleration" in dict(damper.inputs)
        self._file, self._unit, self._instance, self._told = damper.file, unit, instance, told
        self._inputs = [
            (quantity, found.valueReference, find_conversion_of(found, quantity))
            for quantity, name in damper.inputs
            for found in [find_variable(unit, name, "input")]
        ]
        output = find_variable(unit, damper.output, "output")
        self._output, self._force = output.valueReference, find_conversion_of(output, FORCE)

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
        word = "Real" if found.type in REAL and self._unit.version == 2 else found.type
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
