"""H-infinity static output feedback of what a seat measures."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from threading import Lock
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from controllers.seat_plant import (
    TRAVEL_AND_RATE,
    ActuatorLag,
    Measure,
    ShapingFilter,
    Weights,
    build_generalised_plant,
    compute_margins,
    fit_shaping_filter,
)
from controllers.synthesis import SEAT_TIME_BUDGET, ClosedLoop, Design, GeneralisedPlant, find_gain, synthesise, verify
from controllers.synthesis.plant import LinearSystem
from seatsim.rig.coil import Coil
from seatsim.rig.control import FloorRecord, Floors, Measurement, State, law, no_floors
from seatsim.rig.designs import unit_of_gain
from seatsim.rig.plant import Plant
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param
from seatsim.schema.validation import build
from seatsim.schema.yaml_source import Source

# Margins above this are crossings that rounding alone makes.
_UNBOUNDED = 1e6
SOURCE = "Yu et al. 2019, eqs 15-19, on the exact plant and with u = +K y for the damper force"

Gain = Annotated[float, param("N/m, N s/m or kg", "one entry of the gain", low=-1e9, high=1e9)]
Mass = Annotated[float, param("kg", "mass of a driver", above=0, high=1e4)]
Factor = Annotated[float, param("-", "delivered over wanted force", above=0, high=10)]


class _SavedDesign(NamedTuple):
    """What a law takes of the file of a design."""

    gain: tuple[tuple[Gain, ...]]
    measures: tuple[Measure, ...] = ()


class OutputFeedback(NamedTuple):
    """Compiled form of the law: the sum of what is measured, each times its gain, 0 where it is not measured."""

    displacement: float
    velocity: float
    frame_velocity: float = 0.0
    driver_velocity: float = 0.0
    frame_acceleration: float = 0.0
    driver_acceleration: float = 0.0

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return (
            self.displacement * y.displacement
            + self.velocity * y.velocity
            + self.frame_velocity * y.frame_velocity
            + self.driver_velocity * y.driver_velocity
            + self.frame_acceleration * y.frame_acceleration
            + self.driver_acceleration * y.driver_acceleration
        )


@law("static_output_feedback", source=SOURCE)
class StaticOutputFeedback(NamedTuple):
    """Wanted force `Fd = gain . measures`; the gain is stated, read from a saved design, or synthesised from weights.

    Exactly one of `gain` (one entry a measure; N/m, N s/m, or kg for an acceleration), `design` (a file that `seatsim
    synthesise` wrote) and `weights` is given; the keys behind `measures` belong to `weights`. One gain serves every
    driver of `masses` with every one of `force_factors` on every floor: the worst case is minimised.

    The published gain [2, 2147.6] is the optimum for white noise and unweighted acceleration: a firm viscous damper.
    With `weights: {comfort: Wk}` the synthesis asks for a softer seat; `docs/synthesis.md`, "For the ride", compares
    both with viscous dampers and skyhook.
    """

    gain: Annotated[tuple[Gain, ...] | None, Field(description="gain on what is measured, one entry each")] = None
    design: Annotated[str | None, Field(description="path of a saved design")] = None
    weights: Annotated[Weights | None, Field(description="weights of a synthesis at the start of the run")] = None
    measures: Annotated[
        tuple[Measure, ...],
        Field(min_length=1, description="what is measured: travel and its rate, absolute motion of frame and driver"),
    ] = TRAVEL_AND_RATE
    masses: Annotated[
        tuple[Mass, ...] | None, Field(description="drivers to design for in kg; default: the scenario's own")
    ] = None
    force_factors: Annotated[
        tuple[Factor, ...], Field(description="delivered over wanted force, such as of a hot and a cold damper")
    ] = (1.0,)
    displacement_gain: Annotated[
        bool, Field(description="whether the gain on x is free; no damper can give a stiffness in steady motion")
    ] = True
    lag: Annotated[
        ActuatorLag | None, Field(description="lag from wanted to delivered force that the design knows of")
    ] = None

    def on_floors(self, plant: Plant, coil: Coil, sample_time: float, floors: Floors) -> OutputFeedback:
        """Return the compiled form for a seat and its floors, after synthesis where weights are given."""
        if [self.gain, self.design, self.weights].count(None) != 2:
            raise InputError("give exactly one of 'gain', 'design' and 'weights'")
        if len(set(self.measures)) < len(self.measures):
            raise InputError(f"measures names one signal twice: {', '.join(self.measures)}")
        if self.gain is not None:
            return self._compile(np.array([self.gain]))
        if self.design is None:
            return self._compile(self._find_loops(plant, floors)[0])
        source = Source(Path(self.design))
        known = {name: source.data[name] for name in _SavedDesign._fields if name in source.data}
        saved = build(_SavedDesign, known, source, ())
        if saved.measures and saved.measures != self.measures:
            raise InputError(f"{self.design} was designed for measures: [{', '.join(saved.measures)}]; state the same")
        return self._compile(np.array(saved.gain))

    def _compile(self, gain: Array) -> OutputFeedback:
        if gain.shape != (1, len(self.measures)):
            raise InputError(
                f"{self.design or 'gain'}: a gain of shape {gain.shape}; {', '.join(self.measures)} take one entry each"
            )
        gains = dict(zip(self.measures, gain[0].tolist(), strict=True))
        return OutputFeedback(**{"displacement": 0.0, "velocity": 0.0} | gains)

    def synthesis(
        self, plant: Plant, floors: Floors = no_floors, progress: Callable[[str], object] = lambda text: None
    ) -> Design:
        """Return the H-infinity design for a plant with this law's weights (the default ones where none are given)."""
        plants = self.plants(plant, self._shape_floors(floors))
        return replace(synthesise(plants, time_budget=SEAT_TIME_BUDGET, progress=progress), measures=self.measures)

    def plants(self, plant: Plant, floors: Sequence[ShapingFilter | None] = (None,)) -> list[GeneralisedPlant]:
        """Return the generalised plant of every driver with every force factor on every floor (None: a white one)."""
        drivers = [plant._replace(driver_mass=mass) for mass in self.masses or [plant.driver_mass]]
        weights = self.weights or Weights()
        return [
            build_generalised_plant(driver, weights, self.lag, self.displacement_gain, factor, self.measures, floor)
            for driver in drivers
            for factor in self.force_factors
            for floor in floors
        ]

    def _shape_floors(self, floors: Floors) -> tuple[ShapingFilter | None, ...]:
        """Return the shaping filter of every floor; a white one where the weights ask for no other."""
        if self.weights is None or self.weights.floor == "white":
            return (None,)
        return tuple(map(fit_shaping_filter, floors()))

    def _find_loops(self, plant: Plant, floors: Floors) -> tuple[Array, tuple[ClosedLoop, ...]]:
        """Return the synthesised gain and the loops that it closes."""
        # Lists, which Python users may give, have no hash.
        masses = None if self.masses is None else tuple(self.masses)
        factors, measures = tuple(self.force_factors), tuple(self.measures)
        hashable = self._replace(masses=masses, force_factors=factors, measures=measures)
        # Seats whose drivers differ share a design for stated masses.
        seat = plant._replace(driver_mass=masses[0]) if masses else plant
        with _DESIGNING:
            return _design(hashable, seat, self._shape_floors(floors))

    @property
    def is_limited_by_travel(self) -> bool:
        """Whether the travel weight is still to be found."""
        return self.weights is not None and self.weights.travel == "limit"

    def with_travel_weight(self, weight: float) -> StaticOutputFeedback:
        """Return the law with another weight of the travel, in 1/s^2."""
        return self._replace(weights=(self.weights or Weights())._replace(travel=weight))

    def describe(self, plant: Plant, coil: Coil, floors: Floors) -> str:
        """Return in a line the synthesised gain, its norm and its margins; nothing where the gain is stated."""
        if self.weights is None:
            return ""
        gain, loops = self._find_loops(plant, floors)
        proven = "certified" if all(loop.certificate for loop in loops) else "not certified"
        entries = zip(gain[0], self.measures, strict=True)
        named = ", ".join(f"{value:.4g} {unit_of_gain(name)} on {name.replace('_', ' ')}" for value, name in entries)
        several = f" for {len(loops)} plants" if len(loops) > 1 else ""
        norm = f"gamma {max(loop.gamma for loop in loops):.4g}, {proven}{several}"
        return f"gain {named}; {norm}; margins: {self.margins(plant, coil, gain)}"

    def promise(self, plant: Plant, coil: Coil, gain: Array, floor: FloorRecord) -> Array:
        """Return zc'' in m/s^2, shape (N,), on a floor if the damper delivered all that is wanted, behind the coil."""
        # Imported here: a run does not need it, and it takes long.
        from scipy.signal import lsim

        lag = ActuatorLag(coil.rate, coil.delay)
        seat = build_generalised_plant(plant, Weights(1.0, 1.0), lag, measures=self.measures).close(gain)
        time = floor.step * np.arange(len(floor.acceleration))
        _, z, _ = lsim((seat.A, seat.B, seat.C, seat.D), floor.acceleration, time)
        return np.asarray(z[:, 1], dtype=np.float64)

    def with_gain(self, gain: Array) -> StaticOutputFeedback:
        """Return the law with a stated gain."""
        return self._replace(gain=tuple(gain.ravel().tolist()), design=None, weights=None)

    def margins(self, plant: Plant, coil: Coil, gain: Array) -> str:
        """Return in words the margins of the loop that a gain closes with a seat and its coil."""
        seat = build_generalised_plant(plant, Weights(), ActuatorLag(coil.rate), measures=self.measures)
        found = compute_margins(LinearSystem(seat.A, seat.B2, seat.C2, np.zeros((len(seat.C2), 1))), gain)
        rises = "any" if found.gain > _UNBOUNDED else f"{found.gain:.3g}"
        turns = "any" if math.isinf(found.phase) else f"{found.phase:.3g} degrees"
        waits = "any" if math.isinf(found.delay) else f"{1000 * found.delay:.3g} ms"
        return f"gain {rises}, phase {turns}, delay {waits}, with the coil's lag"


_DESIGNING = Lock()
"""Held while a gain is looked up or searched: runs side by side that share a design wait for it."""


@lru_cache(maxsize=64)
def _design(
    law: StaticOutputFeedback, plant: Plant, floors: tuple[ShapingFilter | None, ...]
) -> tuple[Array, tuple[ClosedLoop, ...]]:
    """Return gain and loops of a law for a plant; runs that differ in temperature alone share one design."""
    plants = law.plants(plant, floors)
    gain = find_gain(plants)
    return gain, tuple(verify(each, gain) for each in plants)
