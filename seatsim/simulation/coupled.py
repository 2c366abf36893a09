"""A seat whose damper is a unit of another program: the rig's steps are compiled, the loop over them is Python.

One pass is what one pass of `seatsim.kernel.loop.run_loop` is, with the same functions. Over a step the rig feels the
mean of the unit's force at both ends, `(F_k + F_k+1) / 2`, and the unit the motion that follows from it:

    state_k+1 = rig(state_k, (F_k + F_k+1) / 2),   F_k+1 = unit(motion of that step)

A unit that can repeat a step is asked until both agree, by false position (Illinois): the trapezoidal rule in the
force, of order 2 and stable for any damping. One that cannot is asked once, with the mean extrapolated from the last
two forces: of order 2 too, but stable only while damping times step is well below the mass of the frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from seatsim.compilation.cached import compiled
from seatsim.cosimulation.damper import CoupledForce, FmuDamper
from seatsim.cosimulation.running import RunningUnit
from seatsim.cosimulation.unit import run_unit
from seatsim.effects.base import ON_DAMPER, acts_on
from seatsim.kernel import step as kernel_step
from seatsim.kernel.assumed_model import follow_state, model_scaling
from seatsim.kernel.generic import advance_filters, read, scaling_at, update, wants_force
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.loop import ROUNDING, decide, measure, warm_up
from seatsim.kernel.loop_inputs import LoopInputs, LoopSetup, sample_of, step_inputs
from seatsim.kernel.recorders import Sample, keep_rows
from seatsim.kernel.rig import Disturbance
from seatsim.kernel.step import IntegratorState, StepInputs, relaxed
from seatsim.rig.state import DAMPER_WORK, DISPLACEMENT, VELOCITY, State
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling
from seatsim.scenario.scenario import DamperChoice, Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.registry import name_of

AGREED = 1e-7
"""Difference between the force that the rig felt and that of the unit, over its size plus 1 N, at which a step ends."""
MOST_TRIALS = 30
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
                raise InputError(
                    f"{name} acts within the damper, which is a unit that cannot be looked into; remove it"
                )
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
        return _Loop(unit, setup, inputs).run(damper, states, out)


class _Loop:
    """The constant parts of a run with a unit."""

    def __init__(self, unit: RunningUnit, setup: LoopSetup, inputs: LoopInputs) -> None:
        self.unit, self.setup, self.inputs = unit, setup, inputs
        parts = (CoupledForce, *map(type, setup.rig.effects))
        self.advance = compiled(kernel_step.advance, parts)
        self.restart = compiled(kernel_step.start, parts)

    def run(self, damper: FmuDamper, states: tuple[State, State, State], out: Array) -> int:
        """Run from time zero; the passes are those of `run_loop`."""
        setup, inputs, timing, coil, model = (
            self.setup, self.inputs, self.setup.timing, self.setup.coil, self.setup.inverse_model
        )  # fmt: skip
        step, samples, ratio, recorder = timing.step, len(out), setup.rig.plant.damper_ratio, keep_rows(out)
        late = math.floor(coil.delay / step + ROUNDING)
        split = coil.delay - late * step
        split = split if split >= ROUNDING * step else 0.0
        kept = (1.0 - relaxed(coil, 0.0, 1.0, 0.5 * step), relaxed(coil, 1.0, 0.0, 0.5 * step))
        current, temperature, sensed = inputs.start_current, float(inputs.temperature[0]), inputs.sensed
        factors = scaling_at(setup.factors, temperature)
        rig_state, followed, law_state = states
        state = (inputs.start_displacement, inputs.start_velocity, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, *rig_state)
        force = self.unit.start(damper, self._motion(state, state, current, temperature))
        before, substep, command, wanted, served = force, step, 0.0, math.nan, math.nan
        grid = np.empty(CELLS + 1)
        for k in range(samples):
            floor = float(inputs.floor_acceleration[k])
            now = self._feel(force, state, k, current, factors, substep)
            sensed = advance_filters(setup.sensors, floor, now.state[DISPLACEMENT], now.rates, sensed)
            if k % timing.sample_every == 0:
                replayed = float(inputs.replayed[k]) if len(inputs.replayed) else math.nan
                speed = float(inputs.floor_velocity[k])
                true = measure(now, k * step, floor, speed, current, temperature, replayed)
                y, sensed = read(setup.sensors, true, inputs.noise, k // timing.sample_every, sensed)
                command, wanted, served = decide(setup, y, now, factors, followed, law_state, grid)
                law_state = update(setup.law, y, law_state)
            sample = Sample(floor, wanted, served, current, command, temperature)
            recorder.keep((), setup.rig, k, now, sample)
            if k == samples - 1:
                break
            acting = step_inputs(setup, inputs, recorder, k, current, late, split, kept)
            found = self._step(acting, k, now, force, before, temperature, factors)
            if found is None:
                return k
            later, next_current, before, force = *found[:2], force, found[2]
            x, v, work = state[DISPLACEMENT], state[VELOCITY], state[DAMPER_WORK]
            state, substep = later.state, later.substep
            followed = follow_state(
                model.damper, followed, ratio * x, ratio * v, ratio * state[DISPLACEMENT], ratio * state[VELOCITY],
                0.5 * (current + next_current), model_scaling(model, factors, temperature), step,
            )  # fmt: skip
            if timing.self_heating:
                work = state[DAMPER_WORK] - work
                temperature += warm_up(setup.thermal, coil, temperature, work, current, next_current, step)
            else:
                temperature = float(inputs.temperature[k + 1])
            factors = scaling_at(setup.factors, temperature)
            current = next_current
        return samples

    def _feel(
        self, force: float, state: State, k: int, current: float, factors: TemperatureScaling, substep: float
    ) -> IntegratorState:
        """Return the integration begun in a state at sample `k` under a force of the unit."""
        inputs = self.inputs
        disturbance = Disturbance(
            float(inputs.floor_acceleration[k]), sample_of(inputs.frame_force, k), sample_of(inputs.driver_force, k)
        )
        rig = self.setup.rig._replace(damper=CoupledForce(force))
        return self.restart(rig, state, disturbance, current, factors, substep)

    def _step(
        self, acting: StepInputs, k: int, now: IntegratorState, force: float, before: float, temperature: float,
        factors: TemperatureScaling,
    ) -> tuple[IntegratorState, float, float] | None:  # fmt: skip
        """Return the rig, the current and the unit's force after the step from sample `k`; None where the rig diverged.

        `force` is the unit's at this sample, `before` that of the last one.
        """
        unit, reached = self.unit, True
        found: tuple[IntegratorState, float, float] = (now, acting.current, force)

        def miss(trial: float) -> float:
            """Make the step as if the unit's force ended at `trial`, and return by how much it ends elsewhere."""
            nonlocal found, reached
            felt = 0.5 * (force + trial)
            begun = self._feel(felt, now.state, k, acting.current, factors, now.substep)
            rig = self.setup.rig._replace(damper=CoupledForce(felt))
            later, current, reached = self.advance(
                rig, self.setup.coil, acting, factors, begun, self.setup.timing.tolerance
            )
            if not reached:
                return 0.0
            motion = self._motion(now.state, later.state, current, temperature)
            answer = unit.step(k * acting.length, acting.length, motion)
            found = later, current, answer
            return answer - trial

        if unit.repeats:
            state = unit.save()
            try:
                _agree(miss, force, lambda: unit.restore(state))
            finally:
                unit.drop(state)
        else:
            miss(2.0 * force - before)
        return found if reached else None

    def _motion(self, first: State, last: State, current: float, temperature: float) -> dict[str, float]:
        """Return what the unit is given for a step: where it begins, and how it goes on where that can be said.

        A unit that takes an acceleration goes on by itself from the motion at the beginning of the step; any other
        holds what it is given, which is then the motion at the end.
        """
        ratio, length = self.setup.rig.plant.damper_ratio, self.setup.timing.step
        given = first if self.unit.takes_acceleration else last
        return {
            "displacement": ratio * given[DISPLACEMENT],
            "velocity": ratio * given[VELOCITY],
            "acceleration": ratio * (last[VELOCITY] - first[VELOCITY]) / length,
            "current": current,
            "temperature": temperature,
        }


def _agree(miss: Callable[[float], float], guess: float, again: Callable[[], None]) -> None:
    """Find the force at which `miss` is zero; `again` takes the unit back before each further trial.

    The force of a damper falls where the rig felt more of it, so that the guess and its answer are on both sides.

    Raises:
        RunError: rig and unit do not agree on a force, as where the unit's force jumps.
    """
    low, m_low = guess, miss(guess)
    if abs(m_low) <= AGREED * (1.0 + abs(low)):
        return
    high = low + m_low
    again()
    m_high = miss(high)
    for _ in range(MOST_TRIALS):
        if abs(m_high) <= AGREED * (1.0 + abs(high)):
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
        f"rig and unit differ by {abs(m_high):.3g} N after up to {MOST_TRIALS} trials of a step; shorten solver.step"
    )
