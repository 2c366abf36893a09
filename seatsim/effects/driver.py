"""Effects of the driver: another mass, a body with a resonance of its own."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.effects.base import Form, effect
from seatsim.kernel.rig import SeatMotion
from seatsim.rig.plant import Plant
from seatsim.rig.state import State
from seatsim.schema.fields import param


@effect("driver.mass", source="weighing", forms=({"change": 4.0}, {"change": -4.0}))
class Mass(NamedTuple):
    """An occupant heavier or lighter than the plant states."""

    change: Annotated[float, param("kg", "added mass", low=-150, high=150)]

    def plant(self, plant: Plant) -> Plant:
        """Return the plant with the other driver."""
        return plant._replace(driver_mass=max(1.0, plant.driver_mass + self.change))


@effect(
    "driver.biodynamics",
    source="one sprung mass within the body; resonance of 4-6 Hz as in ISO 5982",
    initial=(0.0, 0.0),
    off={"frequency": 5.0, "damping": 0.3},
    forms=(Form({"share": 0.2, "frequency": 5.0, "damping": 0.3}, within={"frequency": (3.0, 8.0)}),),
)
class Biodynamics(NamedTuple):
    """A body with an inner resonance: the `share` of the driver's mass hangs on a spring and dashpot within it.

    `xi'' = -(2 pi frequency)^2 xi - 2 damping (2 pi frequency) xi' - zc''`, xi relative to the pelvis; the pelvis
    carries the force of the inner mass and is lighter by it. In a recording the resonance is sought from 3 to 8 Hz.
    """

    share: Annotated[float, param("-", "share of the mass that is sprung", low=0, high=0.95)]
    frequency: Annotated[float, param("Hz", "natural frequency of the inner mass", above=0, high=30)] = 5.0
    damping: Annotated[float, param("-", "damping ratio of the inner mass", low=0, high=3)] = 0.3

    def inner_mass(self, plant: Plant, z: State) -> float:
        """Return the sprung mass in kg."""
        return self.share * plant.driver_mass

    def inner_force(self, plant: Plant, z: State) -> float:
        """Return the upward force of the inner mass on the pelvis in N."""
        omega = 2.0 * math.pi * self.frequency
        return self.share * plant.driver_mass * omega * (omega * z[0] + 2.0 * self.damping * z[1])

    def rates(self, plant: Plant, motion: SeatMotion, z: State) -> State:
        """Return the rates of inner displacement and velocity."""
        omega = 2.0 * math.pi * self.frequency
        restoring = omega * (omega * z[0] + 2.0 * self.damping * z[1])
        return (z[1], -restoring - motion.driver) if self.share > 0.0 else (0.0, 0.0)
