"""Scenarios as lanes of a CUDA device: which of them are, and what each begins with."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from seatsim.excitations.base import Floor
from seatsim.kernel.cuda_lanes import LaneStart
from seatsim.kernel.loop import delay_of
from seatsim.kernel.numbers import numbers
from seatsim.rig.sensors import READINGS, Direct, at_rest
from seatsim.rig.temperature import Thermal
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.registry import specification_of
from seatsim.simulation.augment import has_inner_masses
from seatsim.simulation.effect_hooks import FRAME_FORCE, TEMPERATURE, TRUTH
from seatsim.simulation.simulate import set_up


class DeviceLane(NamedTuple):
    """A scenario as a lane: its place among the others, what it begins with, and that as `numbers`."""

    place: int
    scenario: Scenario
    start: LaneStart
    numbers: list[float]

    @property
    def combination(self) -> object:
        """What lanes side by side must have in common beside their duration; all else are numbers."""
        return _form_of(self.start), self.start.setup.timing

    @property
    def depth(self) -> int:
        """Commands that have to be kept, for those that act later."""
        return 2 + delay_of(self.start.setup.coil, self.start.setup.timing.step)[0]

    def noise(self, samples: int) -> Array:
        """Return the noise of the readings of a run of so many samples, shape (M, READINGS); a row if there is none."""
        sensors = self.scenario.control.sensors if self.scenario.control else None
        if sensors is None:
            return np.zeros((1, READINGS))
        return sensors.noise(-(-samples // self.start.setup.timing.sample_every), self.scenario.seed)


def as_device_lane(place: int, scenario: Scenario) -> DeviceLane | None:
    """Return a scenario as a lane, None where a lane has no room for it: what acts on whole signals, or needs arrays.

    Raises:
        InputError: the scenario is wrong.
    """
    plant, control, temperature = scenario.plant, scenario.control, scenario.temperature
    if plant is None or control is None or has_inner_masses(scenario.driver, scenario.effects):
        return None
    if any(True for hook in (TEMPERATURE, FRAME_FORCE, TRUTH) for _ in hook.of(scenario.effects)):
        return None
    setup, initial = set_up(scenario, plant, control, is_recorded=False, carry_all_effects=False)
    changed = setup.rig.plant
    # Excursions are counted by what the scenario states of the seat.
    if changed.damper_ratio != plant.damper_ratio:
        return None
    start = LaneStart(
        setup,
        initial,
        specification_of(type(setup.inverse_model.damper)).initial,
        specification_of(type(control.law)).initial,
        () if isinstance(setup.sensors, Direct) else at_rest(scenario.start.displacement),
        temperature.start if isinstance(temperature, Thermal) else temperature,
        *scenario.start,
    )
    try:
        return DeviceLane(place, scenario, start, numbers(start))
    except TypeError:
        return None


def can_drive(floor: Floor) -> bool:
    """Return whether a floor drives a lane: it has no recorded temperature, current or command beside it."""
    return floor.temperature is None and floor.coil_current is None and floor.command is None


def _form_of(part: object) -> object:
    """Return the classes of a record and of all its fields."""
    return (type(part), *map(_form_of, part)) if isinstance(part, tuple) else type(part)
