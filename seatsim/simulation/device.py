"""Many scenarios at once on a CUDA device, one lane a thread: their metrics, and how far they leave their models.

The drivers' accelerations stay on the device where cupy is installed, which then weights them there; else they are
weighted here. All else is summed while a lane runs.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.excitations.base import Floor
from seatsim.kernel.cuda_lanes import free_memory, is_simulated, run_on_device
from seatsim.kernel.lane_records import numbers, template_of
from seatsim.kernel.lane_run import LaneEnd, LaneLimits, LaneStart
from seatsim.metrics import METRICS, Metric, rms, weight
from seatsim.metrics.arrays import ratio
from seatsim.metrics.side_by_side import measure_drivers
from seatsim.metrics.weighting import can_weight
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import SeatsimError
from seatsim.schema.registry import specification_of
from seatsim.simulation.placed_lane import PlacedLane, as_lane, metrics_of_sums
from seatsim.simulation.validity import Excursions, highest_current

Array = NDArray[np.float64]
MakeFloor = Callable[[Scenario], Floor | None]

MOST_BYTES, MOST_SHARE = 4 << 30, 0.5
"""Bytes of accelerations and floors on the device at once, at 10 s and 1 kHz those of 54 000 lanes, and the share of
its free memory that these may take."""
WEIGHTED_AT_ONCE = 1024
"""Drivers that are weighted at once: their transforms take five times the memory of their accelerations."""


class LaneRow(NamedTuple):
    """Metrics of a run by name, and how far it leaves the range of its models."""

    metrics: dict[str, Metric]
    excursions: Excursions


class _Driven(NamedTuple):
    """A lane with the floor that drives it."""

    lane: PlacedLane
    floor: Floor


def simulate_on_device(scenarios: Sequence[Scenario], make_floor: MakeFloor) -> Iterator[tuple[int, LaneRow]]:
    """Yield place and row of every scenario that a lane on the device can simulate to its end, in any order.

    Those that are left out are to be simulated by themselves: what `simulate_ensemble` has no room for, dampers that
    need centred strokes, scenarios that are wrong, and runs that diverge or whose acceleration is not finite.
    `make_floor` gives the floor of a scenario; the same object for several is held once.
    """
    groups: dict[object, list[PlacedLane]] = defaultdict(list)
    for place, scenario in enumerate(scenarios):
        with suppress(SeatsimError):
            lane = as_lane(place, scenario)
            if lane and not specification_of(type(scenario.damper.record)).centred:
                groups[lane.combination].append(lane)
    for group in groups.values():
        for batch in _batch_lanes(group, make_floor):
            yield from _run_lanes(batch)


def _batch_lanes(lanes: Sequence[PlacedLane], make_floor: MakeFloor) -> Iterator[list[_Driven]]:
    """Yield lanes of one duration, as many at once as the memory of the device permits."""
    waiting: dict[int, list[_Driven]] = defaultdict(list)
    floors: set[int] = set()
    held, most = 0, min(MOST_BYTES, MOST_SHARE * free_memory())
    for lane in lanes:
        with suppress(SeatsimError):
            floor = make_floor(lane.scenario)
            if floor and floor.temperature is None and floor.coil_current is None and floor.command is None:
                waiting[len(floor.acceleration)].append(_Driven(lane, floor))
                # A floor that no lane of the batch has yet takes as much again twice, with its velocity.
                held += floor.acceleration.nbytes * (1 if id(floor) in floors else 3)
                floors.add(id(floor))
        if held >= most:
            yield from waiting.values()
            waiting.clear()
            floors.clear()
            held = 0
    yield from waiting.values()


def _run_lanes(group: Sequence[_Driven]) -> Iterator[tuple[int, LaneRow]]:
    """Run lanes of one combination and duration at once."""
    first, lanes = group[0].lane, [each.lane for each in group]
    floors = list({id(each.floor): each.floor for each in group}.values())
    at = {id(floor): index for index, floor in enumerate(floors)}
    floor_of = np.array([at[id(each.floor)] for each in group])
    starts = [LaneStart(lane.setup, lane.state.now.state, lane.memory) for lane in lanes]
    specification = specification_of(type(first.scenario.damper.record))
    ends, driver = run_on_device(
        template_of(starts),
        first.timing,
        LaneLimits(specification.max_speed, highest_current(specification.max_current)),
        np.array([numbers(start) for start in starts], dtype=float).T.copy(),
        np.array([floor.acceleration for floor in floors]).T.copy(),
        np.array([floor.velocity for floor in floors]).T.copy(),
        floor_of,
        1 + int(max(lane.setup.late for lane in lanes)),
    )
    comfort, step = _measure_drivers(driver, first.timing.step), first.timing.step
    on_floor = np.array([_weighted_rms(floor.acceleration, step) for floor in floors])[floor_of]
    samples = len(floors[0].acceleration)
    for index, (lane, end) in enumerate(zip(lanes, ends, strict=True)):
        found = {name: float(values[index]) for name, values in comfort.items()}
        if end.reached == samples and math.isfinite(found["driver_acceleration_rms"]):
            if "driver_acceleration_weighted" in found:
                found["seat_factor"] = ratio(found["driver_acceleration_weighted"], float(on_floor[index]))
            yield lane.place, _row(lane, end, samples, found)


def _row(lane: PlacedLane, end: LaneEnd, samples: int, found: dict[str, float]) -> LaneRow:
    found |= metrics_of_sums(lane, end.sums, samples)
    metrics = {name: Metric(found[name], known.unit, known.meaning) for name, known in METRICS.items() if name in found}
    return LaneRow(metrics, Excursions(end.fast / samples, end.strong / samples, end.sums.displacement_peak))


def _weighted_rms(floor: Array, step: float) -> float:
    return rms(weight(floor, 1.0 / step)) if can_weight(1.0 / step) else math.nan


def _measure_drivers(driver: Any, step: float) -> dict[str, Array]:
    """Return the metrics of drivers whose accelerations, shape (N, L), are on the device."""
    arrays = _arrays_on_device()
    held = driver.copy_to_host() if arrays is np else arrays.asarray(driver)
    parts = []
    for first in range(0, held.shape[1], WEIGHTED_AT_ONCE):
        part = measure_drivers(held[:, first : first + WEIGHTED_AT_ONCE], step, arrays)
        parts.append({name: values if arrays is np else values.get() for name, values in part.items()})
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _arrays_on_device() -> ModuleType:
    """Return cupy where it is installed, else numpy."""
    if is_simulated() or find_spec("cupy") is None:
        return np
    return import_module("cupy")
