"""From a scenario to the history of its run.

Its law is designed here for the nominal rig, the floors that it is designed for, and the travel that it has.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np

from seatsim.compilation.cached import compiled
from seatsim.effects.base import ON_DAMPER, acts_on
from seatsim.excitations.base import Floor
from seatsim.kernel.augmented import classes_of
from seatsim.kernel.generic import AssumedModel, InverseModel, TrueModel
from seatsim.kernel.hooks import state_at_rest
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.loop import run_loop
from seatsim.kernel.loop_data import CHANNELS, CURRENT_COMMAND, LoopInputs, LoopSetup, Timing
from seatsim.kernel.rig import Rig
from seatsim.rig.control import CompiledLaw, FloorRecord, Law, LawWithNotes, prepare_law
from seatsim.rig.designs import SynthesisedLaw
from seatsim.rig.plant import Plant
from seatsim.rig.sensors import Direct, at_rest
from seatsim.rig.state import State
from seatsim.rig.temperature import Thermal
from seatsim.scenario.scenario import Control, Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, SynthesisError
from seatsim.schema.registry import initial_state, specification_of
from seatsim.simulation.augment import (
    augment_coil,
    augment_damper,
    augment_factors,
    augment_plant,
    augment_temperature,
    has_inner_masses,
    seat_driver,
    select_in_loop,
    sum_frame_forces,
    undo_reading,
)
from seatsim.simulation.inputs import NONE, Forces
from seatsim.simulation.result import History
from seatsim.simulation.validity import explain_divergence

_DEFAULT_SAMPLE_TIME = 0.001
"""Seconds between two samples of a law that states none, as common for embedded controllers of such seats."""
_SAME_TIME = 1e-9
"""Seconds by which a sample time may differ from a whole number of steps, for the sake of rounding."""
_MARGIN = 0.1
"""Share of the travel that the design leaves free: other draws of a floor of a minute reach some 10 % further."""
_WEIGHTS = (1.0, 300.0)
"""Least and largest weight of the travel in 1/s^2 that are tried: from hardly any to a seat that hardly moves."""
_HALVINGS = 5
"""Halvings of the interval of the weight's logarithm: the weight is found to a fifth, the travel to 3 % or so."""


def simulate(
    scenario: Scenario, floor: Floor | None = None, forces: Forces | None = None, carry_all_effects: bool | None = None
) -> History:
    """Simulate one run, excited as the scenario says, or by a `floor` that is at hand.

    `forces` are added to those of the effects. With `carry_all_effects` the loop is compiled with every registered
    effect, off where it is not chosen, so that runs with different effects share it; see `select_in_loop`.

    Raises:
        InputError: the scenario has no plant, or its times do not fit each other.
        RunError: the solution grew beyond all bounds, or took more work than `seatsim.kernel.hooks` grants.
    """
    if scenario.plant is None or scenario.control is None:
        raise InputError(f"{scenario.name}: a damper bench has no seat to simulate; it is replayed with 'seatsim gap'")
    if floor is None:
        with scenario.placed("excitation"):
            floor = scenario.excitation.floor(scenario.solver.step, scenario.seed)
    is_recorded = floor.temperature is not None
    setup, initial = set_up(scenario, scenario.plant, scenario.control, is_recorded, carry_all_effects)
    inputs = _prepare_inputs(scenario, scenario.control, floor, forces or Forces())
    if scenario.control.sensors:
        noise = scenario.control.sensors.noise(-(-len(floor.acceleration) // setup.timing.sample_every), scenario.seed)
        inputs = inputs._replace(sensed=at_rest(scenario.start.displacement), noise=noise)
    # Each channel lies in one piece, as it is read afterwards: a transpose would take a third of the run's time.
    out = np.empty((len(CHANNELS), len(floor.acceleration))).T
    variable = setup.law, setup.inverse_model.damper, setup.sensors
    parts = (*classes_of(setup.rig.damper), *map(type, setup.rig.effects), *map(type, variable))
    states = initial_states(scenario.control, setup, initial)
    reached = compiled(run_loop, parts)(setup, inputs, *states, out, np.empty(CELLS + 1))
    if not is_whole(out, reached):
        raise explain_divergence(scenario, out[: reached + 1], setup.rig.plant.damper_ratio)
    return read_history(scenario, setup, out)


def is_whole(out: Array, reached: int) -> bool:
    """Return whether a run reached its end, and its law gave a finite number at every sample."""
    return reached == len(out) and not np.isnan(out[:, CURRENT_COMMAND]).any()


def initial_states(control: Control, setup: LoopSetup, rig: State) -> tuple[State, State, State]:
    """Return the states with which a run begins: of the rig, of the damper that the inverse assumes, of the law."""
    return rig, initial_state(type(setup.inverse_model.damper)), initial_state(type(control.law))


def set_up(
    scenario: Scenario, plant: Plant, control: Control, is_recorded: bool, carry_all_effects: bool | None
) -> tuple[LoopSetup, tuple[float, ...]]:
    """Return the constant parts and the rig's state at rest; where its temperature is recorded none is simulated."""
    on_damper, on_seat = select_in_loop(scenario.effects, carry_all_effects)
    damper, initial = augment_damper(scenario.damper.record, on_damper)
    augmented = augment_plant(scenario.effects, plant)
    carried = (*on_seat, *seat_driver(scenario.driver, augmented, scenario.effects))
    rig = Rig(augmented, damper, carried)
    with scenario.placed("controller"):
        sample_every = _count_steps(scenario.solver.step, control)
        period = sample_every * scenario.solver.step
        law = design_law(scenario, plant, control, period)
    heated = isinstance(scenario.temperature, Thermal) and not is_recorded
    thermal = scenario.temperature if isinstance(scenario.temperature, Thermal) else Thermal()
    timing = Timing(scenario.solver.step, sample_every, scenario.solver.tolerance, heated)
    coil = augment_coil(scenario.effects, scenario.coil)
    factors = augment_factors(scenario.effects, scenario.damper.factors)
    sensors = control.sensors.instruments(scenario.solver.step, period) if control.sensors else Direct()
    model = _assume_damper(scenario, control, carry_all_effects)
    setup = LoopSetup(rig, coil, factors, thermal, law, model, timing, scenario.coil.max_current, sensors)
    return setup, initial + state_at_rest([type(record) for record in carried])


def measure_peak_travel(scenario: Scenario) -> float:
    """Return the largest displacement of the suspension in m of a run, whichever its direction."""
    return float(np.abs(simulate(scenario)["suspension_displacement"]).max())


def _assume_damper(scenario: Scenario, control: Control, carry_all_effects: bool | None) -> InverseModel:
    """Return the damper that the inverse assumes: the plant's without its effects, unless stated otherwise."""
    if control.inverse is None:
        record = scenario.damper.record
        # Where all effects are carried the kind of model must not hang on those chosen: the loop is compiled for it.
        if carry_all_effects or any(acts_on(type(effect), (*ON_DAMPER, "factors")) for effect in scenario.effects):
            return AssumedModel(record, scenario.damper.factors, np.nan)
        return TrueModel(record)
    record, factors = control.inverse.damper.record, control.inverse.damper.factors
    temperature = control.inverse.temperature
    return AssumedModel(record, factors, np.nan if temperature is None else temperature)


def sample_period(step: float, control: Control) -> float:
    """Return the time in s between two samples of the law, where the simulation goes on by `step` seconds."""
    return _count_steps(step, control) * step


def _count_steps(step: float, control: Control) -> int:
    """Return how many steps of the simulation lie between two samples of the law."""
    if control.sample_time is None:
        return 1 if specification_of(type(control.law)).replays else max(1, round(_DEFAULT_SAMPLE_TIME / step))
    every = round(control.sample_time / step)
    if every < 1 or abs(every * step - control.sample_time) > _SAME_TIME:
        raise InputError(
            f"sample_time {control.sample_time:g} s is not a multiple of solver.step"
            f" {step:g} s; choose {max(1, every) * step:g} s"
        )
    return every


def _prepare_inputs(scenario: Scenario, control: Control, floor: Floor, forces: Forces) -> LoopInputs:
    """Return what drives a run of the loop, under a floor and with forces beside those of the effects."""
    step, effects, samples = scenario.solver.step, scenario.effects, len(floor.acceleration)
    acceleration = undo_reading(effects, floor.acceleration, "floor_acceleration", step)
    if floor.temperature is None and isinstance(scenario.temperature, Thermal):
        # What is simulated is the temperature of the fluid, which no thermocouple reads.
        temperature = np.full(samples, scenario.temperature.start)
    else:
        stated = np.full(samples, scenario.temperature) if floor.temperature is None else floor.temperature
        temperature = augment_temperature(effects, step, stated)
    command = NONE if floor.command is None else undo_reading(effects, floor.command, "current_command", step)
    replays = specification_of(type(control.law)).replays
    measured = floor.coil_current
    flowing = NONE if measured is None else undo_reading(effects, measured, "coil_current", step)
    start = float(flowing[0]) if flowing.size else 0.0
    prescribed = flowing if replays and floor.command is None else NONE
    frame_force = sum_frame_forces(effects, floor.time, scenario.seed)
    if len(forces.frame):
        frame_force = frame_force + forces.frame if len(frame_force) else forces.frame
    signals = acceleration, floor.velocity, temperature, command, prescribed, frame_force, forces.driver
    return LoopInputs(*signals, start, *scenario.start)


def read_history(scenario: Scenario, setup: LoopSetup, out: Array) -> History:
    """Return the channels of a run that reached its end, out of its rows, shape (N, len(CHANNELS)).

    The time is added, and the energy stored in masses, suspension and cushion springs.
    """
    plant, step = setup.rig.plant, setup.timing.step
    channels: dict[str, Array] = {"time": step * np.arange(len(out), dtype=np.float64)}
    channels |= dict(zip(CHANNELS, out.T, strict=True))
    v, x = channels["suspension_velocity"], channels["suspension_displacement"]
    driver, cushion = v + channels["cushion_velocity"], channels["cushion_displacement"]
    channels["energy_stored"] = 0.5 * (
        plant.frame_mass * v**2
        + plant.driver_mass * driver**2
        + plant.suspension_stiffness * x**2
        + plant.cushion_stiffness * cushion**2
    )
    if has_inner_masses(scenario.driver, scenario.effects):
        # Both miss what moves within the driver's body.
        channels["energy_floor"] = channels["energy_stored"] = np.full(len(out), np.nan)
    return History(step, channels, setup.law.notes() if isinstance(setup.law, LawWithNotes) else ())


def design_law(scenario: Scenario, plant: Plant, control: Control, period: float) -> CompiledLaw:
    """Return the compiled form of a scenario's law, sampled every `period` seconds.

    It is designed for the nominal plant and coil, since its designer knows no effects.
    """
    law = settle_travel(scenario, control)
    return prepare_law(law, plant, scenario.coil, period, partial(record_floors, scenario, control))


def record_floors(scenario: Scenario, control: Control) -> list[FloorRecord]:
    """Return the floors that a law is designed for, in another random draw than that on which it runs."""
    step = scenario.solver.step
    floors = [each.excitation.floor(step, each.seed) for each in _list_design_runs(scenario, control)]
    return [FloorRecord(step, floor.acceleration) for floor in floors]


def settle_travel(scenario: Scenario, control: Control) -> Law:
    """Return the law with its travel weight, which is found by simulation where it is stated as `limit`.

    It is the least weight whose seat, with the forces that the damper can give, keeps nine tenths of its travel on
    every floor of the design. The peak is taken to fall as the weight rises.

    Raises:
        InputError: the seat states no travel.
        SynthesisError: no weight keeps the seat within its travel.
    """
    law = control.law
    if not isinstance(law, SynthesisedLaw) or not law.is_limited_by_travel:
        return law
    return law.with_travel_weight(_find_weight(tuple(_list_design_runs(scenario, control))))


def _list_design_runs(scenario: Scenario, control: Control) -> Sequence[Scenario]:
    """Return the nominal runs of a design, one on each of its floors; equal where the design is the same."""
    bare = replace(scenario, name="", effects=(), checks=(), label={}, source=None, seed=scenario.seed + 1)
    return [replace(bare, excitation=floor) for floor in control.floors or (scenario.excitation,)]


@lru_cache(maxsize=64)
def _find_weight(runs: tuple[Scenario, ...]) -> float:
    stops = runs[0].plant.end_stops if runs[0].plant else None
    if stops is None:
        raise InputError("weights.travel: limit needs the travel between the end stops; state plant.travel")
    permitted = (1.0 - _MARGIN) * min(abs(stop) for stop in stops)

    def keeps(weight: float) -> bool:
        return all(measure_peak_travel(_with_weight(run, weight)) <= permitted for run in runs)

    low, high = map(math.log, _WEIGHTS)
    if keeps(_WEIGHTS[0]):
        return _WEIGHTS[0]
    if not keeps(_WEIGHTS[1]):
        raise SynthesisError(
            f"no weight of the travel up to {_WEIGHTS[1]:g} 1/s^2 keeps the seat within {1000 * permitted:.3g} mm, nine"
            " tenths of its travel; the floor is too rough, or the damper too weak"
        )
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if keeps(math.exp(middle)) else (middle, high)
    return math.exp(high)


def _with_weight(run: Scenario, weight: float) -> Scenario:
    control = run.control
    if control is None or not isinstance(control.law, SynthesisedLaw):
        return run
    return replace(run, control=replace(control, law=control.law.with_travel_weight(weight)))
