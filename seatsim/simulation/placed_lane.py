"""A scenario as a lane of a block or of a device, and the metrics that a lane's sums give."""

from __future__ import annotations

import math
from typing import NamedTuple, cast

from seatsim.kernel.assumed_model import TrueModel
from seatsim.kernel.lane_records import numbers
from seatsim.kernel.lane_state import Lane, LaneSetup, Sums
from seatsim.kernel.loop import ROUNDING
from seatsim.kernel.loop_inputs import LoopSetup, Timing
from seatsim.kernel.rig import RigForces
from seatsim.kernel.step import IntegratorState
from seatsim.metrics.arrays import ratio
from seatsim.rig.coil import relax
from seatsim.rig.state import MECHANICAL
from seatsim.rig.temperature import Thermal, scaling
from seatsim.scenario.scenario import Scenario
from seatsim.schema.registry import specification_of
from seatsim.simulation.simulate import set_up


class PlacedLane(NamedTuple):
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


def as_lane(place: int, scenario: Scenario) -> PlacedLane | None:
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
    return PlacedLane(
        place, scenario, _lane_setup(setup, late, temperature), Lane(rest, 0.0, 0.0), memory, setup.timing
    )


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


def metrics_of_sums(lane: PlacedLane, sums: Sums, samples: int) -> dict[str, float]:
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
