"""Many scenarios at once, as their metrics alone: those that share their models run side by side, in lanes.

A lane's metrics are those of a single run but for rounding, since the compiler may add and fuse in another order: they
differ by less than 1e-9 of their value. Those of the driver come from the driver's whole acceleration by the very
functions of `seatsim.metrics`; the others are summed while the block runs, and no history is kept.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.cached import compiled
from seatsim.excitations.base import Floor
from seatsim.kernel.assumed_model import TrueModel
from seatsim.kernel.lane_records import LANES, fill, numbers, template_of
from seatsim.kernel.lanes import Demand, Lane, LaneInputs, LaneRows, LaneSetup, Sums, run_lanes
from seatsim.kernel.loop import ROUNDING
from seatsim.kernel.loop_inputs import LoopInputs, LoopSetup, Timing
from seatsim.kernel.rig import RigForces
from seatsim.kernel.step import IntegratorState
from seatsim.metrics import METRICS, Metric, summarise
from seatsim.metrics.arrays import ratio
from seatsim.rig.coil import relax
from seatsim.rig.sensors import Direct
from seatsim.rig.state import MECHANICAL
from seatsim.rig.temperature import scaling
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import RunError
from seatsim.schema.registry import specification_of
from seatsim.simulation.inputs import Forces
from seatsim.simulation.runs import run_one
from seatsim.simulation.simulate import diverged, prepare_inputs, set_up

Array = NDArray[np.float64]
Row = dict[str, Metric] | RunError


class _Prepared(NamedTuple):
    """A scenario that can be a lane, with what drives it and its law's and its damper's state at rest."""

    place: int
    scenario: Scenario
    setup: LaneSetup
    state: Lane
    memory: tuple[float, ...]
    timing: Timing
    inputs: LoopInputs

    @property
    def combination(self) -> object:
        """What lanes of a block must have in common; all else are numbers."""
        models = type(self.setup.rig.damper), type(self.setup.law), self.setup.inverse_model.order
        return models, self.timing, len(self.inputs.floor_acceleration), tuple(map(type, numbers(self.setup)))


def simulate_ensemble(scenarios: Sequence[Scenario]) -> list[Row]:
    """Return for every scenario its metrics by name, as `seatsim.metrics.summarise` does of its run, or why it failed.

    Blocks of `LANES` scenarios with the same models, steps and duration run side by side, whatever their parameters,
    floors, seeds, temperatures and masses. What a lane has no room for runs by itself and gives the same row: effects,
    a seated body, sensors, an inverse of its own, a damper that warms up, a recorded temperature or current, a delay
    that is no whole number of steps.

    Raises:
        InputError: a scenario is wrong.
    """
    rows: list[Row | None] = [None] * len(scenarios)
    groups: dict[object, list[_Prepared]] = defaultdict(list)
    for place, scenario in enumerate(scenarios):
        prepared = _prepare(place, scenario)
        if prepared is None:
            rows[place] = _run_alone(scenario)
        else:
            groups[prepared.combination].append(prepared)
    for group in groups.values():
        for block in _blocks(group):
            for prepared, row in zip(block, _run_block(block, group), strict=True):
                rows[prepared.place] = row
    return [row for row in rows if row is not None]


def _run_alone(scenario: Scenario) -> Row:
    try:
        return run_one(scenario).metrics
    except RunError as error:
        return error


def _blocks(group: Sequence[_Prepared]) -> Iterator[list[_Prepared]]:
    waiting = iter(group)
    while block := list(islice(waiting, LANES)):
        yield block


def _prepare(place: int, scenario: Scenario) -> _Prepared | None:
    """Return a scenario as a lane, None where a lane has no room for it."""
    if scenario.plant is None or scenario.control is None or scenario.effects or scenario.control.sensors:
        return None
    with scenario.placed("excitation"):
        floor: Floor = scenario.excitation.floor(scenario.solver.step, scenario.seed)
    setup, initial = set_up(scenario, scenario.plant, scenario.control, floor.temperature is not None, False)
    inputs = prepare_inputs(scenario, scenario.control, floor, Forces())
    late = math.floor(setup.coil.delay / setup.timing.step + ROUNDING)
    if not _has_room(setup, inputs, late):
        return None
    start = (*scenario.start, *(0.0,) * (MECHANICAL - len(scenario.start)), *initial)
    rest = IntegratorState(start, (0.0,) * len(start), RigForces(0.0, 0.0, 0.0), 0.0, setup.timing.step)
    memory = specification_of(type(scenario.control.law)).initial
    lane = _lane_setup(setup, inputs, late)
    return _Prepared(place, scenario, lane, Lane(rest, 0.0, 0.0), memory, setup.timing, inputs)


def _has_room(setup: LoopSetup, inputs: LoopInputs, late: int) -> bool:
    """Whether a lane can hold all of a run."""
    step, absent = setup.timing.step, (inputs.replayed, inputs.prescribed, inputs.frame_force, inputs.driver_force)
    try:
        list(numbers(setup.law))
    except TypeError:
        return False
    return (
        not setup.rig.effects
        and isinstance(setup.sensors, Direct)
        and isinstance(setup.inverse_model, TrueModel)
        and not setup.timing.self_heating
        and bool(np.all(inputs.temperature == inputs.temperature[0]))
        and not any(map(len, absent))
        and setup.coil.delay - late * step < ROUNDING * step
    )


def _lane_setup(setup: LoopSetup, inputs: LoopInputs, late: int) -> LaneSetup:
    step, temperature = setup.timing.step, float(inputs.temperature[0])
    rises, falls = relax(setup.coil, 0.0, 1.0, 0.5 * step), relax(setup.coil, 1.0, 0.0, 0.5 * step)
    return LaneSetup(
        setup.rig,
        setup.coil,
        setup.law,
        setup.inverse_model,  # type: ignore[arg-type]  # `_has_room` has seen that it is the true one
        setup.max_command,
        scaling(setup.factors, temperature),
        (1.0 - rises, falls),
        float(late),
        inputs.start_current,
        temperature,
    )


def _run_block(block: Sequence[_Prepared], group: Sequence[_Prepared]) -> Iterator[Row]:
    """Run one block and yield the row of each of its lanes. The whole group tells which numbers its lanes share."""
    samples, timing = len(block[0].inputs.floor_acceleration), block[0].timing
    depth = 1 + int(max(lane.setup.late for lane in group))
    empty = Demand(0.0, math.nan, math.nan)
    rows = LaneRows(
        fill([lane.setup for lane in block]),
        fill([lane.state for lane in block]),
        fill([lane.memory for lane in block]),
        fill([empty]),
        fill([Sums()]),
        np.zeros((depth, LANES)),
        np.empty((samples, LANES)),
        np.full(LANES, float(samples)),
    )
    driven = LaneInputs(
        _side_by_side([lane.inputs.floor_acceleration for lane in block]),
        _side_by_side([lane.inputs.floor_velocity for lane in block]),
    )
    first = block[0]
    parts = type(first.setup.rig.damper), type(first.setup.law)
    template = template_of([lane.setup for lane in group])
    compiled(run_lanes, parts)(template, first.state, first.memory, Sums(), timing, driven, rows)
    for index, lane in enumerate(block):
        if rows.reached[index] < samples:
            yield diverged(lane.scenario, int(rows.reached[index]))
        else:
            sums = Sums(*rows.sums.reshape(-1, LANES)[:, index].tolist())
            yield _metrics(lane, sums, np.ascontiguousarray(rows.driver[:, index]))


def _side_by_side(channels: Sequence[Array]) -> Array:
    """Return channels as columns of shape (N, LANES); the last one stands in for those that are missing."""
    return np.ascontiguousarray(np.array([*channels, *[channels[-1]] * (LANES - len(channels))]).T)


def _metrics(lane: _Prepared, sums: Sums, driver: Array) -> dict[str, Metric]:
    """Return the metrics of a lane in the order of `METRICS`."""
    floor, step = lane.inputs.floor_acceleration, lane.timing.step
    of_driver = summarise({"driver_acceleration": driver, "floor_acceleration": floor}, step)
    found = {name: metric.value for name, metric in of_driver.items()} | _summed_metrics(lane, sums, len(floor))
    return {name: Metric(found[name], known.unit, known.meaning) for name, known in METRICS.items() if name in found}


def _summed_metrics(lane: _Prepared, sums: Sums, samples: int) -> dict[str, float]:
    """Return the metrics that the sums give; those of the wanted force only where there was one."""
    # Sum of squares less half of the first and the last one: the trapezoidal rule.
    heat = sums.current - 0.5 * (sums.first_current**2 + sums.last_current**2)
    found = {
        "frame_acceleration_rms": math.sqrt(sums.frame / samples),
        "frame_acceleration_peak": sums.frame_peak,
        "suspension_displacement_rms": math.sqrt(sums.displacement / samples),
        "suspension_displacement_peak": sums.displacement_peak,
        "end_stop_hits": sums.hits,
        "current_rms": math.sqrt(sums.current / samples),
        "electrical_energy": lane.setup.coil.resistance * heat * lane.timing.step,
        "damper_energy": sums.damper_energy,
        "energy_residual": sums.imbalance / sums.energy if sums.energy else 0.0,
        "temperature_final": lane.setup.temperature,
    }
    if sums.asked:
        error = math.sqrt(sums.missed / sums.asked)
        found["force_tracking_error"] = error
        found["force_tracking_error_relative"] = ratio(error, math.sqrt(sums.wanted / sums.asked))
        found["force_served_share"] = ratio(sums.served, sums.asked)
    return found
