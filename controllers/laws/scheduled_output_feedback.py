"""Static output feedback whose gain follows the measured temperature."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, NamedTuple

from pydantic import Field

from controllers.laws.static_output_feedback import Factor, Gain, OutputFeedback, StaticOutputFeedback
from controllers.seat_plant import ActuatorLag, Weights
from seatsim.rig.control import Measurement, State, law
from seatsim.rig.plant import Plant
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param

Temperature = Annotated[float, param("degC", "temperature of a gain", low=-60, high=250)]


class Schedule(NamedTuple):
    """Compiled form of the law: `Fd = k1(T) x + k2(T) v`, linear between temperatures, held beyond them."""

    temperatures: tuple[float, ...]
    k1: tuple[float, ...]
    k2: tuple[float, ...]

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        t = min(max(y.temperature, self.temperatures[0]), self.temperatures[-1])
        k1, k2 = self.k1[0], self.k2[0]
        for i in range(1, len(self.temperatures)):
            low, high = self.temperatures[i - 1], self.temperatures[i]
            if t > low:
                share = min((t - low) / (high - low), 1.0)
                k1 = self.k1[i - 1] + share * (self.k1[i] - self.k1[i - 1])
                k2 = self.k2[i - 1] + share * (self.k2[i] - self.k2[i - 1])
        return k1 * y.displacement + k2 * y.velocity


@law("scheduled_output_feedback", source="static_output_feedback at every temperature; interpolation made up here")
class ScheduledOutputFeedback(NamedTuple):
    """Wanted force `Fd = K(T) (x, v)`, T measured; gains are stated or synthesised, one a temperature.

    `temperatures` rise. Either `gains` ([N/m, N s/m] each) or `weights` and `force_factors` (what the damper delivers
    of the wanted force at that temperature) are given, as many as there are temperatures; `displacement_gain` and
    `lag` are those of `static_output_feedback`. Stability is proven at each temperature that stays, not between them
    or while it moves: temperatures move in minutes, the loop in tenths of a second.
    """

    temperatures: Annotated[tuple[Temperature, ...], Field(min_length=2, description="temperatures, rising")]
    gains: Annotated[
        tuple[tuple[Gain, Gain], ...] | None, Field(description="gain on (x, v) in N/m and N s/m, one a temperature")
    ] = None
    weights: Annotated[Weights | None, Field(description="weights of the syntheses at the start of the run")] = None
    force_factors: Annotated[
        tuple[Factor, ...] | None, Field(description="delivered over wanted force, one a temperature")
    ] = None
    displacement_gain: Annotated[bool, Field(description="whether the gain on x is free")] = True
    lag: Annotated[
        ActuatorLag | None, Field(description="lag from wanted to delivered force that the design knows of")
    ] = None

    def prepared(self, plant: Plant) -> Schedule:
        """Return the compiled form for a plant, after synthesis where weights are given."""
        if (self.gains is None) == (self.weights is None):
            raise InputError("give exactly one of 'gains' and 'weights'")
        if any(high <= low for low, high in pairwise(self.temperatures)):
            raise InputError(f"temperatures {list(self.temperatures)} must rise")
        self._require_as_many("gains" if self.weights is None else "force_factors")
        gains = self.gains if self.gains is not None else self._synthesised(plant)
        return Schedule(
            tuple(float(t) for t in self.temperatures),
            tuple(float(gain[0]) for gain in gains),
            tuple(float(gain[1]) for gain in gains),
        )

    def _require_as_many(self, name: str) -> None:
        count = len(getattr(self, name) or ())
        if count != len(self.temperatures):
            raise InputError(f"{name} has {count} entries; one for each of the {len(self.temperatures)} temperatures")

    def _synthesised(self, plant: Plant) -> tuple[OutputFeedback, ...]:
        one = StaticOutputFeedback(weights=self.weights, displacement_gain=self.displacement_gain, lag=self.lag)
        return tuple(one._replace(force_factors=(f,)).prepared(plant) for f in self.force_factors or ())
