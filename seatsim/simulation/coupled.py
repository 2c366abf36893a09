"""A seat whose damper is a unit of another program: the rig's steps are compiled, the loop over them is Python.

The loop is `seatsim.kernel.loop.run_loop`, whose steps are made here with the unit. Over a step the rig feels the
mean of the unit's force at both ends, `(F_k + F_k+1) / 2`, and the unit the motion that follows from it:

    state_k+1 = rig(state_k, (F_k + F_k+1) / 2),   F_k+1 = unit(motion of that step)

A unit that can repeat a step is asked until both agree, by false position (Illinois): the trapezoidal rule in the
force, of order 2 and stable for any damping. One that cannot is asked once, with the mean extrapolated from the last
two forces: of order 2 too, but stable only while damping times step is well below the mass of the frame.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from seatsim.compilation.cached import compiled
from seatsim.cosimulation.damper import CoupledForce, FmuDamper
from seatsim.cosimulation.unit import RunningUnit, run_unit
from seatsim.effects.base import ON_DAMPER, acts_on
from seatsim.kernel.generic import wants_force
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.loop import run_loop, warm_up
from seatsim.kernel.loop_data import LoopInputs, LoopSetup
from seatsim.kernel.rig import Disturbance, Rig
from seatsim.kernel.step import IntegratorState, StepInputs, advance, disturbance_at, start
from seatsim.rig.coil import Coil
from seatsim.rig.state import DAMPER_WORK, DISPLACEMENT, VELOCITY, State
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling
from seatsim.scenario.scenario import DamperChoice, Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.registry import name_of

_AGREED = 1e-7
"""Difference between the force that the rig felt and that of the unit, over its size plus 1 N, at which a step ends."""
_MOST_TRIALS = 30
"""Most times that a unit is asked to repeat a step; two are enough where its force is linear in the motion."""


def stand_in(scenario: Scenario) -> Scenario:
    """Return a scenario with a force in place of the unit that its damper is.

    Raises:
        InputError: an effect acts within the damper.
    """
    for effect in scenario.effects:
        if acts_on(type(effect), (*ON_DAMPER, "factors")):
            with scenario.placed("effects"):
                name = name_of("effect", type(effect))
                problem = f"{name} acts within the damper, which is a unit that cannot be looked into; remove it"
                raise InputError(problem)
    return replace(scenario, damper=DamperChoice(CoupledForce(), TemperatureFactors()))


def run_coupled(
    damper: FmuDamper, setup: LoopSetup, inputs: LoopInputs, states: tuple[State, State, State], out: Array
) -> int:
    """Simulate from rest and fill `out` as `run_loop` does; return the samples reached.

    Raises:
        InputError: the unit cannot be used, or the law needs an inverse and none is stated. RunError: the unit failed.
    """
    if wants_force(setup.law) and isinstance(setup.inverse_model.damper, CoupledForce):
        raise InputError(
            "the law wants a force, and a damper that is a unit has no inverse; state under controller the damper that"
            " the inverse assumes: inverse: {model: NAME, parameters: {...}}"
        )
    with run_unit(damper) as unit:
        rig = _CoupledRig(*setup.rig)
        rig.damper_unit, rig.unit, rig.setup, rig.inputs = damper, unit, setup, inputs
        return run_loop(setup._replace(rig=rig), inputs, *states, out, np.empty(CELLS + 1))


class _CoupledRig(Rig):
    """A rig whose steps are made with a unit: `start` and `advance` of the time loop are its own methods.

    `before` is the unit's force in N at the last sample but one, `temperature` the damper's in degC, `reached` the
    number of steps that were made.
    """

    damper_unit: FmuDamper
    unit: RunningUnit
    setup: LoopSetup
    inputs: LoopInputs
    before: float
    temperature: float
    reached: int = 0

    def start(
        self, state: State, disturbance: Disturbance, current: float, scaling: TemperatureScaling, substep: float
    ) -> IntegratorState:
        """Start the unit, and return the state of the integration under its force."""
        self.temperature = float(self.inputs.temperature[0])
        self.before = self.unit.start(self.damper_unit, self._motion(state, state, current))
        return self._feel(self.before, state, disturbance, current, scaling, substep)

    def advance(
        self, coil: Coil, acting: StepInputs, scaling: TemperatureScaling, now: IntegratorState, tolerance: float
    ) -> tuple[IntegratorState, float, bool]:
        """Return the rig and the current after the next step, and whether the rig stayed within bounds."""
        unit, force, reached, time = self.unit, now.forces.damper_force, True, self.reached * acting.length
        found: tuple[IntegratorState, float, float] = (now, acting.current, force)

        def miss(trial: float) -> float:
            """Make the step as if the unit's force ended at `trial`, and return by how much it ends elsewhere."""
            nonlocal found, reached
            felt = 0.5 * (force + trial)
            begun = self._feel(felt, now.state, disturbance_at(acting, 0.0), acting.current, scaling, now.substep)
            rig, parts = self._under(felt)
            later, current, reached = compiled(_advance, parts)(rig, coil, acting, scaling, begun, tolerance)
            if not reached:
                return 0.0
            answer = unit.step(time, acting.length, self._motion(now.state, later.state, current))
            found = later, current, answer
            return answer - trial

        if unit.repeats:
            state = unit.save()
            try:
                _agree(miss, force, lambda: unit.restore(state))
            finally:
                unit.drop(state)
        else:
            miss(2.0 * force - self.before)
        later, current, self.before = *found[:2], force
        self.reached += 1
        # The damper's temperature in degC is followed as the loop does.
        if self.setup.timing.self_heating:
            work = later.state[DAMPER_WORK] - now.state[DAMPER_WORK]
            self.temperature += warm_up(
                self.setup.thermal, coil, self.temperature, work, acting.current, current, acting.length
            )
        else:
            self.temperature = float(self.inputs.temperature[self.reached])
        at_end = disturbance_at(acting, acting.length)
        return self._feel(found[2], later.state, at_end, current, scaling, later.substep), current, reached

    def _under(self, force: float) -> tuple[Rig, tuple[type, ...]]:
        """Return the rig of compiled code under a force of the unit in N, and the classes that it is compiled for."""
        return Rig(self.plant, CoupledForce(force), self.effects), (CoupledForce, *map(type, self.effects))

    def _feel(
        self,
        force: float,
        state: State,
        disturbance: Disturbance,
        current: float,
        scaling: TemperatureScaling,
        substep: float,
    ) -> IntegratorState:
        """Return the integration begun in a state under a force of the unit in N."""
        rig, parts = self._under(force)
        return compiled(_start, parts)(rig, state, disturbance, current, scaling, substep)

    def _motion(self, first: State, last: State, current: float) -> dict[str, float]:
        """Return what the unit is given for a step: where it begins, and how it goes on where that can be said.

        A unit that takes an acceleration goes on by itself from the motion at the beginning of the step; any other
        holds what it is given, which is then the motion at the end.
        """
        ratio, length = self.plant.damper_ratio, self.setup.timing.step
        given = first if self.unit.takes_acceleration else last
        return {
            "displacement": ratio * given[DISPLACEMENT],
            "velocity": ratio * given[VELOCITY],
            "acceleration": ratio * (last[VELOCITY] - first[VELOCITY]) / length,
            "current": current,
            "temperature": self.temperature,
        }


def _start(
    rig: Rig, state: State, disturbance: Disturbance, current: float, scaling: TemperatureScaling, substep: float
) -> IntegratorState:
    """Return what the kernel's `start` does, as a function to be compiled by itself."""
    return start(rig, state, disturbance, current, scaling, substep)


def _advance(
    rig: Rig, coil: Coil, acting: StepInputs, scaling: TemperatureScaling, now: IntegratorState, tolerance: float
) -> tuple[IntegratorState, float, bool]:
    """Return what the kernel's `advance` does, likewise."""
    return advance(rig, coil, acting, scaling, now, tolerance)


def _agree(miss: Callable[[float], float], guess: float, again: Callable[[], None]) -> None:
    """Find the force at which `miss` is zero; `again` takes the unit back before each further trial.

    The force of a damper falls where the rig felt more of it, so that the guess and its answer are on both sides.

    Raises:
        RunError: rig and unit do not agree on a force, as where the unit's force jumps.
    """
    low, m_low = guess, miss(guess)
    if abs(m_low) <= _AGREED * (1.0 + abs(low)):
        return
    high = low + m_low
    again()
    m_high = miss(high)
    for _ in range(_MOST_TRIALS):
        if abs(m_high) <= _AGREED * (1.0 + abs(high)):
            return
        if m_high == m_low:
            break
        trial = high - m_high * (high - low) / (m_high - m_low)
        again()
        m_trial = miss(trial)
        if m_trial * m_high < 0.0:
            low, m_low = high, m_high
        else:
            m_low *= 0.5
        high, m_high = trial, m_trial
    raise RunError(
        f"rig and unit differ by {abs(m_high):.3g} N after up to {_MOST_TRIALS} trials of a step; shorten solver.step"
    )
