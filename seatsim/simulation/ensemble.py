"""Many scenarios at once, as their metrics alone: those that share their models run side by side, in lanes.

A lane's metrics are those of a single run but for rounding, since the compiler may add and fuse in another order: they
differ by less than 1e-9 of their value. Those of the driver come from the driver's whole acceleration by the very
functions of `seatsim.metrics`; the others are summed while the block runs, and no history is kept.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.cached import compiled
from seatsim.kernel.assumed_model import TrueModel
from seatsim.kernel.lane_records import LANES, fill, numbers, template_of
from seatsim.kernel.lane_state import Demand, Lane, LaneInputs, LaneRows, LaneSetup, Sums
from seatsim.kernel.lanes import run_lanes
from seatsim.kernel.loop import ROUNDING
from seatsim.kernel.loop_inputs import LoopInputs, LoopSetup, Timing
from seatsim.kernel.rig import RigForces
from seatsim.kernel.step import IntegratorState
from seatsim.metrics import METRICS, Metric, summarise
from seatsim.rig.coil import relax
from seatsim.rig.state import MECHANICAL
from seatsim.rig.temperature import Thermal, scaling
from seatsim.scenario.scenario import Control, Scenario
from seatsim.schema.errors import RunError
from seatsim.schema.registry import specification_of
from seatsim.simulation.inputs import Forces
from seatsim.simulation.runs import run_one
from seatsim.simulation.simulate import prepare_inputs, set_up
from seatsim.simulation.summed_metrics import RigOfSums, metrics_of_sums

Array = NDArray[np.float64]
Row = dict[str, Metric] | RunError


class _Lane(NamedTuple):
    """A scenario as a lane: its place among the others, its constant parts, its state and its law's memory at rest."""

    place: int
    scenario: Scenario
    setup: LaneSetup
    state: Lane
    memory: tuple[float, ...]
    timing: Timing

    @property
    def combination(self) -> object:
        """What lanes side by side must have in common beside their duration; all else are numbers."""
        models = type(self.setup.rig.damper), type(self.setup.law), self.setup.inverse_model.order
        return models, self.timing, tuple(map(type, numbers(self.setup)))


Block = list[tuple[_Lane, LoopInputs]]


def simulate_ensemble(scenarios: Sequence[Scenario]) -> list[Row]:
    """Return for every scenario its metrics by name, as `seatsim.metrics.summarise` does of its run, or why it failed.

    Up to `LANES` scenarios with the same models, steps and duration run side by side, whatever their parameters,
    floors, seeds, temperatures and masses. What a lane has no room for runs by itself and gives the same row: effects,
    a seated body, sensors, an inverse of its own, a damper that warms up, a recorded temperature or current, a delay
    that is no whole number of steps. Floors are made block by block, so that memory does not grow with the scenarios.

    Raises:
        InputError: a scenario is wrong.
    """
    rows: dict[int, Row] = {}
    groups: dict[object, list[_Lane]] = defaultdict(list)
    for place, scenario in enumerate(scenarios):
        lane = _as_lane(place, scenario)
        if lane is None:
            rows[place] = _run_alone(scenario)
        else:
            groups[lane.combination].append(lane)
    for group in groups.values():
        rows |= _run_group(group)
    return [rows[place] for place in range(len(scenarios))]


def _run_alone(scenario: Scenario) -> Row:
    try:
        return run_one(scenario).metrics
    except RunError as error:
        return error


def _as_lane(place: int, scenario: Scenario) -> _Lane | None:
    """Return a scenario as a lane, None where a lane has no room for it."""
    plant, control, temperature = scenario.plant, scenario.control, scenario.temperature
    if plant is None or control is None or control.sensors or scenario.effects or isinstance(temperature, Thermal):
        return None
    setup, initial = set_up(scenario, plant, control, is_recorded=False, carry_all_effects=False)
    late = math.floor(setup.coil.delay / setup.timing.step + ROUNDING)
    if not _has_room(setup, late):
        return None
    start = (*scenario.start, *(0.0,) * (MECHANICAL - len(scenario.start)), *initial)
    rest = IntegratorState(start, (0.0,) * len(start), RigForces(0.0, 0.0, 0.0), 0.0, setup.timing.step, 0.0)
    memory = specification_of(type(control.law)).initial
    return _Lane(place, scenario, _lane_setup(setup, late, temperature), Lane(rest, 0.0, 0.0), memory, setup.timing)


def _has_room(setup: LoopSetup, late: int) -> bool:
    """Whether the lanes' loop has all that a run needs."""
    try:
        numbers(cast("tuple[object, ...]", setup.law))
    except TypeError:
        return False
    step = setup.timing.step
    is_whole = setup.coil.delay - late * step < ROUNDING * step
    return is_whole and not setup.rig.effects and isinstance(setup.inverse_model, TrueModel)


def _lane_setup(setup: LoopSetup, late: int, temperature: float) -> LaneSetup:
    half = 0.5 * setup.timing.step
    kept = 1.0 - relax(setup.coil, 0.0, 1.0, half), relax(setup.coil, 1.0, 0.0, half)
    factors, model = scaling(setup.factors, temperature), cast("TrueModel", setup.inverse_model)
    return LaneSetup(
        setup.rig, setup.coil, setup.law, model, setup.max_command, factors, kept, float(late), temperature
    )


def _run_group(group: Sequence[_Lane]) -> dict[int, Row]:
    """Return the rows of lanes of one combination by their places."""
    rows: dict[int, Row] = {}
    template = template_of([lane.setup for lane in group])
    waiting: dict[int, Block] = defaultdict(list)
    for lane in group:
        with lane.scenario.placed("excitation"):
            floor = lane.scenario.excitation.floor(lane.timing.step, lane.scenario.seed)
        if floor.temperature is not None or floor.coil_current is not None or floor.command is not None:
            rows[lane.place] = _run_alone(lane.scenario)
            continue
        inputs = prepare_inputs(lane.scenario, cast("Control", lane.scenario.control), floor, Forces())
        block = waiting[len(floor.acceleration)]
        block.append((lane, inputs))
        if len(block) == LANES:
            rows |= _run_block(block, template)
            block.clear()
    for block in filter(None, waiting.values()):
        rows |= _run_block(block, template)
    return rows


def _run_block(block: Block, template: LaneSetup) -> dict[int, Row]:
    """Run a block side by side and return the rows of its lanes by their places."""
    lanes, inputs = zip(*block, strict=True)
    first, samples = lanes[0], len(inputs[0].floor_acceleration)
    depth = 1 + int(max(lane.setup.late for lane in lanes))
    rows = LaneRows(
        fill([lane.setup for lane in lanes]),
        fill([lane.state for lane in lanes]),
        fill([lane.memory for lane in lanes]),
        fill([Demand(0.0, math.nan, math.nan)]),
        fill([Sums()]),
        np.zeros((depth, LANES)),
        np.empty((samples, LANES)),
        np.full(LANES, float(samples)),
    )
    driven = LaneInputs(
        _side_by_side([each.floor_acceleration for each in inputs]),
        _side_by_side([each.floor_velocity for each in inputs]),
    )
    run = compiled(run_lanes, (type(first.setup.rig.damper), type(first.setup.law)))
    run(template, first.state, first.memory, Sums(), first.timing, driven, rows)
    sums = [Sums(*column) for column in rows.sums.reshape(-1, LANES).T.tolist()]
    found: dict[int, Row] = {}
    for index, (lane, each) in enumerate(block):
        if rows.reached[index] < samples:
            found[lane.place] = _run_alone(lane.scenario)
        else:
            driver = np.ascontiguousarray(rows.driver[:, index])
            found[lane.place] = _metrics(lane, each.floor_acceleration, sums[index], driver)
    return found


def _side_by_side(channels: Sequence[Array]) -> Array:
    """Return channels as columns of shape (N, LANES); the last one stands in for those that are missing."""
    return np.ascontiguousarray(np.array([*channels, *[channels[-1]] * (LANES - len(channels))]).T)


def _metrics(lane: _Lane, floor: Array, sums: Sums, driver: Array) -> dict[str, Metric]:
    """Return the metrics of a lane in the order of `METRICS`."""
    of_driver = summarise({"driver_acceleration": driver, "floor_acceleration": floor}, lane.timing.step)
    rig = RigOfSums(lane.timing.step, lane.setup.coil.resistance, lane.setup.temperature)
    found = {name: metric.value for name, metric in of_driver.items()} | metrics_of_sums(sums, len(floor), rig)
    return {name: Metric(found[name], known.unit, known.meaning) for name, known in METRICS.items() if name in found}
