"""Power-driven damping: the suspension hands no power on from the floor, as far as a damper can help it."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.rig.control import Measurement, State, law
from seatsim.rig.plant import Plant
from seatsim.schema.fields import param


class SpringCancelling(NamedTuple):
    """Compiled form of the law: `Fd = -(stiffness x + damping v)`."""

    stiffness: float
    damping: float

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return -(self.stiffness * y.displacement + self.damping * y.velocity)


@law("power_driven", source="Morselli and Zanasi 2008, Mechatronics 18:364")
class PowerDriven(NamedTuple):
    """Power-driven damping (PDD): wanted force `Fd = -share (kf x + cf v)`, which cancels spring and fixed damping.

    Clipped to what a damper can do it is the law of the source: softest where spring and softest damper take up power
    (`kf x v + c_min v^2 >= 0`), stiffest where even the stiffest damper leaves some, and between the two the damping
    at which the suspension's power is zero.
    """

    share: Annotated[float, param("-", "share of the spring's force that is cancelled", low=0, high=1)] = 1.0

    def prepared(self, plant: Plant) -> SpringCancelling:
        """Return the compiled form for a plant, with gains on the damper's force."""
        scale = self.share / plant.damper_ratio
        return SpringCancelling(scale * plant.suspension_stiffness, scale * plant.suspension_damping)
