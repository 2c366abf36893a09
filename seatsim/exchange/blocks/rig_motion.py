"""The whole rig as a block: the floor's motion in; seat, driver, damper, coil and law within.

One advance is what one pass of `seatsim.kernel.loop.run_loop` is, computed with the same functions.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.compilation.jit import jit
from seatsim.effects.base import acts_on
from seatsim.exchange.block import Block
from seatsim.kernel import generic
from seatsim.kernel.generic import InverseModel, advance_filters, follow_state, model_scaling, read, scaling_at, update
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.loop import ROUNDING, command_current, measure, warm_up
from seatsim.kernel.rig import Disturbance, Rig, damper_state
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
from seatsim.simulation.simulate import set_up


class GivenFloor(NamedTuple):
    """What is known of the floor at a communication point.

    `acceleration` in m/s^2 was given at the step of the number `sample`, `rate` in m/s^3 is how it goes on; `velocity`
    in m/s is that of the present step. `has_rate` and `has_velocity` say whether these two inputs are stated.
    """

    acceleration: float = 0.0
    sample: int = 0
    rate: float = 0.0
    velocity: float = 0.0
    has_rate: bool = False
    has_velocity: bool = False


@jit
def follow_floor(u: RigInputs, floor: GivenFloor, age: float, sample: int, step: float) -> GivenFloor:
    """Return what is known of the floor at a step of the number `sample`, `age` s after the inputs were given."""
    has_rate = floor.has_rate or u.floor_jerk != 0.0
    has_velocity = floor.has_velocity or u.floor_velocity != 0.0
    last, begun, rate, velocity = floor.acceleration, floor.sample, floor.rate, floor.velocity
    if has_rate:
        rate = u.floor_jerk
    elif age == 0.0:
        rate = (u.floor_acceleration - last) / ((sample - begun) * step) if sample > begun else 0.0
    if age == 0.0:
        last, begun = u.floor_acceleration, sample
    if has_velocity:
        velocity = u.floor_velocity + age * (u.floor_acceleration + 0.5 * rate * age)
    return GivenFloor(last, begun, rate, velocity, has_rate, has_velocity)


@jit
def leave_floor(floor: GivenFloor, acceleration: float, step: float) -> GivenFloor:
    """Return the same a step later, of a floor with an acceleration in m/s^2 at the step's begin."""
    velocity = floor.velocity + step * (acceleration + 0.5 * floor.rate * step)
    return GivenFloor(floor.acceleration, floor.sample, floor.rate, velocity, floor.has_rate, floor.has_velocity)


_LONGEST_DELAY = 256
"""Most steps that a command is held back, since every one of them is a number of the state."""
_SAME = 1e-9
"""Relative difference of a disturbance from what it was to become, up to which it is the same but for rounding."""


class RigParameters(NamedTuple):
    """The constant parts of a run, as in `seatsim.kernel.loop_data.LoopSetup`."""

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

    floor_acceleration: Annotated[
        float, param("m/s^2", "acceleration of the floor at the begin of a communication step, upward positive")
    ] = 0.0
    floor_velocity: Annotated[
        float, param("m/s", "velocity of the floor, upward positive; the integral of its acceleration if not given")
    ] = 0.0
    floor_jerk: Annotated[
        float, param("m/s^3", "rate of the floor's acceleration over the step; that over the last step if not given")
    ] = 0.0
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

    `followed` is the state of the inverse's damper where the inverse tracks one, `expected` the disturbance that the
    last step ended with, `sample` the number of steps taken, `floor` what is known of the floor's motion.
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
    floor: GivenFloor


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
    factors = scaling_at(p.temperature_factors, temperature)
    now = _restart(p, u, rest.now, u.floor_acceleration, rest.current, factors)
    expected = Disturbance(u.floor_acceleration, u.frame_force, u.driver_force)
    floor = rest.floor._replace(acceleration=u.floor_acceleration)
    return rest._replace(now=now, temperature=temperature, expected=expected, floor=floor)


def advance(p: RigParameters, u: RigInputs, state: RigState, age: float, length: float) -> tuple[RigState, bool]:
    """Return the state one step later, and whether it was reached; the step begins `age` s after the inputs were given.

    The law is evaluated before the rig advances, so that its command acts from this instant.
    """
    given = follow_floor(u, state.floor, age, state.sample, p.step)
    floor = u.floor_acceleration + given.rate * age
    temperature = state.temperature if p.self_heating else u.temperature
    factors, now = scaling_at(p.temperature_factors, temperature), state.now
    if _differs(Disturbance(floor, u.frame_force, u.driver_force), state.expected):
        now = _restart(p, u, now, floor, state.current, factors)
    sensed = advance_filters(p.sensors, floor, now.state[DISPLACEMENT], now.rates, state.sensed)
    command, law_state = state.command, state.law_state
    if state.sample % p.sample_every == 0:
        true = measure(
            now, state.sample * p.step, floor, given.velocity, state.current, temperature, u.replayed_command
        )
        noise = np.empty((1, READINGS))
        noise[0, 0] = u.displacement_noise
        noise[0, 1] = u.frame_noise
        noise[0, 2] = u.driver_noise
        noise[0, 3] = u.floor_noise
        y, sensed = read(p.sensors, true, noise, 0, sensed)
        grid = np.empty(CELLS + 1)
        z = generic.model_state(p.inverse_model, damper_state(p.rig, now.state), state.followed)
        command, _wanted, _served = command_current(
            p.law, p.inverse_model, p.rig.plant.damper_ratio, p.max_command, y, factors, z, law_state, grid
        )
        law_state = update(p.law, y, law_state)
    # The oldest command of the state is of no use any more.
    commands = (command,) + state.commands[:-1]
    acting = _step_inputs(p, u, commands, floor, given.rate, state.current)
    later, current, good = advance_rig(p.rig, p.coil, acting, factors, now, p.tolerance)
    # A state without elements is one that nobody asks for.
    followed = state.followed
    if len(followed) > 0:
        followed = _follow(p, followed, now, later, 0.5 * (state.current + current), factors, temperature)
    if p.self_heating:
        done = later.state[DAMPER_WORK] - now.state[DAMPER_WORK]
        temperature += warm_up(p.thermal, p.coil, temperature, done, state.current, current, p.step)
    expected = Disturbance(floor + given.rate * p.step, u.frame_force, u.driver_force)
    next_state = RigState(
        later, current, temperature, command, sensed, followed, law_state, commands, expected, state.sample + 1,
        leave_floor(given, floor, p.step),
    )  # fmt: skip
    return next_state, good


@jit
def _follow(
    p: RigParameters,
    z: State,
    now: IntegratorState,
    later: IntegratorState,
    current: float,
    factors: TemperatureScaling,
    temperature: float,
) -> State:
    """Return the state of the inverse's damper after a step, as the inverse tracks it."""
    ratio, before, after = p.rig.plant.damper_ratio, now.state, later.state
    first = generic.Motion(ratio * before[DISPLACEMENT], ratio * before[VELOCITY], current)
    last = generic.Motion(ratio * after[DISPLACEMENT], ratio * after[VELOCITY], current)
    scaling = model_scaling(p.inverse_model, factors, temperature)
    return follow_state(p.inverse_model.damper, z, first, last, scaling, p.step)


@jit
def _step_inputs(
    p: RigParameters, u: RigInputs, commands: State, floor: float, rate: float, current: float
) -> StepInputs:
    """Return what acts on the rig for one step: the commands of `late` and of one more step ago."""
    late = len(commands) - 2
    split = p.coil.delay - late * p.step
    split = split if split >= ROUNDING * p.step else 0.0
    most = p.coil.max_current
    before, after = min(commands[late + 1], most), min(commands[late], most)
    kept = (1.0 - relaxed(p.coil, 0.0, 1.0, 0.5 * p.step), relaxed(p.coil, 1.0, 0.0, 0.5 * p.step))
    first, rise = Disturbance(floor, u.frame_force, u.driver_force), Disturbance(rate * p.step, 0.0, 0.0)
    return StepInputs(p.step, first, rise, current, before, after, split, False, kept)


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
    return size > _SAME * (1.0 + abs(expected.floor) + abs(expected.frame_force) + abs(expected.driver_force))


def observe(p: RigParameters, u: RigInputs, state: RigState, age: float) -> RigOutputs:
    """Return the outputs `age` seconds after the inputs were given."""
    s, rates, floor = state.now.state, state.now.rates, u.floor_acceleration + state.floor.rate * age
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
    if late > _LONGEST_DELAY:
        raise InputError(
            f"{scenario.name}: a delay of {setup.coil.delay:g} s is {late} steps, and an exported rig holds"
            f" {_LONGEST_DELAY} at most; take a longer solver.step"
        )
    heated = setup.timing.self_heating
    rig = setup.rig, setup.coil, setup.factors, setup.thermal
    control_parts = setup.law, setup.inverse_model, setup.sensors, setup.max_command
    timing = setup.timing.tolerance, setup.timing.step, setup.timing.sample_every
    parameters = RigParameters(*rig, *control_parts, heated, *timing)
    temperature = setup.thermal.start if isinstance(scenario.temperature, Thermal) else scenario.temperature
    inputs = RigInputs(temperature=float(temperature))
    hidden = ["coil.delay", "sensors", "self_heating", "tolerance", "step", "sample_every"]
    hidden += ["temperature"] if heated else ["thermal", "coil.resistance"]
    hidden += [] if control.sensors else ["displacement_noise", "frame_noise", "driver_noise", "floor_noise"]
    hidden += [] if specification_of(type(control.law)).replays else ["replayed_command"]
    name, said = f"{scenario.name} rig", "suspension seat with driver, MR damper, coil and control law"
    rest, step = _rest(scenario, control, parameters, inputs, initial, late), setup.timing.step
    texts = tuple(hidden), tuple(_left_out(scenario))
    return Block(name, said, parameters, inputs, rest, start, observe, advance, step, True, *texts)


def _rest(scenario: Scenario, control: Control, p: RigParameters, u: RigInputs, initial: State, late: int) -> RigState:
    """Return the state before the first step; its rates are those without a disturbance."""
    mechanical = (scenario.start.displacement, scenario.start.velocity, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    none = Disturbance(0.0, 0.0, 0.0)
    factors = generic.scaling_at(p.temperature_factors, u.temperature)
    now = start_rig(p.rig, mechanical + initial, none, 0.0, factors, p.step)
    sensed: State = () if isinstance(p.sensors, Direct) else at_rest(scenario.start.displacement)
    is_followed = isinstance(p.inverse_model, generic.AssumedModel) and generic.wants_force(p.law)
    followed: State = initial_state(type(p.inverse_model.damper)) if is_followed else ()
    law_state, commands = initial_state(type(control.law)), (0.0,) * (late + 2)
    states = sensed, followed, law_state, commands
    return RigState(now, 0.0, u.temperature, 0.0, *states, none, 0, GivenFloor())


def _left_out(scenario: Scenario) -> list[str]:
    """Return what of a scenario an exported rig has not."""
    hooks = ("frame_force", "reading", "temperature", "truth")
    acting = {type(effect).__name__ for effect in scenario.effects if acts_on(type(effect), hooks)}
    notes = []
    if acting:
        text = f"of the effects {', '.join(sorted(acting))} what acts on inputs and readings is not part of the rig"
        notes.append(text)
    if scenario.control and scenario.control.sensors:
        notes.append("the noise of the sensors is an input, zero where it is not given")
    return notes
