"""The whole rig as a block: the floor's motion in; seat, driver, damper, coil and law within."""

from __future__ import annotations

import math

from seatsim.effects.base import acts_on
from seatsim.exchange.block import Block
from seatsim.exchange.blocks.floor import GivenFloor
from seatsim.exchange.blocks.held import nothing_held
from seatsim.exchange.blocks.rig_motion import RigInputs, RigParameters, RigState, advance, observe, start
from seatsim.kernel.augmented import classes_of
from seatsim.kernel.generic import AssumedModel, scaling_at, wants_force
from seatsim.kernel.loop import ROUNDING
from seatsim.kernel.rig import Disturbance
from seatsim.kernel.step import start as start_rig
from seatsim.rig.sensors import Direct, at_rest
from seatsim.rig.state import State
from seatsim.rig.temperature import Thermal
from seatsim.scenario.scenario import Control, Scenario
from seatsim.schema.errors import InputError
from seatsim.schema.registry import initial_state, specification_of
from seatsim.simulation.simulate import set_up

_LONGEST_DELAY = 256
"""Most steps that a command is held back, since every one of them is a number of the state."""


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
    variable = setup.law, setup.inverse_model.damper, setup.sensors
    parts = (*classes_of(setup.rig.damper), *map(type, setup.rig.effects), *map(type, variable))
    hidden = ["coil.delay", "inverse_model.order", "sensors", "self_heating", "tolerance", "step", "sample_every"]
    hidden += ["temperature"] if heated else ["thermal", "coil.resistance"]
    hidden += [] if control.sensors else ["displacement_noise", "frame_noise", "driver_noise", "floor_noise"]
    hidden += [] if specification_of(type(control.law)).replays else ["replayed_command"]
    name, said = f"{scenario.name} rig", "suspension seat with driver, MR damper, coil and control law"
    rest, step = _rest(scenario, control, parameters, inputs, initial, late), setup.timing.step
    texts = tuple(hidden), tuple(_left_out(scenario))
    return Block(name, said, parameters, inputs, rest, start, observe, advance, step, True, parts, *texts)


def _rest(scenario: Scenario, control: Control, p: RigParameters, u: RigInputs, initial: State, late: int) -> RigState:
    """Return the state before the first step; its rates are those without a disturbance."""
    mechanical = (scenario.start.displacement, scenario.start.velocity, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    none = Disturbance(0.0, 0.0, 0.0)
    factors = scaling_at(p.temperature_factors, u.temperature)
    now = start_rig(p.rig, mechanical + initial, none, 0.0, factors, p.step)
    sensed: State = () if isinstance(p.sensors, Direct) else at_rest(scenario.start.displacement)
    is_followed = isinstance(p.inverse_model, AssumedModel) and wants_force(p.law)
    followed: State = initial_state(type(p.inverse_model.damper)) if is_followed else ()
    law_state, commands = initial_state(type(control.law)), (0.0,) * (late + 2)
    states = sensed, followed, law_state, commands
    return RigState(now, 0.0, u.temperature, 0.0, *states, none, 0, GivenFloor(), nothing_held())


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
