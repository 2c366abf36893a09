"""The controller alone as a block: readings in, commanded current out, with the inverse damper and the clip.

One advance is one sample. The inverse cannot know the true state of a damper: it follows it from readings of motion and
current, also where that of a simulation knows the true one.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.compilation.jit import jit
from seatsim.exchange.block import Block
from seatsim.kernel.generic import AssumedModel, Motion, follow_state, model_scaling, take, update, wants_force
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.loop import command_current
from seatsim.rig.control import CompiledLaw, Measurement
from seatsim.rig.sensors import INSTRUMENTS, Direct, Sensing
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param
from seatsim.schema.registry import initial_state, specification_of
from seatsim.simulation.simulate import set_up

_UNSCALED = TemperatureScaling()


class ControllerParameters(NamedTuple):
    """The law, the damper of its inverse, and how readings become what the law sees.

    `damper_ratio` is the damper's stroke per travel of the suspension; the state of the inverse's damper is followed in
    `divisions` steps a sample.
    """

    law: CompiledLaw
    inverse_model: AssumedModel
    sensors: Sensing
    damper_ratio: Annotated[float, param("-", "stroke of the damper per travel of the suspension", above=0)]
    max_command: Annotated[float, param("A", "greatest command", low=0)]
    sample_time: float
    divisions: int


class ControllerInputs(NamedTuple):
    """Readings at a sample."""

    displacement: Annotated[float, param("m", "displacement of the suspension, positive in extension")] = 0.0
    velocity: Annotated[float, param("m/s", "velocity of the suspension, positive in extension")] = 0.0
    frame_velocity: Annotated[float, param("m/s", "velocity of the frame, upward positive")] = 0.0
    driver_velocity: Annotated[float, param("m/s", "velocity of the driver, upward positive")] = 0.0
    floor_acceleration: Annotated[float, param("m/s^2", "acceleration of the floor, upward positive")] = 0.0
    frame_acceleration: Annotated[float, param("m/s^2", "acceleration of the frame, upward positive")] = 0.0
    driver_acceleration: Annotated[float, param("m/s^2", "acceleration of the driver, upward positive")] = 0.0
    damper_force: Annotated[float, param("N", "force of the damper, positive when it opposes extension")] = 0.0
    current: Annotated[float, param("A", "current in the coil")] = 0.0
    temperature: Annotated[float, param("degC", "temperature of the damper")] = 20.0
    replayed_command: Annotated[float, param("A", "command for a law that replays one")] = 0.0


class ControllerState(NamedTuple):
    """What is kept from one sample to the next; displacement [m], velocity [m/s], current [A] are the last ones."""

    displacement: float
    velocity: float
    current: float
    sensed: State
    followed: State
    law_state: State
    command: float
    wanted: float
    sample: int


class ControllerOutputs(NamedTuple):
    """What the controller decides."""

    command: Annotated[float, param("A", "commanded current, between 0 and the greatest command")]
    wanted_force: Annotated[float, param("N", "force that the law wants; 0 of a law that wants a current")]


def start(p: ControllerParameters, u: ControllerInputs, rest: ControllerState) -> ControllerState:
    """Return the state before the first sample."""
    return rest


def advance(
    p: ControllerParameters, u: ControllerInputs, state: ControllerState, age: float, length: float
) -> tuple[ControllerState, bool]:
    """Return the state after one sample, with the readings that were given, and that it was reached."""
    given = Measurement(
        state.sample * p.sample_time, u.displacement, u.velocity, u.frame_velocity, u.driver_velocity,
        u.floor_acceleration, u.frame_acceleration, u.driver_acceleration, u.damper_force, u.current, u.temperature,
        u.replayed_command,
    )  # fmt: skip
    y, sensed = take(p.sensors, given, state.sensed)
    followed = _follow(p, state, y) if wants_force(p.law) and state.sample > 0 else state.followed
    grid = np.empty(CELLS + 1)
    decided = command_current(
        p.law, p.inverse_model, p.damper_ratio, p.max_command, y, _UNSCALED, followed, state.law_state, grid
    )
    later = ControllerState(
        y.displacement, y.velocity, y.current, sensed, followed, update(p.law, y, state.law_state), decided[0],
        decided[1] if wants_force(p.law) else 0.0, state.sample + 1,
    )  # fmt: skip
    return later, True


@jit
def _follow(p: ControllerParameters, state: ControllerState, y: Measurement) -> State:
    """Return the state of the inverse's damper at this sample, from that at the last one."""
    ratio, h = p.damper_ratio, p.sample_time / p.divisions
    scaling = model_scaling(p.inverse_model, _UNSCALED, y.temperature)
    z = state.followed
    for part in range(p.divisions):
        a, b = part / p.divisions, (part + 1) / p.divisions
        x, x_next = _between(state.displacement, y.displacement, a), _between(state.displacement, y.displacement, b)
        v, v_next = _between(state.velocity, y.velocity, a), _between(state.velocity, y.velocity, b)
        current = _between(state.current, y.current, 0.5 * (a + b))
        first, last = Motion(ratio * x, ratio * v, current), Motion(ratio * x_next, ratio * v_next, current)
        z = follow_state(p.inverse_model.damper, z, first, last, scaling, h)
    return z


@jit
def _between(first: float, last: float, share: float) -> float:
    return first + share * (last - first)


def observe(p: ControllerParameters, u: ControllerInputs, state: ControllerState, age: float) -> ControllerOutputs:
    """Return what was decided at the last sample."""
    return ControllerOutputs(state.command, state.wanted)


def controller_block(scenario: Scenario) -> Block:
    """Return the controller of a scenario.

    Raises:
        InputError: the scenario is a damper bench, which has no controller.
    """
    plant, control = scenario.plant, scenario.control
    if plant is None or control is None:
        raise InputError(f"{scenario.name}: a damper bench has no controller; export its damper with --what damper")
    setup, _ = set_up(scenario, plant, control, False, False)
    model = setup.inverse_model
    if not isinstance(model, AssumedModel):
        model = AssumedModel(model.damper, scenario.damper.factors, math.nan)
    period = setup.timing.sample_every * setup.timing.step
    parameters = ControllerParameters(
        setup.law, model, setup.sensors, plant.damper_ratio, setup.max_command, period, setup.timing.sample_every
    )
    sensed = () if isinstance(setup.sensors, Direct) else (0.0,) * INSTRUMENTS
    rest = ControllerState(
        0.0, 0.0, 0.0, sensed, initial_state(type(model.damper)), initial_state(type(control.law)), 0.0, 0.0, 0
    )
    hidden = ["inverse_model.temperature", "sensors", "sample_time", "divisions"]
    hidden += ["velocity", "frame_velocity", "driver_velocity"] if control.sensors else []
    hidden += [] if specification_of(type(control.law)).replays else ["replayed_command"]
    hidden += [] if wants_force(setup.law) else ["inverse_model", "wanted_force"]
    notes = []
    if initial_state(type(model.damper)) and wants_force(setup.law):
        notes.append("the inverse follows the state of its damper from readings of motion and current")
    name = f"{scenario.name} controller"
    said = f"control law {type(control.law).__name__}, with inverse damper and clip"
    inputs, texts = ControllerInputs(), (tuple(hidden), tuple(notes))
    return Block(name, said, parameters, inputs, rest, start, observe, advance, period, True, *texts)
