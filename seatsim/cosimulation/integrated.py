"""A unit for model exchange: it states the rates of its states, and they are integrated here.

A step of the seat is divided into equal parts no longer than the step that the unit recommends, each a step of the
classical Runge-Kutta method of order 4. A part ends early where an event indicator changes its sign, which is located
by bisection, and where the unit has announced an event.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from ctypes import c_double
from typing import TYPE_CHECKING, NamedTuple

from seatsim.cosimulation.damper import FmuDamper
from seatsim.cosimulation.description import UnitDescription
from seatsim.cosimulation.running import RunningUnit
from seatsim.schema.errors import RunError

if TYPE_CHECKING:
    from fmpy.fmi1 import _FMU

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
