"""Sliding mode: the seat is made to follow a reference seat that hangs on a skyhook damper."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement, State, law
from seatsim.rig.plant import Plant
from seatsim.schema.fields import param

SOURCE = "after Yokoyama, Hedrick and Toyama 2001, American Control Conference; surface and reference derived here"


class SampledSlidingMode(NamedTuple):
    """Compiled form of the law; its state is the velocity of the reference seat in m/s."""

    stiffness: float
    fixed_damping: float
    skyhook_damping: float
    reaching_force: float
    boundary: float
    ratio: float
    keep: float

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        s = min(max((y.frame_velocity - state[0]) / self.boundary, -1.0), 1.0)
        wanted = self.skyhook_damping * state[0] - self.fixed_damping * y.velocity + self.reaching_force * s
        return wanted / self.ratio

    def update(self, y: Measurement, state: State) -> State:
        """Return the reference's velocity at the next sample, for a spring force held until then."""
        settled = -self.stiffness * y.displacement / self.skyhook_damping
        return (settled + self.keep * (state[0] - settled),)


@law("sliding_mode", initial=(0.0,), source=SOURCE)
class SlidingMode(NamedTuple):
    """Model-following sliding mode; the seat counts as one mass M = frame and driver.

        M w' = -kf x - damping w                         velocity w of the reference, on the seat's own spring
        s    = zs' - w                                   sliding variable
        Fd   = damping w - cf v + M reaching sat(s / boundary)

    For the rigid seat this gives `s' = -reaching sat(s / boundary)`, wherever the damper can deliver Fd.
    """

    damping: Annotated[float, param("N s/m", "skyhook damping of the reference", above=0, high=1e6)] = 1000.0
    reaching: Annotated[float, param("m/s^2", "rate at which s is reduced", low=0, high=1e3)] = 2.0
    boundary: Annotated[float, param("m/s", "half width of the boundary layer", above=0, high=10)] = 0.1

    def sampled(self, plant: Plant, coil: Coil, sample_time: float) -> SampledSlidingMode:
        """Return the compiled form for a plant and a sample time."""
        mass = plant.frame_mass + plant.driver_mass
        return SampledSlidingMode(
            plant.suspension_stiffness,
            plant.suspension_damping,
            self.damping,
            mass * self.reaching,
            self.boundary,
            plant.damper_ratio,
            math.exp(-self.damping * sample_time / mass),
        )
