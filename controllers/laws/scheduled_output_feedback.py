"""Static output feedback whose gain follows the measured temperature, or how far the seat travels."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from controllers.laws.static_output_feedback import Factor, Gain, Mass, StaticOutputFeedback
from controllers.seat_plant import TRAVEL_AND_RATE, ActuatorLag, Measure, Weights
from seatsim.rig.coil import Coil
from seatsim.rig.control import Floors, Measurement, State, law
from seatsim.rig.plant import Plant
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param

Temperature = Annotated[float, param("degC", "temperature of a gain", low=-60, high=250)]
Travel = Annotated[float, param("m", "level of the travel of a gain", low=0, high=1)]


class Schedule(NamedTuple):
    """Compiled form of the law: each gain is linear between the points of the schedule and held beyond them.

    Fields named as measurements hold the gain on them, one at each point. The state is the level of the travel: |x|
    through a filter that follows a rise by the share `rise` a sample and a fall by the share `fall`.
    """

    points: tuple[float, ...]
    by_temperature: bool
    rise: float
    fall: float
    displacement: tuple[float, ...]
    velocity: tuple[float, ...]
    frame_velocity: tuple[float, ...]
    driver_velocity: tuple[float, ...]
    frame_acceleration: tuple[float, ...]
    driver_acceleration: tuple[float, ...]

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        where = y.temperature if self.by_temperature else state[0]
        where = min(max(where, self.points[0]), self.points[-1])
        i = 1
        while where > self.points[i]:
            i += 1
        b = (where - self.points[i - 1]) / (self.points[i] - self.points[i - 1])
        a = 1.0 - b
        return (
            (a * self.displacement[i - 1] + b * self.displacement[i]) * y.displacement
            + (a * self.velocity[i - 1] + b * self.velocity[i]) * y.velocity
            + (a * self.frame_velocity[i - 1] + b * self.frame_velocity[i]) * y.frame_velocity
            + (a * self.driver_velocity[i - 1] + b * self.driver_velocity[i]) * y.driver_velocity
            + (a * self.frame_acceleration[i - 1] + b * self.frame_acceleration[i]) * y.frame_acceleration
            + (a * self.driver_acceleration[i - 1] + b * self.driver_acceleration[i]) * y.driver_acceleration
        )

    def update(self, y: Measurement, state: State) -> State:
        """Return the level of the travel at the next sample; 0 for ever where the temperature decides."""
        if self.by_temperature:
            return (0.0,)
        change = abs(y.displacement) - state[0]
        return (state[0] + (self.rise if change > 0 else self.fall) * change,)


@law("scheduled_output_feedback", initial=(0.0,), source="static_output_feedback at every point; schedule made up here")
class ScheduledOutputFeedback(NamedTuple):
    """Wanted force `Fd = K . measures`, K interpolated between the points of a measured schedule.

    The points are either `temperatures` of the damper or `travels`, levels of the travel: |x| through a filter that
    rises within `rise` and falls within `fall` seconds. A soft gain at a small and a firm one at a large level keep the
    seat off its stops on rough floors and soft on smooth ones. One gain a point is stated under `gains`, or synthesised
    from `weights` with one of `force_factors` a temperature, or from `weights_at_travels` with all of `force_factors`
    at every level. The other keys are those of `static_output_feedback`. Each gain is proven stable where the schedule
    stays there, not between points or while it moves.
    """

    temperatures: Annotated[tuple[Temperature, ...] | None, Field(description="temperatures, rising")] = None
    travels: Annotated[tuple[Travel, ...] | None, Field(description="levels of the travel, rising")] = None
    gains: Annotated[
        tuple[tuple[Gain, ...], ...] | None, Field(description="gain on what is measured, one entry each, one a point")
    ] = None
    weights: Annotated[Weights | None, Field(description="weights of the syntheses at the start of the run")] = None
    force_factors: Annotated[
        tuple[Factor, ...] | None,
        Field(description="delivered over wanted force, one a temperature; all of them at every level"),
    ] = None
    weights_at_travels: Annotated[
        tuple[Weights, ...] | None, Field(description="weights of the synthesis at each level of the travel")
    ] = None
    rise: Annotated[float, param("s", "time constant of a rising level", low=0, high=100)] = 0.3
    fall: Annotated[float, param("s", "time constant of a falling level", low=0, high=100)] = 2.0
    measures: Annotated[tuple[Measure, ...], Field(min_length=1, description="what is measured")] = TRAVEL_AND_RATE
    masses: Annotated[tuple[Mass, ...] | None, Field(description="drivers to design for in kg")] = None
    displacement_gain: Annotated[bool, Field(description="whether the gain on x is free")] = True
    lag: Annotated[
        ActuatorLag | None, Field(description="lag from wanted to delivered force that the design knows of")
    ] = None

    def on_floors(self, plant: Plant, coil: Coil, sample_time: float, floors: Floors) -> Schedule:
        """Return the compiled form for a seat and its floors, after synthesis where weights are given.

        Raises:
            InputError: keys that exclude or need each other, points that do not rise, or not one entry a point.
        """
        points = self._require_points()
        laws = [self._law_at(place) for place in range(len(points))]
        gains = [law.on_floors(plant, coil, sample_time, floors) for law in laws]
        return Schedule(
            tuple(float(point) for point in points),
            self.temperatures is not None,
            _find_share(self.rise, sample_time),
            _find_share(self.fall, sample_time),
            *(tuple(column) for column in np.array(gains, dtype=np.float64).T.tolist()),
        )

    def _require_points(self) -> tuple[float, ...]:
        if (self.temperatures is None) == (self.travels is None):
            raise InputError("give exactly one of 'temperatures' and 'travels'")
        if self.temperatures is not None:
            variable, weights, varied, foreign = "temperatures", "weights", "force_factors", "weights_at_travels"
        else:
            variable, weights, foreign = "travels", "weights_at_travels", "weights"
            varied = weights
        stated = self._asdict()
        if (self.gains is None) == (stated[weights] is None):
            raise InputError(f"give exactly one of 'gains' and '{weights}'")
        if stated[foreign] is not None:
            raise InputError("weights belong to 'temperatures', and weights_at_travels to 'travels'")
        points: tuple[float, ...] = stated[variable]
        if len(points) < 2 or any(high <= low for low, high in pairwise(points)):
            raise InputError(f"{variable} {list(points)} must be two or more, and must rise")
        name = varied if self.gains is None else "gains"
        count = len(stated[name] or ())
        if count != len(points):
            raise InputError(f"{name} has {count} entries; one for each of the {len(points)} {variable}")
        return points

    def _law_at(self, place: int) -> StaticOutputFeedback:
        """Return the law with one gain that is at work where the schedule stays at a point."""
        if self.gains is not None:
            return StaticOutputFeedback(gain=self.gains[place], measures=self.measures)
        factors = self.force_factors or (1.0,)
        at_level = self.weights_at_travels
        return StaticOutputFeedback(
            weights=self.weights if at_level is None else at_level[place],
            measures=self.measures,
            masses=self.masses,
            force_factors=(factors[place],) if at_level is None else factors,
            displacement_gain=self.displacement_gain,
            lag=self.lag,
        )


def _find_share(time_constant: float, sample_time: float) -> float:
    """Return the share of a change that a first-order filter follows within a sample."""
    return -math.expm1(-sample_time / time_constant) if time_constant else 1.0
