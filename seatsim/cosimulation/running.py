"""A unit that runs: parameters and inputs in, its force out; one for co-simulation steps itself.

One for model exchange states the rates of its states, and they are integrated here. A step of the seat is divided into
equal parts no longer than the step that the unit recommends, each a step of the classical Runge-Kutta method of order
4. A part ends early where an event indicator changes its sign, which is located by bisection, and where the unit has
announced an event.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from ctypes import c_double
from functools import partial
from typing import TYPE_CHECKING, NamedTuple, TypeVar

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


_States = list[float]


_LOCATED = 1e-9
"""Share of a step of the seat to which an event is located; at 1 ms, a picosecond."""
_MOST_EVENTS = 100
"""Most events within a step of the seat, and most times that a unit is asked to update at one of them."""


class _Motion(NamedTuple):
    """What the unit is given over a step of `length` s that begins at `begin` s.

    The motion has the constant acceleration of `given`, the current runs linearly from `current` in A to that of
    `given`, and the temperature is constant.
    """

    begin: float
    length: float
    given: Mapping[str, float]
    current: float

    def at(self, time: float) -> dict[str, float]:
        """Return the inputs at a time in s."""
        age, given = time - self.begin, self.given
        x, v, a = given["displacement"], given["velocity"], given["acceleration"]
        return {
            "displacement": x + age * (v + 0.5 * age * a),
            "velocity": v + age * a,
            "acceleration": a,
            "current": self.current + (given["current"] - self.current) * age / self.length,
            "temperature": given["temperature"],
        }


class _Saved(NamedTuple):
    """What a step begins with: states, signs of the indicators, next event and current; the unit's own state, if any.

    `next_event` in s, infinite where none is known.
    """

    states: _States
    signs: list[bool]
    next_event: float
    current: float
    own: object


class IntegratedUnit(RunningUnit):
    """A unit for model exchange that runs, with the interface of one for co-simulation."""

    def __init__(self, damper: FmuDamper, unit: UnitDescription, instance: _FMU, told: list[str]) -> None:
        super().__init__(damper, unit, instance, told)
        self.takes_acceleration = True
        described, self._is_second = unit.described, unit.version == 2
        self._states, self._rates = ((c_double * described.numberOfContinuousStates)() for _ in range(2))
        self._indicators = (c_double * described.numberOfEventIndicators)()
        self._needs_completion = bool(described.modelExchange.needsCompletedIntegratorStep)
        longest = getattr(described.defaultExperiment, "stepSize", None)
        self._longest = float(longest) if longest else math.inf
        self._now = _Saved([], [], math.inf, 0.0, None)

    def start(self, damper: FmuDamper, given: Mapping[str, float]) -> float:
        """Initialise the unit as one for co-simulation is, and let it begin; return its force in N."""
        super().start(damper, given)
        self._now = _Saved([], [], math.inf, given["current"], None)
        self._update(0.0)
        return self._read(0.0)

    def step(self, time: float, length: float, given: Mapping[str, float]) -> float:
        """Integrate from `time` by `length`, both in s; return the force in N at the end.

        Raises:
            RunError: the unit refuses a call, ends the run, has too many events, or its force is no finite number.
        """
        motion = _Motion(time, length, given, self._now.current)
        part = length / max(1, math.ceil(length / self._longest - _LOCATED))
        end, events = time + length, 0
        while end - time > _LOCATED * length:
            reach = min(time + part, end, max(self._now.next_event, time))
            if end - reach <= _LOCATED * length:
                reach = end
            time, has_event = self._call(lambda: self._advance(motion, time, reach), f"the step from {time:.6g} s")  # noqa: B023
            if has_event:
                events += 1
                self._update(time)
            if events > _MOST_EVENTS:
                raise RunError(f"{self._file}: the unit has more than {_MOST_EVENTS} events before {time:.6g} s")
        self._now = self._now._replace(current=given["current"])
        return self._read(end)

    def save(self) -> _Saved:
        """Return the states, and the unit's own state where it can save that."""
        return self._now._replace(own=super().save() if self._unit.saves else None)

    def restore(self, state: object) -> None:
        """Go back to what `save` returned."""
        assert isinstance(state, _Saved)
        if self._unit.saves:
            super().restore(state.own)
        self._now = state._replace(own=None)

    def drop(self, state: object) -> None:
        """Free what `save` returned."""
        assert isinstance(state, _Saved)
        if self._unit.saves:
            super().drop(state.own)

    def _advance(self, motion: _Motion, time: float, reach: float) -> tuple[float, bool]:
        """Go on from a time to another, or to the first event before; return the time and whether an event is there."""
        begun = self._now.states
        states = self._runge_kutta(motion, time, reach - time, begun)
        signs = self._signs_at(motion, reach, states)
        has_crossed = signs != self._now.signs
        low, high = time, reach
        while has_crossed and high - low > _LOCATED * motion.length:
            middle = 0.5 * (low + high)
            tried = self._runge_kutta(motion, time, middle - time, begun)
            found = self._signs_at(motion, middle, tried)
            if found == self._now.signs:
                low = middle
            else:
                high, states, signs = middle, tried, found
        self._signs_at(motion, high, states)
        wants_event = False
        if self._needs_completion:
            wants_event, ends = self._instance.completedIntegratorStep(not self.repeats)
            self._check_going_on(ends, high)
        self._now = self._now._replace(states=states, signs=signs)
        return high, has_crossed or wants_event or high >= self._now.next_event

    def _runge_kutta(self, motion: _Motion, time: float, h: float, y: _States) -> _States:
        """Return the states after `h` seconds, by the classical method of order 4."""
        k1 = self._rates_at(motion, time, y)
        k2 = self._rates_at(motion, time + 0.5 * h, [a + 0.5 * h * k for a, k in zip(y, k1, strict=True)])
        k3 = self._rates_at(motion, time + 0.5 * h, [a + 0.5 * h * k for a, k in zip(y, k2, strict=True)])
        k4 = self._rates_at(motion, time + h, [a + h * k for a, k in zip(y, k3, strict=True)])
        slopes = zip(y, k1, k2, k3, k4, strict=True)
        return [a + h / 6.0 * (p + 2.0 * (q + r) + s) for a, p, q, r, s in slopes]

    def _rates_at(self, motion: _Motion, time: float, states: _States) -> _States:
        if not states:
            return states
        self._place(motion, time, states)
        ask = self._instance.getDerivatives if self._is_second else self._instance.getContinuousStateDerivatives
        ask(self._rates, len(self._rates))
        return list(self._rates)

    def _signs_at(self, motion: _Motion, time: float, states: _States) -> list[bool]:
        """Return for each event indicator whether it is positive; an event is where one of these changes."""
        self._place(motion, time, states)
        return self._read_signs()

    def _read_signs(self) -> list[bool]:
        if len(self._indicators):
            self._instance.getEventIndicators(self._indicators, len(self._indicators))
        return [value > 0.0 for value in self._indicators]

    def _place(self, motion: _Motion, time: float, states: _States) -> None:
        """Give the unit a time in s, its continuous states and its inputs."""
        self._instance.setTime(time)
        if states:
            self._states[:] = states
            self._instance.setContinuousStates(self._states, len(states))
        self._give(motion.at(time), time)

    def _update(self, time: float) -> None:
        """Let the unit treat an event at a time, or begin at time zero, where it is in the mode for that."""
        self._now = self._call(lambda: self._updated(time), f"the event at {time:.6g} s")
        # What an event changes within a unit can be taken back only where the unit saves its state.
        has_events = bool(len(self._indicators)) or self._needs_completion or math.isfinite(self._now.next_event)
        self.repeats = self._unit.saves or not has_events

    def _updated(self, time: float) -> _Saved:
        unit = self._instance
        ask = unit.newDiscreteStates if self._is_second else unit.updateDiscreteStates
        if time > 0.0:
            unit.enterEventMode()
        for _ in range(_MOST_EVENTS):
            again, ends, _nominals, _values, is_known, next_event = ask()
            self._check_going_on(ends, time)
            if not again:
                break
        else:
            raise RunError(f"{self._file}: the unit does not come to an end with its event at {time:.6g} s")
        unit.enterContinuousTimeMode()
        if len(self._states):
            unit.getContinuousStates(self._states, len(self._states))
        later = float(next_event) if is_known else math.inf
        return self._now._replace(states=list(self._states), signs=self._read_signs(), next_event=later)

    def _check_going_on(self, ends: object, time: float) -> None:
        if ends:
            raise RunError(f"{self._file}: the unit ended at {time:.6g} s, before the run does")
