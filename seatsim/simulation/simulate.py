"""From a scenario to the history of its run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.cached import compiled
from seatsim.effects.base import ON_DAMPER, acts_on
from seatsim.excitations.base import Floor
from seatsim.kernel.augmented import classes_of
from seatsim.kernel.belief import Belief, Truth
from seatsim.kernel.chain import state_of
from seatsim.kernel.loop import CHANNELS, Inputs, Setup, Timing, run_loop
from seatsim.kernel.rig import Rig
from seatsim.rig.control import LawWithNotes, prepare_law
from seatsim.rig.plant import Plant
from seatsim.rig.sensors import Direct, at_rest
from seatsim.rig.temperature import Thermal
from seatsim.scenario.scenario import Control, Scenario
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.registry import specification_of
from seatsim.simulation.augment import changed, damper_with, in_loop, pushes, undone

Array = NDArray[np.float64]
NONE = np.zeros(0)
DEFAULT_SAMPLE_TIME = 0.001


@dataclass(frozen=True)
class History:
    """The channels of one run by name, shape (N,) each, sampled every `step` seconds; SI units, degrees Celsius.

    `notes` are sentences that the law has for its user after the run.
    """

    step: float
    channels: Mapping[str, Array]
    notes: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> Array:
        """Return one channel."""
        return self.channels[name]


class Forces(NamedTuple):
    """Forces on frame and driver in N, sampled every step, shape (N,) each; of length 0 where there is none."""

    push: Array = NONE
    lift: Array = NONE


def simulate(scenario: Scenario, floor: Floor | None = None, forces: Forces | None = None) -> History:
    """Simulate one run from rest, shaken as the scenario's excitation says, or by a `floor` that is at hand.

    `forces` are added to what the effects push.

    Raises:
        InputError: the scenario has no plant, or its times do not fit each other.
        RunError: the solution grew beyond all bounds.
    """
    if scenario.plant is None or scenario.control is None:
        raise InputError(f"{scenario.name}: a damper bench has no seat to simulate; it is replayed with 'seatsim gap'")
    step = scenario.solver.step
    if floor is None:
        with scenario.placed("excitation"):
            floor = scenario.excitation.floor(step, scenario.seed)
    setup, initial = _setup(scenario, scenario.plant, scenario.control, floor.temperature is not None)
    inputs = _inputs(scenario, scenario.control, floor, forces or Forces())
    if scenario.control.sensors:
        noise = scenario.control.sensors.noise(-(-len(floor.acceleration) // setup.timing.sample_every), scenario.seed)
        inputs = inputs._replace(sensed=at_rest(scenario.start.displacement), noise=noise)
    out = np.empty((len(floor.acceleration), len(CHANNELS)))
    variable = setup.law, setup.belief.damper, setup.sensors
    parts = (*classes_of(setup.rig.damper), *map(type, setup.rig.effects), *map(type, variable))
    states = (initial, _believed(setup.belief), specification_of(type(scenario.control.law)).initial)
    reached = compiled(run_loop, parts)(setup, inputs, *states, out)
    notes = setup.law.notes() if isinstance(setup.law, LawWithNotes) else ()
    if reached < len(out):
        raise RunError(
            f"{scenario.title}: no solution beyond {reached * step:.3f} s, where it leaves all bounds; check the signs"
            " of gains and stiffnesses, and the damper's parameters"
        )
    return _history(setup.rig.plant, step, out, notes)


def _setup(scenario: Scenario, plant: Plant, control: Control, recorded: bool) -> tuple[Setup, tuple[float, ...]]:
    """Return the constant parts and the rig's state at rest; with a `recorded` temperature none is simulated."""
    on_damper, on_seat = in_loop(scenario.effects)
    damper, initial = damper_with(scenario.damper.record, on_damper)
    rig = Rig(changed(scenario.effects, "plant", plant), damper, on_seat)
    with scenario.placed("controller"):
        sample_every = _sample_every(scenario.solver.step, control)
        period = sample_every * scenario.solver.step
        law = prepare_law(control.law, plant, scenario.coil, period)
    heated = isinstance(scenario.temperature, Thermal) and not recorded
    thermal = scenario.temperature if isinstance(scenario.temperature, Thermal) else Thermal()
    timing = Timing(scenario.solver.step, sample_every, scenario.solver.tolerance, heated)
    coil = changed(scenario.effects, "coil", scenario.coil)
    factors = changed(scenario.effects, "factors", scenario.damper.factors)
    sensors = control.sensors.instruments(scenario.solver.step, period) if control.sensors else Direct()
    belief = _belief(scenario, control)
    setup = Setup(rig, coil, factors, thermal, law, belief, timing, scenario.coil.max_current, sensors)
    return setup, initial + state_of([type(effect) for effect in on_seat])


def _belief(scenario: Scenario, control: Control) -> Truth | Belief:
    """Return what the inverse believes: the plant's damper, whose effects it does not know, unless stated otherwise."""
    if control.inverse is None:
        record = scenario.damper.record
        order = specification_of(type(record)).current_order
        if any(acts_on(type(effect), (*ON_DAMPER, "factors")) for effect in scenario.effects):
            return Belief(record, order, scenario.damper.factors, np.nan)
        return Truth(record, order)
    record, factors = control.inverse.damper.record, control.inverse.damper.factors
    temperature = control.inverse.temperature
    return Belief(
        record, specification_of(type(record)).current_order, factors, np.nan if temperature is None else temperature
    )


def _believed(belief: Truth | Belief) -> tuple[float, ...]:
    initial: tuple[float, ...] = specification_of(type(belief.damper)).initial
    return initial


def _sample_every(step: float, control: Control) -> int:
    if control.sample_time is None:
        return 1 if specification_of(type(control.law)).replays else max(1, round(DEFAULT_SAMPLE_TIME / step))
    every = round(control.sample_time / step)
    if every < 1 or abs(every * step - control.sample_time) > 1e-9:
        raise InputError(
            f"sample_time {control.sample_time:g} s is not a multiple of solver.step"
            f" {step:g} s; choose {max(1, every) * step:g} s"
        )
    return every


def _inputs(scenario: Scenario, control: Control, floor: Floor, forces: Forces) -> Inputs:
    step, effects, samples = scenario.solver.step, scenario.effects, len(floor.acceleration)
    acceleration = undone(effects, floor.acceleration, "floor_acceleration", step)
    fixed = scenario.temperature.start if isinstance(scenario.temperature, Thermal) else scenario.temperature
    temperature = np.full(samples, fixed) if floor.temperature is None else floor.temperature
    temperature = changed(effects, "temperature", temperature, step)
    command = NONE if floor.command is None else undone(effects, floor.command, "current_command", step)
    replays = specification_of(type(control.law)).replays
    flowing = NONE
    if floor.coil_current is not None:
        flowing = undone(effects, floor.coil_current, "coil_current", step)
    start = float(flowing[0]) if flowing.size else 0.0
    prescribed = flowing if replays and floor.command is None else NONE
    push = pushes(effects, floor.time, scenario.seed)
    if len(forces.push):
        push = push + forces.push if len(push) else forces.push
    return Inputs(
        acceleration, floor.velocity, temperature, command, prescribed, push, forces.lift, start, *scenario.start
    )


def _history(plant: Plant, step: float, out: Array, notes: tuple[str, ...]) -> History:
    """Return the recorded channels with the time and the energy stored in masses, suspension and cushion springs."""
    channels: dict[str, Any] = {"time": np.arange(len(out)) * step}
    channels |= dict(zip(CHANNELS, np.ascontiguousarray(out.T), strict=True))
    v, driver = (
        channels["suspension_velocity"],
        channels["suspension_velocity"] + channels["cushion_velocity"],
    )
    x, cushion = channels["suspension_displacement"], channels["cushion_displacement"]
    channels["energy_stored"] = 0.5 * (
        plant.frame_mass * v**2
        + plant.driver_mass * driver**2
        + plant.suspension_stiffness * x**2
        + plant.cushion_stiffness * cushion**2
    )
    return History(step, channels, notes)
