"""The whole rig as a block: the floor's motion in; seat, driver, damper, coil and law within.

One advance is what one pass of `seatsim.kernel.loop.run_loop` is, with the same functions.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.compilation.jit import jit
from seatsim.exchange.blocks.base import Block
from seatsim.kernel.assumed_model import InverseModel, follow_state, model_scaling
from seatsim.kernel.augmented import classes_of
from seatsim.kernel.generic import advance_filters, read, scaling_at, update
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.loop import ROUNDING, decide, measure, warm_up
from seatsim.kernel.rig import Disturbance, Rig
from seatsim.kernel.step import IntegratorState, StepInputs, relaxed
from seatsim.kernel.step import advance as advance_rig
from seatsim.kernel.step import start as start_rig
from seatsim.rig.coil import Coil
from seatsim.rig.control import CompiledLaw
from seatsim.rig.sensors import READINGS, Direct, Sensing, at_rest
from seatsim.rig.state import CUSHION_DISPLACEMENT, CUSHION_VELOCITY, DAMPER_WORK, DISPLACEMENT, VELOCITY, State
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling, Thermal
from seatsim.scenario.scenario import Control, Scenario
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param
from seatsim.schema.registry import initial_state, specification_of
from seatsim.simulation.effect_hooks import FRAME_FORCE, READING, TEMPERATURE, TRUTH
from seatsim.simulation.simulate import set_up

SAME = 1e-9
"""Relative difference of a disturbance from what it was to become, up to which it is the same but for rounding."""
LONGEST_DELAY = 256
"""Most steps that a command is held back, since every one of them is a number of the state."""


class RigParameters(NamedTuple):
    """The constant parts of a run, as in `seatsim.kernel.loop_inputs.LoopSetup`."""

    rig: Rig
    coil: Coil
    temperature_factors: TemperatureFactors
    thermal: Thermal
    law: CompiledLaw
    inverse_model: InverseModel
    sensors: Sensing
    max_command: Annotated[float, param("A", "greatest command of the controller", low=0)]
    self_heating: bool
    tolerance: float
    step: float
    sample_every: int


class RigInputs(NamedTuple):
    """What drives the rig from one communication point on."""

    floor_acceleration: Annotated[float, param("m/s^2", "acceleration of the floor, upward positive")] = 0.0
    floor_velocity: Annotated[float, param("m/s", "velocity of the floor, upward positive")] = 0.0
    floor_jerk: Annotated[float, param("m/s^3", "rate of the floor's acceleration; 0 holds it over the step")] = 0.0
    frame_force: Annotated[float, param("N", "force on the frame, upward positive")] = 0.0
    driver_force: Annotated[float, param("N", "force on the driver, upward positive")] = 0.0
    temperature: Annotated[float, param("degC", "temperature of the damper, where it does not warm up by itself")] = (
        20.0
    )
    replayed_command: Annotated[float, param("A", "command for a law that replays one")] = 0.0
    displacement_noise: Annotated[float, param("m", "noise of a displacement reading, with sensors only")] = 0.0
    frame_noise: Annotated[float, param("m/s^2", "noise of the frame's accelerometer, with sensors only")] = 0.0
    driver_noise: Annotated[float, param("m/s^2", "noise of the driver's accelerometer, with sensors only")] = 0.0
    floor_noise: Annotated[float, param("m/s^2", "noise of the floor's accelerometer, with sensors only")] = 0.0


class RigState(NamedTuple):
    """State of the rig and of what controls it; `commands` are those given until now in A, the latest one first.

    `expected` is the disturbance that the last step ended with, `sample` the number of steps taken.
    """

    now: IntegratorState
    current: float
    temperature: float
    command: float
    sensed: State
    followed: State
    law_state: State
    commands: State
    expected: Disturbance
    sample: int


class RigOutputs(NamedTuple):
    """Motion, force, current and temperature, as the channels of a run."""

    frame_acceleration: Annotated[float, param("m/s^2", "acceleration of the frame, upward positive")]
    driver_acceleration: Annotated[float, param("m/s^2", "acceleration of the driver, upward positive")]
    suspension_displacement: Annotated[float, param("m", "displacement of the suspension, positive in extension")]
    suspension_velocity: Annotated[float, param("m/s", "velocity of the suspension, positive in extension")]
    cushion_displacement: Annotated[float, param("m", "displacement of the cushion, positive in extension")]
    cushion_velocity: Annotated[float, param("m/s", "velocity of the cushion, positive in extension")]
    damper_force: Annotated[float, param("N", "force of the damper, positive when it opposes extension")]
    coil_current: Annotated[float, param("A", "current in the coil")]
    current_command: Annotated[float, param("A", "command of the controller over the step that has ended")]
    damper_temperature: Annotated[float, param("degC", "temperature of the damper")]


def start(p: RigParameters, u: RigInputs, rest: RigState) -> RigState:
    """Return the state at time zero, of a rig that moves as the floor begins to."""
    temperature = p.thermal.start if p.self_heating else u.temperature
    now = _restart(p, u, rest.now, u.floor_acceleration, rest.current, scaling_at(p.temperature_factors, temperature))
    expected = Disturbance(u.floor_acceleration, u.frame_force, u.driver_force)
    return rest._replace(now=now, temperature=temperature, expected=expected)


def advance(p: RigParameters, u: RigInputs, state: RigState, length: float) -> tuple[RigState, bool]:
    """Return the state `length` seconds later, a whole number of steps, and whether it was reached."""
    steps = max(1, math.floor(length / p.step + 0.5))
    now, good = state, True
    for k in range(steps):
        time = k * p.step
        floor = u.floor_acceleration + u.floor_jerk * time
        velocity = u.floor_velocity + time * (u.floor_acceleration + 0.5 * u.floor_jerk * time)
        if good:
            now, good = _advance_once(p, u, now, floor, velocity)
    return now, good


@jit
def _advance_once(
    p: RigParameters, u: RigInputs, state: RigState, floor: float, velocity: float
) -> tuple[RigState, bool]:
    """Return the state one step later; the law is evaluated before, so that its command acts from this instant."""
    temperature = state.temperature if p.self_heating else u.temperature
    factors = scaling_at(p.temperature_factors, temperature)
    now = state.now
    if _differs(Disturbance(floor, u.frame_force, u.driver_force), state.expected):
        now = _restart(p, u, now, floor, state.current, factors)
    sensed = advance_filters(p.sensors, floor, now.state[DISPLACEMENT], now.rates, state.sensed)
    command, law_state = state.command, state.law_state
    if state.sample % p.sample_every == 0:
        true = measure(now, state.sample * p.step, floor, velocity, state.current, temperature, u.replayed_command)
        noise = np.empty((1, READINGS))
        noise[0, 0] = u.displacement_noise
        noise[0, 1] = u.frame_noise
        noise[0, 2] = u.driver_noise
        noise[0, 3] = u.floor_noise
        y, sensed = read(p.sensors, true, noise, 0, sensed)
        grid = np.empty(CELLS + 1)
        command, _wanted, _served = decide(p, y, now, factors, state.followed, law_state, grid)
        law_state = update(p.law, y, law_state)
    # The oldest command of the state is of no use any more.
    commands = (command,) + state.commands[:-1]
    acting = _step_inputs(p, u, commands, floor, state.current)
    x, v, work = now.state[DISPLACEMENT], now.state[VELOCITY], now.state[DAMPER_WORK]
    later, current, good = advance_rig(p.rig, p.coil, acting, factors, now, p.tolerance)
    ratio = p.rig.plant.damper_ratio
    followed = follow_state(
        p.inverse_model.damper,
        state.followed,
        ratio * x,
        ratio * v,
        ratio * later.state[DISPLACEMENT],
        ratio * later.state[VELOCITY],
        0.5 * (state.current + current),
        model_scaling(p.inverse_model, factors, temperature),
        p.step,
    )
    if p.self_heating:
        done = later.state[DAMPER_WORK] - work
        temperature += warm_up(p.thermal, p.coil, temperature, done, state.current, current, p.step)
    expected = Disturbance(floor + u.floor_jerk * p.step, u.frame_force, u.driver_force)
    next_state = RigState(
        later, current, temperature, command, sensed, followed, law_state, commands, expected, state.sample + 1
    )
    return next_state, good


@jit
def _step_inputs(p: RigParameters, u: RigInputs, commands: State, floor: float, current: float) -> StepInputs:
    """Return what acts on the rig for one step: the commands of `late` and of one more step ago."""
    late = len(commands) - 2
    split = p.coil.delay - late * p.step
    split = split if split >= ROUNDING * p.step else 0.0
    kept = (1.0 - relaxed(p.coil, 0.0, 1.0, 0.5 * p.step), relaxed(p.coil, 1.0, 0.0, 0.5 * p.step))
    most = p.coil.max_current
    before, after = min(commands[late + 1], most), min(commands[late], most)
    return StepInputs(
        p.step, floor, u.floor_jerk * p.step, current, before, after, split, False, kept,
        u.frame_force, 0.0, u.driver_force, 0.0,
    )  # fmt: skip


@jit
def _restart(
    p: RigParameters, u: RigInputs, now: IntegratorState, floor: float, current: float, factors: TemperatureScaling
) -> IntegratorState:
    """Return the integration begun anew in its state, under a disturbance that has changed at once."""
    disturbance = Disturbance(floor, u.frame_force, u.driver_force)
    return start_rig(p.rig, now.state, disturbance, current, factors, now.substep)


@jit
def _differs(now: Disturbance, expected: Disturbance) -> bool:
    """Return whether a disturbance is another one than the last step ended with, by more than rounding."""
    floor, frame, driver = now.floor - expected.floor, now.frame_force - expected.frame_force, now.driver_force
    size = abs(floor) + abs(frame) + abs(driver - expected.driver_force)
    return size > SAME * (1.0 + abs(expected.floor) + abs(expected.frame_force) + abs(expected.driver_force))


def observe(p: RigParameters, u: RigInputs, state: RigState, age: float) -> RigOutputs:
    """Return the outputs `age` seconds after the inputs were given."""
    s, rates, floor = state.now.state, state.now.rates, u.floor_acceleration + u.floor_jerk * age
    frame = rates[VELOCITY] + floor
    return RigOutputs(
        frame, frame + rates[CUSHION_VELOCITY],
        s[DISPLACEMENT], s[VELOCITY], s[CUSHION_DISPLACEMENT], s[CUSHION_VELOCITY],
        state.now.forces.damper_force, state.current, state.command, state.temperature,
    )  # fmt: skip


def rig_block(scenario: Scenario) -> Block:
    """Return the rig of a scenario with its law and the effects on it.

    Raises:
        InputError: the scenario is a damper bench, or the delay of its coil is longer than a block can hold.
    """
    plant, control = scenario.plant, scenario.control
    if plant is None or control is None:
        raise InputError(f"{scenario.name}: a damper bench has no rig; export its damper with --what damper")
    setup, initial = set_up(scenario, plant, control, False, False)
    late = math.floor(setup.coil.delay / setup.timing.step + ROUNDING)
    if late > LONGEST_DELAY:
        raise InputError(
            f"{scenario.name}: a delay of {setup.coil.delay:g} s is {late} steps, and an exported rig holds"
            f" {LONGEST_DELAY} at most; take a longer solver.step"
        )
    heated = setup.timing.self_heating
    parameters = RigParameters(
        setup.rig, setup.coil, setup.factors, setup.thermal, setup.law, setup.inverse_model, setup.sensors,
        setup.max_command, heated, setup.timing.tolerance, setup.timing.step, setup.timing.sample_every,
    )  # fmt: skip
    temperature = setup.thermal.start if isinstance(scenario.temperature, Thermal) else scenario.temperature
    inputs = RigInputs(temperature=float(temperature))
    variable = setup.law, setup.inverse_model.damper, setup.sensors
    parts = (*classes_of(setup.rig.damper), *map(type, setup.rig.effects), *map(type, variable))
    hidden = ["coil.delay", "inverse_model.order", "sensors", "self_heating", "tolerance", "step", "sample_every"]
    hidden += ["temperature"] if heated else ["thermal", "coil.resistance"]
    hidden += [] if control.sensors else ["displacement_noise", "frame_noise", "driver_noise", "floor_noise"]
    hidden += [] if specification_of(type(control.law)).replays else ["replayed_command"]
    return Block(
        f"{scenario.name} rig", "suspension seat with driver, MR damper, coil and control law", parameters, inputs,
        _rest(scenario, control, parameters, inputs, initial, late), start, observe, advance, setup.timing.step, True,
        parts, tuple(hidden), tuple(_left_out(scenario)),
    )  # fmt: skip


def _rest(scenario: Scenario, control: Control, p: RigParameters, u: RigInputs, initial: State, late: int) -> RigState:
    """Return the state before the first step; its rates are those without a disturbance."""
    mechanical = (scenario.start.displacement, scenario.start.velocity, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    none = Disturbance(0.0, 0.0, 0.0)
    factors = scaling_at(p.temperature_factors, u.temperature)
    now = start_rig(p.rig, mechanical + initial, none, 0.0, factors, p.step)
    sensed: State = () if isinstance(p.sensors, Direct) else at_rest(scenario.start.displacement)
    followed, law_state = initial_state(type(p.inverse_model.damper)), initial_state(type(control.law))
    return RigState(now, 0.0, u.temperature, 0.0, sensed, followed, law_state, (0.0,) * (late + 2), none, 0)


def _left_out(scenario: Scenario) -> list[str]:
    """Return what of a scenario an exported rig has not."""
    hooks = (FRAME_FORCE, READING, TEMPERATURE, TRUTH)
    acting = {type(effect).__name__ for hook in hooks for effect in hook.of(scenario.effects)}
    notes = []
    if acting:
        notes.append(
            f"of the effects {', '.join(sorted(acting))} what acts on inputs and readings is not part of the rig"
        )
    if scenario.control and scenario.control.sensors:
        notes.append("the noise of the sensors is an input, zero where it is not given")
    return notes
