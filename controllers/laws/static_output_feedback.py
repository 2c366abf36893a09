"""H-infinity static output feedback of suspension displacement and velocity."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from controllers.analysis.margins import compute_margins, compute_sampled_radius
from controllers.seat_plant import ActuatorLag, Weights, build_generalised_plant
from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement, State, law
from seatsim.rig.plant import Plant
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param

if TYPE_CHECKING:
    from collections.abc import Callable

    from controllers.synthesis import Design, GeneralisedPlant

Array = NDArray[np.float64]
# Margins above this are crossings that rounding alone makes.
_UNBOUNDED = 1e6
SOURCE = "Yu et al. 2019, eqs 15-19, on the exact plant and with u = +K y for the damper force"

Gain = Annotated[float, param("N/m or N s/m", "one entry of the gain", low=-1e9, high=1e9)]
Mass = Annotated[float, param("kg", "mass of a driver", above=0, high=1e4)]
Factor = Annotated[float, param("-", "delivered over wanted force", above=0, high=10)]


class OutputFeedback(NamedTuple):
    """Compiled form of the law: `Fd = k1 x + k2 v`."""

    k1: float
    k2: float

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return self.k1 * y.displacement + self.k2 * y.velocity


@law("static_output_feedback", source=SOURCE)
class StaticOutputFeedback(NamedTuple):
    """Wanted force `Fd = gain . (x, v)`; the gain is stated, read from a saved design, or synthesised from weights.

    Exactly one of `gain` ([N/m, N s/m]), `design` (a file that `seatsim synthesise` wrote) and `weights` is given; the
    other keys belong to `weights`. One gain serves every driver of `masses` with every one of `force_factors`: the
    worst case is minimised.
    """

    gain: Annotated[tuple[Gain, Gain] | None, Field(description="gain on (x, v) in N/m and N s/m")] = None
    design: Annotated[str | None, Field(description="path of a saved design")] = None
    weights: Annotated[Weights | None, Field(description="weights of a synthesis at the start of the run")] = None
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

    def prepared(self, plant: Plant) -> OutputFeedback:
        """Return the compiled form for a plant, after synthesis where weights are given."""
        if [self.gain, self.design, self.weights].count(None) != 2:
            raise InputError("give exactly one of 'gain', 'design' and 'weights'")
        if self.gain is not None:
            return OutputFeedback(float(self.gain[0]), float(self.gain[1]))
        from controllers.synthesis import Design

        gain = (Design.load(Path(self.design)) if self.design else self.synthesis(plant)).gain
        if gain.shape != (1, 2):
            raise InputError(
                f"{self.design}: a gain of shape {gain.shape}; this law takes (1, 2), for one damper on (x, v)"
            )
        return OutputFeedback(float(gain[0, 0]), float(gain[0, 1]))

    def synthesis(self, plant: Plant, progress: Callable[[str], object] = lambda text: None) -> Design:
        """Return the H-infinity design for a plant with this law's weights (the default ones where none are given)."""
        from controllers.synthesis import synthesise

        return synthesise(self.plants(plant), progress=progress)

    def plants(self, plant: Plant) -> list[GeneralisedPlant]:
        """Return the generalised plant of every driver with every force factor."""
        drivers = [plant._replace(driver_mass=mass) for mass in self.masses or [plant.driver_mass]]
        weights = self.weights or Weights()
        return [
            build_generalised_plant(driver, weights, self.lag, self.displacement_gain, factor)
            for driver in drivers
            for factor in self.force_factors
        ]

    def checks(self, plant: Plant, coil: Coil, sample_time: float, gain: Array) -> dict[str, str]:
        """Return, in words, the margins of the scenario's own loop with coil and delay, and of its sampled loop."""
        found = compute_margins(plant, gain, coil)
        radius = compute_sampled_radius(plant, gain, coil, sample_time, round(coil.delay / sample_time))
        rises = "any" if found.gain > _UNBOUNDED else f"{found.gain:.3g}"
        turns = "any" if math.isinf(found.phase) else f"{found.phase:.3g} degrees"
        waits = "any" if math.isinf(found.delay) else f"{1000 * found.delay:.3g} ms"
        verdict = "stable" if radius < 1 else "UNSTABLE"
        return {
            "margins": f"gain {rises}, phase {turns}, delay {waits}, with the coil's lag",
            "sampled loop": f"{verdict} at {1000 * sample_time:g} ms: spectral radius {radius:.5f}",
        }
