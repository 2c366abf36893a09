"""Many scenarios at once on a CUDA device, one lane a thread: their metrics, and how far they leave their models.

The drivers' accelerations stay on the device where cupy is installed, which then weights them there; else they are
weighted here. All else is summed while a lane runs.
"""

from __future__ import annotations

import math
import warnings
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from seatsim.excitations.base import Floor
from seatsim.kernel.cuda_lanes import (
    DeviceInputs,
    KernelError,
    LaneEnd,
    free_memory,
    is_simulated,
    run_on_device,
)
from seatsim.kernel.numbers import template_of
from seatsim.kernel.sums import LaneLimits
from seatsim.metrics import METRICS, Metric, rms, weight
from seatsim.metrics.arrays import ratio
from seatsim.metrics.side_by_side import measure_drivers
from seatsim.metrics.weighting import can_weight
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import SeatsimError
from seatsim.schema.registry import specification_of
from seatsim.simulation.damper_bench import judge_centring
from seatsim.simulation.device_lanes import DeviceLane, as_device_lane, can_drive
from seatsim.simulation.summed_metrics import RigOfSums, metrics_of_sums
from seatsim.simulation.validity import Excursions, highest_current

MakeFloor = Callable[[Scenario], Floor | None]

MOST_BYTES, MOST_SHARE = 4 << 30, 0.5
"""Bytes of accelerations, floors and noise on the device at once, at 10 s and 1 kHz those of 54 000 lanes on few
floors, and the share of its free memory that these may take."""
WEIGHTED_AT_ONCE = 1024
"""Drivers that are weighted at once: their transforms take five times the memory of their accelerations."""


class LaneRow(NamedTuple):
    """Metrics of a run by name, and how far it leaves the range of its models."""

    metrics: dict[str, Metric]
    excursions: Excursions


class _Driven(NamedTuple):
    """A lane with the floor that drives it, and the noise of its readings."""

    lane: DeviceLane
    floor: Floor
    noise: Array


def simulate_on_device(scenarios: Sequence[Scenario], make_floor: MakeFloor) -> Iterator[tuple[int, LaneRow]]:
    """Yield place and row of every scenario that a lane on the device can simulate to its end, in any order.

    Those that are left out are to be simulated by themselves: what `as_device_lane` has no room for, floors with a
    recorded temperature, current or command, models that do not compile, scenarios that are wrong, and runs that
    diverge or whose acceleration is not finite. `make_floor` gives the floor of a scenario; the same object for several
    is held once.
    """
    groups: dict[object, list[DeviceLane]] = defaultdict(list)
    for place, scenario in enumerate(scenarios):
        with suppress(SeatsimError):
            if lane := as_device_lane(place, scenario):
                groups[lane.combination].append(lane)
    for group in groups.values():
        for batch in _batch_lanes(group, make_floor):
            yield from _run_lanes(batch)


def _batch_lanes(lanes: Sequence[DeviceLane], make_floor: MakeFloor) -> Iterator[list[_Driven]]:
    """Yield lanes of one duration, as many at once as the memory of the device permits."""
    waiting: dict[int, list[_Driven]] = defaultdict(list)
    floors: set[int] = set()
    held, most = 0, min(MOST_BYTES, MOST_SHARE * free_memory())
    for lane in lanes:
        with suppress(SeatsimError):
            floor = make_floor(lane.scenario)
            if floor is not None and can_drive(floor):
                samples = len(floor.acceleration)
                driven = _Driven(lane, floor, lane.noise(samples))
                waiting[samples].append(driven)
                # A floor that no lane of the batch has yet takes as much again twice, with its velocity.
                held += driven.noise.nbytes + floor.acceleration.nbytes * (1 if id(floor) in floors else 3)
                floors.add(id(floor))
        if held >= most:
            yield from waiting.values()
            waiting.clear()
            floors.clear()
            held = 0
    yield from waiting.values()


def _run_lanes(group: Sequence[_Driven]) -> Iterator[tuple[int, LaneRow]]:
    """Run lanes of one combination and duration at once."""
    lanes, step = [each.lane for each in group], group[0].lane.start.setup.timing.step
    floors = list({id(each.floor): each.floor for each in group}.values())
    at = {id(floor): index for index, floor in enumerate(floors)}
    floor_of = np.array([at[id(each.floor)] for each in group])
    starts = [lane.start for lane in lanes]
    specification = specification_of(type(lanes[0].scenario.damper.record))
    inputs = DeviceInputs(
        _side_by_side([np.array(lane.numbers, dtype=float) for lane in lanes]),
        _side_by_side([floor.acceleration for floor in floors]),
        _side_by_side([floor.velocity for floor in floors]),
        floor_of,
        _side_by_side([each.noise for each in group]),
    )
    limits = LaneLimits(
        float(specification.max_speed),
        float(highest_current(specification.max_current)),
        *map(float, specification.temperatures),
    )
    try:
        ends, driver = run_on_device(template_of(starts), limits, inputs, max(lane.depth for lane in lanes))
    except KernelError as error:
        names = type(lanes[0].scenario.damper.record).__name__, type(starts[0].setup.law).__name__
        warnings.warn(f"{' and '.join(names)} do not compile for a CUDA device: {error}", stacklevel=2)
        return
    comfort = _measure_drivers(driver, step)
    on_floor = np.array([_weighted_rms(floor.acceleration, step) for floor in floors])[floor_of]
    samples = len(floors[0].acceleration)
    for index, (lane, end) in enumerate(zip(lanes, ends, strict=True)):
        found = {name: float(values[index]) for name, values in comfort.items()}
        if end.reached == samples and math.isfinite(found["driver_acceleration_rms"]):
            if "driver_acceleration_weighted" in found:
                found["seat_factor"] = ratio(found["driver_acceleration_weighted"], float(on_floor[index]))
            yield lane.place, _row(lane, end, samples, found)


def _side_by_side(columns: Sequence[Array]) -> Array:
    """Return arrays of one shape along a new last axis, as the threads of the device read them."""
    return np.ascontiguousarray(np.stack(columns, axis=-1))


def _row(lane: DeviceLane, end: LaneEnd, samples: int, found: dict[str, float]) -> LaneRow:
    rig = RigOfSums(lane.start.setup.timing.step, lane.scenario.coil.resistance, end.temperature)
    found |= metrics_of_sums(end.sums, samples, rig)
    if lane.start.setup.rig.plant.end_stops is None:
        del found["end_stop_hits"]
    metrics = {name: Metric(found[name], known.unit, known.meaning) for name, known in METRICS.items() if name in found}
    is_centred = specification_of(type(lane.scenario.damper.record)).centred
    sums = end.sums
    drift = judge_centring(sums.lengths, sums.middles) if is_centred else ""
    fast, strong, foreign = (count / samples for count in (sums.fast, sums.strong, sums.foreign))
    return LaneRow(metrics, Excursions(fast, strong, foreign, sums.displacement_peak, drift))


def _weighted_rms(floor: Array, step: float) -> float:
    return rms(weight(floor, 1.0 / step)) if can_weight(1.0 / step) else math.nan


def _measure_drivers(driver: Any, step: float) -> dict[str, Array]:
    """Return the metrics of drivers whose accelerations, shape (N, L), are on the device."""
    arrays = _arrays_on_device()
    held = driver.copy_to_host() if arrays is np else arrays.asarray(driver)
    parts = []
    for first in range(0, held.shape[1], WEIGHTED_AT_ONCE):
        # Behind the end of a lane that diverged anything may stand.
        with np.errstate(over="ignore", invalid="ignore"):
            part = measure_drivers(held[:, first : first + WEIGHTED_AT_ONCE], step, arrays)
        parts.append({name: values if arrays is np else values.get() for name, values in part.items()})
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _arrays_on_device() -> ModuleType:
    """Return cupy where it is installed, else numpy."""
    if is_simulated() or find_spec("cupy") is None:
        return np
    return import_module("cupy")
