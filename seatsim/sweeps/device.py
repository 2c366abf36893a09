"""Engine `cuda`: runs that share their models side by side on a CUDA device, the others on this machine.

What a lane of the device has no room for, and what does not reach its end there, is given to the engine `local`: it
simulates the run again and says why.
"""

from __future__ import annotations

import warnings
from collections import defaultdict
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import suppress
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np
from numba.core import config

from seatsim.excitations.base import Floor
from seatsim.kernel.cuda_lanes import DeviceInputs, KernelError, LaneStart, free_memory, numbers, run_on_device
from seatsim.kernel.loop_data import CHANNELS
from seatsim.rig.sensors import READINGS, Direct, at_rest
from seatsim.rig.temperature import Thermal
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, RunError, SeatsimError
from seatsim.simulation.augment import acts_on_signals
from seatsim.simulation.result import History
from seatsim.simulation.simulate import initial_states, is_whole, read_history, set_up
from seatsim.sweeps.engines import LocalEngine, Outcome, Work, assess_run, floor_of
from seatsim.sweeps.plan import Plan

_MakeFloor = Callable[[Scenario], Floor | None]

_MOST_BYTES, _MOST_SHARE = 4 << 30, 0.5
"""Bytes of histories, floors and noise on the device at once, at 10 s and 1 kHz those of 3000 lanes on few floors, and
the share of its free memory that these may take."""


class _DeviceLane(NamedTuple):
    """A scenario as a lane: its place among the others, what it begins with, and that as `numbers`."""

    place: int
    scenario: Scenario
    start: LaneStart
    numbers: list[float]

    def noise(self, samples: int) -> Array:
        """Return the noise of the readings of a run of so many samples, shape (M, READINGS); a row if there is none."""
        sensors = self.scenario.control.sensors if self.scenario.control else None
        if sensors is None:
            return np.zeros((1, READINGS))
        return sensors.noise(-(-samples // self.start.setup.timing.sample_every), self.scenario.seed)


class _Driven(NamedTuple):
    """A lane with the floor that drives it, and the noise of its readings."""

    lane: _DeviceLane
    floor: Floor
    noise: Array


def simulate_on_device(scenarios: Sequence[Scenario], make_floor: _MakeFloor) -> Iterator[tuple[int, History]]:
    """Yield place and history of every scenario that a lane on the device can simulate to its end, in any order.

    Those that are left out are to be simulated by themselves: what `as_device_lane` has no room for, floors with a
    recorded temperature, current or command, models that do not compile, scenarios that are wrong, and runs that
    diverge. `make_floor` gives the floor of a scenario; the same object for several is held once.
    """
    groups: dict[object, list[_DeviceLane]] = defaultdict(list)
    for place, scenario in enumerate(scenarios):
        with suppress(SeatsimError):
            if lane := as_device_lane(place, scenario):
                # What lanes side by side must have in common beside their duration; all else are numbers.
                groups[_form_of(lane.start), lane.start.setup.timing].append(lane)
    for group in groups.values():
        for batch in _batch_lanes(group, make_floor):
            yield from _run_lanes(batch)


def as_device_lane(place: int, scenario: Scenario) -> _DeviceLane | None:
    """Return a scenario as a lane, None where a lane has no room for it: what acts on whole signals, or needs arrays.

    Raises:
        InputError: the scenario is wrong.
    """
    plant, control, temperature = scenario.plant, scenario.control, scenario.temperature
    if plant is None or control is None or acts_on_signals(scenario.effects):
        return None
    setup, rig = set_up(scenario, plant, control, is_recorded=False, carry_all_effects=False)
    start = LaneStart(
        setup,
        *initial_states(control, setup, rig),
        () if isinstance(setup.sensors, Direct) else at_rest(scenario.start.displacement),
        temperature.start if isinstance(temperature, Thermal) else temperature,
        *scenario.start,
    )
    try:
        return _DeviceLane(place, scenario, start, numbers(start))
    except TypeError:
        return None


def _form_of(part: object) -> object:
    """Return the classes of a record and of all its fields."""
    return (type(part), *map(_form_of, part)) if isinstance(part, tuple) else type(part)


def _batch_lanes(lanes: Sequence[_DeviceLane], make_floor: _MakeFloor) -> Iterator[list[_Driven]]:
    """Yield lanes of one duration, as many at once as the memory of the device permits."""
    waiting: dict[int, list[_Driven]] = defaultdict(list)
    held, most = 0, min(_MOST_BYTES, _MOST_SHARE * free_memory())
    for lane in lanes:
        with suppress(SeatsimError):
            floor = make_floor(lane.scenario)
            if floor is not None and floor.temperature is floor.coil_current is floor.command is None:
                driven = _Driven(lane, floor, lane.noise(len(floor.acceleration)))
                waiting[len(floor.acceleration)].append(driven)
                # The rows of the history, and at most a floor of its own with its velocity.
                held += driven.noise.nbytes + floor.acceleration.nbytes * (len(CHANNELS) + 2)
        if held >= most:
            yield from waiting.values()
            waiting.clear()
            held = 0
    yield from waiting.values()


def _run_lanes(group: Sequence[_Driven]) -> Iterator[tuple[int, History]]:
    """Run lanes of one combination and duration at once."""
    lanes, floors = [each.lane for each in group], list({id(each.floor): each.floor for each in group}.values())
    at = {id(floor): index for index, floor in enumerate(floors)}
    inputs = DeviceInputs(
        _side_by_side([np.array(lane.numbers, dtype=float) for lane in lanes]),
        _side_by_side([floor.acceleration for floor in floors]),
        _side_by_side([floor.velocity for floor in floors]),
        np.array([at[id(each.floor)] for each in group]),
        _side_by_side([each.noise for each in group]),
    )
    try:
        rows, reached = run_on_device(lanes[0].start, inputs)
    except KernelError as error:
        names = type(lanes[0].scenario.damper.record).__name__, type(lanes[0].start.setup.law).__name__
        warnings.warn(f"{' and '.join(names)} do not compile for a CUDA device: {error}", stacklevel=2)
        return
    for index, lane in enumerate(lanes):
        out = np.ascontiguousarray(rows[:, :, index].T).T
        if is_whole(out, reached[index]):
            yield lane.place, read_history(lane.scenario, lane.start.setup, out)


def _side_by_side(columns: Sequence[Array]) -> Array:
    """Return arrays of one shape along a new last axis, as the threads of the device read them."""
    return np.ascontiguousarray(np.stack(columns, axis=-1))


_AT_ONCE = 32_768
"""Runs that are made ready together, as many as the largest devices simulate at once."""
_EXTRA = 'engine cuda needs an extra; install it with: pip install "seatsim[cuda]"'


def check_device(keep_histories: bool) -> None:
    """Refuse what this engine cannot do, before anything is written.

    Raises:
        InputError: histories are to be kept, the extra is not installed, or there is no CUDA device.
    """
    if keep_histories:
        raise InputError("--engine cuda: no histories are kept on the device; choose --keep none, or --engine local")
    # The target for cards within numba itself cannot type the models.
    if not config.ENABLE_CUDASIM and find_spec("numba_cuda") is None:
        raise InputError(_EXTRA)
    from seatsim.kernel.cuda_lanes import has_device

    if not has_device():
        raise InputError(
            "--engine cuda: no CUDA device can be used here: there is no NVIDIA card, or its driver is not installed;"
            " choose --engine local or dask"
        )


class CudaEngine(NamedTuple):
    """Simulates runs on the device, and up to `jobs` others at once on this machine."""

    jobs: int

    def __call__(self, work: Work) -> Generator[list[Outcome]]:
        """Yield the outcomes of the device batch by batch, then those of the other runs.

        Raises:
            RunError: the device failed.
        """
        runs, others = [run for task in work.tasks for run in task], list[int]()
        for first in range(0, len(runs), _AT_ONCE):
            batch = runs[first : first + _AT_ONCE]
            outcomes = _simulate_on_device(work.plan, batch)
            done = {outcome.run for outcome in outcomes}
            others += [run for run in batch if run not in done]
            yield outcomes
        if others:
            warnings.warn(
                f"{len(others)} of {len(runs)} runs are simulated on the processor: those that the device has no room"
                " for (effects, sensors, self-heating and others), and those that did not reach their end there",
                stacklevel=2,
            )
            yield from LocalEngine(self.jobs)(work._replace(tasks=[others]))


def _simulate_on_device(plan: Plan, runs: Sequence[int]) -> list[Outcome]:
    """Return the outcomes of the runs that reached their end on the device.

    Raises:
        RunError: the device failed.
    """
    read: list[tuple[int, Scenario]] = []
    for run in runs:
        with suppress(SeatsimError):  # the engine `local` says what is wrong
            read.append((run, plan.scenario(run)))
    scenarios = [scenario for _, scenario in read]
    outcomes = []
    try:
        for place, history in simulate_on_device(scenarios, floor_of):
            number, scenario = read[place]
            with suppress(SeatsimError):
                outcomes.append(assess_run(number, scenario, history))
    except Exception as error:  # numba and the driver have many errors of their own
        raise RunError(
            f"the CUDA device failed ({type(error).__name__}: {error}); what has ended is kept: go on with --resume and"
            " --engine local"
        ) from error
    return outcomes
