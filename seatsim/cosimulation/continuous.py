"""What a unit for model exchange is asked: its rates and events; the calls of both versions of the standard alike."""

from __future__ import annotations

from ctypes import c_double
from typing import Any, NamedTuple

from seatsim.cosimulation.description import UnitDescription

States = list[float]


class Update(NamedTuple):
    """What a unit answers to an event: whether it is to be asked again, whether it ends, the next event that it knows.

    `next_event` in s is None where it knows none.
    """

    again: bool
    ends: bool
    next_event: float | None


class ContinuousModel:
    """A unit for model exchange with its states, in the mode that the standard prescribes for each call."""

    def __init__(self, unit: UnitDescription, instance: Any) -> None:
        self._instance = instance
        self._is_second = unit.version == 2
        described = unit.described
        self._states = (c_double * described.numberOfContinuousStates)()
        self._rates = (c_double * described.numberOfContinuousStates)()
        self._indicators = (c_double * described.numberOfEventIndicators)()
        self.needs_completion = bool(described.modelExchange.needsCompletedIntegratorStep)
        self.has_indicators = described.numberOfEventIndicators > 0

    def states(self) -> States:
        """Return the continuous states."""
        if len(self._states):
            self._instance.getContinuousStates(self._states, len(self._states))
        return list(self._states)

    def place(self, time: float, states: States) -> None:
        """Give the unit a time in s and its continuous states."""
        self._instance.setTime(time)
        if states:
            self._states[:] = states
            self._instance.setContinuousStates(self._states, len(states))

    def rates(self) -> States:
        """Return the time derivatives of the states, at the time, states and inputs that were given last."""
        if len(self._rates):
            ask = self._instance.getDerivatives if self._is_second else self._instance.getContinuousStateDerivatives
            ask(self._rates, len(self._rates))
        return list(self._rates)

    def signs(self) -> list[bool]:
        """Return for each event indicator whether it is positive; an event is where one of these changes."""
        if len(self._indicators):
            self._instance.getEventIndicators(self._indicators, len(self._indicators))
        return [value > 0.0 for value in self._indicators]

    def complete(self, is_final: bool) -> tuple[bool, bool]:
        """Tell the unit that a step has ended; return whether it wants an event and whether it ends the run."""
        wants_event, ends = self._instance.completedIntegratorStep(is_final)
        return bool(wants_event), bool(ends)

    def enter_event(self) -> None:
        """Enter the mode in which discrete states change."""
        self._instance.enterEventMode()

    def update(self) -> Update:
        """Let the discrete states change once."""
        ask = self._instance.newDiscreteStates if self._is_second else self._instance.updateDiscreteStates
        again, ends, _nominals, _values, is_known, next_event = ask()
        return Update(bool(again), bool(ends), float(next_event) if is_known else None)

    def leave_event(self) -> None:
        """Enter the mode in which time goes on."""
        self._instance.enterContinuousTimeMode()
