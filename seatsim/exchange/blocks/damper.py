"""The damper with its coil as a block: motion, command and temperature in, force out."""

import math
from typing import Annotated, NamedTuple

from seatsim.compilation.jit import jit
from seatsim.dampers.base import DAMPERS
from seatsim.exchange.block import Block
from seatsim.kernel.bench import MOST_PARTS, TOLERANCE, Course, advance_state
from seatsim.kernel.generic import DamperModel, scaling_at
from seatsim.kernel.inverse import total_force
from seatsim.kernel.step import relaxed
from seatsim.rig.coil import Coil
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling, Thermal
from seatsim.scenario.scenario import Scenario
from seatsim.schema.fields import param
from seatsim.simulation.augment import augment_coil, augment_damper, augment_factors, select_in_loop

_ROUNDING = 1e-9
"""Share of a step by which a length may exceed a whole number of steps, for the sake of rounding."""


class DamperParameters(NamedTuple):
    """The damper, its temperature factors and its coil; a step of the integration in s."""

    damper: DamperModel
    temperature_factors: TemperatureFactors
    coil: Coil
    is_current: Annotated[bool, param("", "whether the command is the coil's current, without lag or limit")]
    step: Annotated[float, param("s", "longest step of the integration", above=0, high=0.01)]


class DamperInputs(NamedTuple):
    """Motion, command and temperature; between two communication points the motion goes on as it is given there."""

    displacement: Annotated[float, param("m", "displacement of the damper, positive in extension")] = 0.0
    velocity: Annotated[float, param("m/s", "velocity of the damper, positive in extension")] = 0.0
    acceleration: Annotated[float, param("m/s^2", "acceleration of the damper; 0 holds the velocity")] = 0.0
    command: Annotated[float, param("A", "commanded current")] = 0.0
    temperature: Annotated[float, param("degC", "temperature of the damper")] = 20.0


class DamperState(NamedTuple):
    """Current of the coil in A, state of the damper, and parts of a step that the last one was divided into."""

    current: float
    z: State
    parts: int


class DamperOutputs(NamedTuple):
    """What the damper gives."""

    force: Annotated[float, param("N", "force of the damper, positive when it opposes extension")]
    current: Annotated[float, param("A", "current in the coil")]


def start(p: DamperParameters, u: DamperInputs, rest: DamperState) -> DamperState:
    """Return the state at time zero."""
    return rest


def advance(
    p: DamperParameters, u: DamperInputs, state: DamperState, age: float, length: float
) -> tuple[DamperState, bool]:
    """Return the state `length` seconds later and whether it is finite; the length is divided into equal steps."""
    steps = max(1, math.ceil(length / p.step - _ROUNDING))
    h = length / steps
    factors = scaling_at(p.temperature_factors, u.temperature)
    now, good = state, True
    for k in range(steps):
        now, fine = _advance_once(p, u, factors, now, age + k * h, h)
        good = good and fine
    return now, good


@jit
def _advance_once(
    p: DamperParameters, u: DamperInputs, factors: TemperatureScaling, state: DamperState, time: float, h: float
) -> tuple[DamperState, bool]:
    """Return the state `h` seconds after `time` from the communication point, and whether it is finite."""
    middle, end = _current(p, u, state.current, 0.5 * h), _current(p, u, state.current, h)
    first = u.command if p.is_current else state.current
    if len(state.z) == 0:
        return DamperState(end, state.z, state.parts), True
    x = (_displacement(u, time), _displacement(u, time + 0.5 * h), _displacement(u, time + h))
    v = (_velocity(u, time), _velocity(u, time + 0.5 * h), _velocity(u, time + h))
    course = Course(x, v, (first, middle, end))
    z, parts, good = advance_state(p.damper, factors, course, state.z, h, state.parts, MOST_PARTS, TOLERANCE)
    return DamperState(end, z, parts), good


@jit
def _current(p: DamperParameters, u: DamperInputs, current: float, time: float) -> float:
    """Return the coil's current in A `time` seconds after it was `current`."""
    if p.is_current:
        return u.command
    return relaxed(p.coil, current, min(max(u.command, 0.0), p.coil.max_current), time)


@jit
def _displacement(u: DamperInputs, time: float) -> float:
    return u.displacement + time * (u.velocity + 0.5 * u.acceleration * time)


@jit
def _velocity(u: DamperInputs, time: float) -> float:
    return u.velocity + u.acceleration * time


def observe(p: DamperParameters, u: DamperInputs, state: DamperState, age: float) -> DamperOutputs:
    """Return the outputs `age` seconds after the inputs were given."""
    current = u.command if p.is_current else state.current
    factors = scaling_at(p.temperature_factors, u.temperature)
    force = total_force(p.damper, _displacement(u, age), _velocity(u, age), current, factors, state.z)
    return DamperOutputs(force, current)


def damper_block(scenario: Scenario) -> Block:
    """Return the damper of a scenario, with the effects on it and on its coil."""
    on_damper, _ = select_in_loop(scenario.effects, False)
    damper, z = augment_damper(scenario.damper.record, on_damper)
    coil = augment_coil(scenario.effects, scenario.coil)
    factors, step = augment_factors(scenario.effects, scenario.damper.factors), scenario.solver.step
    parameters = DamperParameters(damper, factors, coil._replace(delay=0.0), False, step)
    stated = scenario.temperature
    temperature = stated.start if isinstance(stated, Thermal) else stated
    inputs = DamperInputs(temperature=float(temperature))
    name = DAMPERS.name_of(type(scenario.damper.record))
    notes = []
    if coil.delay > 0.0:
        notes.append(f"the delay of {coil.delay:g} s from command to coil is not part of the damper; delay the command")
    if isinstance(stated, Thermal):
        notes.append("the damper does not warm up by itself; its temperature is an input")
    title, said, rest = f"{scenario.name} damper", f"MR damper with its coil: {name}", DamperState(0.0, z, 1)
    texts = ("coil.delay", "coil.resistance"), tuple(notes)
    return Block(title, said, parameters, inputs, rest, start, observe, advance, step, False, *texts)
