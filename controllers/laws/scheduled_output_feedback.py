"""Static output feedback whose gain follows the damper's temperature, and the frequency and amplitude of the travel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from controllers.laws.static_output_feedback import Factor, Gain, Mass, StaticOutputFeedback
from controllers.seat_plant import TRAVEL_AND_RATE, ActuatorLag, Measure, Weights
from seatsim.compilation.jit import jit
from seatsim.rig.coil import Coil
from seatsim.rig.control import Floors, Measurement, State, law
from seatsim.rig.plant import Plant
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param

Temperature = Annotated[float, param("degC", "temperature of a gain", low=-60, high=250)]
Frequency = Annotated[float, param("Hz", "frequency of a gain", above=0, high=100)]
Travel = Annotated[float, param("m", "amplitude of the travel of a gain", low=0, high=1)]

_SLOWEST = 0.1
"""Hz."""


@jit
def share_of(points: tuple[float, ...], place: int, where: float) -> float:
    """Return the share that the gain at one of rising points has where the schedule stands, 0 to 1.

    Linear between neighbouring points; the outer points keep the share of 1 beyond them.
    """
    neighbour = place - 1 if where < points[place] else place + 1
    if neighbour < 0 or neighbour == len(points):
        return 1.0
    return max(0.0, 1.0 - (where - points[place]) / (points[neighbour] - points[place]))


@jit
def find_frequency(points: tuple[float, ...], state: State) -> float:
    """Return the frequency of the travel in Hz, RMS rate over 2 pi RMS travel, not beyond the outer points."""
    _, square, square_of_rate = state
    # At rest there is no frequency, and analyses that vary the state about it make it negative.
    moves = square > 0.0 and square_of_rate > 0.0
    frequency = math.sqrt(square_of_rate / square) / (2.0 * math.pi) if moves else 0.0
    return min(max(frequency, points[0]), points[-1])


class Schedule(NamedTuple):
    """Compiled form of the law: gains on a grid of points, with the share of each from where the schedule stands.

    Fields named as measurements hold the gain on them, one at each point of the grid; the last axis varies fastest, and
    an axis that is not scheduled has one point. The state is the amplitude of the travel in m and the mean squares of
    the travel and of its rate, all with the forgetting factor `forgotten` a sample.
    """

    temperatures: tuple[float, ...]
    frequencies: tuple[float, ...]
    travels: tuple[float, ...]
    forgotten: float
    displacement: tuple[float, ...]
    velocity: tuple[float, ...]
    frame_velocity: tuple[float, ...]
    driver_velocity: tuple[float, ...]
    frame_acceleration: tuple[float, ...]
    driver_acceleration: tuple[float, ...]

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        frequency = find_frequency(self.frequencies, state)
        force, i = 0.0, 0
        for a in range(len(self.temperatures)):
            for b in range(len(self.frequencies)):
                for c in range(len(self.travels)):
                    share = (
                        share_of(self.temperatures, a, y.temperature)
                        * share_of(self.frequencies, b, frequency)
                        * share_of(self.travels, c, state[0])
                    )
                    force += share * (
                        self.displacement[i] * y.displacement
                        + self.velocity[i] * y.velocity
                        + self.frame_velocity[i] * y.frame_velocity
                        + self.driver_velocity[i] * y.driver_velocity
                        + self.frame_acceleration[i] * y.frame_acceleration
                        + self.driver_acceleration[i] * y.driver_acceleration
                    )
                    i += 1
        return force

    def update(self, y: Measurement, state: State) -> State:
        """Return amplitude and mean squares at the next sample; 0 for ever where the temperature alone decides."""
        if len(self.frequencies) * len(self.travels) == 1:
            return (0.0, 0.0, 0.0)
        amplitude, square, square_of_rate = state
        rate = y.velocity / (2.0 * math.pi * find_frequency(self.frequencies, state))
        return (
            max(math.hypot(y.displacement, rate), (1.0 - self.forgotten) * amplitude),
            square + self.forgotten * (y.displacement**2 - square),
            square_of_rate + self.forgotten * (y.velocity**2 - square_of_rate),
        )


@law(
    "scheduled_output_feedback",
    initial=(0.0, 0.0, 0.0),
    source="static_output_feedback at every point; schedule made up here",
)
class ScheduledOutputFeedback(NamedTuple):
    """Wanted force `Fd = K . measures`, K linear between the points of a schedule over one or more quantities.

    - `temperatures` of the damper, as measured.
    - `frequencies` of the travel x: f = RMS(x') / (2 pi RMS(x)). On a floor that moves the seat at its resonance the
      ride asks for damping, above it for skyhook.
    - `travels`: amplitudes sqrt(x^2 + (x' / (2 pi f))^2), which rise before the travel does; a firm gain at a large one
      keeps the seat off its stops. f is the seat's natural frequency where no frequencies are scheduled.

    Amplitude and mean squares are forgotten with the time constant `memory`. Of several quantities every combination is
    a point, in the order of this list, the last one varying fastest. One gain a point is stated under `gains`, or
    synthesised from one of `weights_at_points`, or from `weights` for all. `force_factors` has one entry a temperature;
    where no temperatures are scheduled, every gain serves all of them. The other keys are those of
    `static_output_feedback`. Each gain is proven stable where the schedule stays there, not between points or while it
    moves.
    """

    temperatures: Annotated[tuple[Temperature, ...] | None, Field(description="temperatures, rising")] = None
    frequencies: Annotated[
        tuple[Frequency, ...] | None, Field(description="frequencies of the travel in Hz, rising")
    ] = None
    travels: Annotated[tuple[Travel, ...] | None, Field(description="amplitudes of the travel in m, rising")] = None
    gains: Annotated[
        tuple[tuple[Gain, ...], ...] | None, Field(description="gain on what is measured, one entry each, one a point")
    ] = None
    weights: Annotated[Weights | None, Field(description="weights of the syntheses at the start of the run")] = None
    weights_at_points: Annotated[
        tuple[Weights, ...] | None, Field(description="weights of the synthesis at each point")
    ] = None
    force_factors: Annotated[
        tuple[Factor, ...] | None,
        Field(description="delivered over wanted force, one a temperature; without temperatures all at every point"),
    ] = None
    memory: Annotated[
        float, param("s", "time constant with which amplitude and frequency forget", above=0, high=1e3)
    ] = 3.0
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
        gains = [law.on_floors(plant, coil, sample_time, floors) for law in self._list_laws()]
        # Natural frequency of frame and driver on the suspension.
        rate = math.sqrt(plant.suspension_stiffness / (plant.frame_mass + plant.driver_mass))
        return Schedule(
            tuple(map(float, self.temperatures or (0.0,))),
            tuple(map(float, self.frequencies or (max(rate / (2.0 * math.pi), _SLOWEST),))),
            tuple(map(float, self.travels or (0.0,))),
            -math.expm1(-sample_time / self.memory),
            *(tuple(column) for column in np.array(gains, dtype=np.float64).T.tolist()),
        )

    def _list_laws(self) -> list[StaticOutputFeedback]:
        """Return the law with one gain that is at work where the schedule stays at a point, for every point."""
        axes = {name: getattr(self, name) for name in ("temperatures", "frequencies", "travels")}
        scheduled = {name: points for name, points in axes.items() if points is not None}
        if not scheduled:
            raise InputError(f"give at least one of {', '.join(axes)}")
        for name, points in scheduled.items():
            if len(points) < 2 or any(high <= low for low, high in pairwise(points)):
                raise InputError(f"{name} {list(points)} must be two or more, and must rise")
        count = math.prod(map(len, scheduled.values()))
        if [self.gains, self.weights, self.weights_at_points].count(None) != 2:
            raise InputError("give exactly one of 'gains', 'weights' and 'weights_at_points'")
        if self.gains is not None:
            _require_count("gains", self.gains, count, "points")
            return [StaticOutputFeedback(gain=gain, measures=self.measures) for gain in self.gains]
        weights = self.weights_at_points or (self.weights,) * count
        _require_count("weights_at_points", weights, count, "points")
        factors: list[tuple[float, ...]] = [self.force_factors or (1.0,)] * count
        if self.temperatures is not None:
            stated = self.force_factors or ()
            _require_count("force_factors", stated, len(self.temperatures), "temperatures")
            factors = [(factor,) for factor in stated for _ in range(count // len(stated))]
        elif self.weights is not None:
            raise InputError("weights alone make every gain the same: give temperatures, or weights_at_points")
        names = ("measures", "masses", "displacement_gain", "lag")
        law = StaticOutputFeedback(**{name: getattr(self, name) for name in names})
        points = zip(weights, factors, strict=True)
        return [law._replace(weights=at_point, force_factors=served) for at_point, served in points]


def _require_count(name: str, entries: Sequence[object], count: int, of: str) -> None:
    if len(entries) != count:
        raise InputError(f"{name} has {len(entries)} entries; one for each of the {count} {of}")
