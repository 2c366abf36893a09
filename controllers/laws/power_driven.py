"""Laws that switch on the frame's acceleration (ADD, alone and mixed with skyhook), and power-driven damping (PDD)."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.rig.control import Measurement, State, law
from seatsim.rig.plant import Plant
from seatsim.schema.fields import param


@law("acceleration_driven", source="Savaresi, Silani and Bittanti 2005, J. Dyn. Syst. Meas. Control 127")
class AccelerationDriven(NamedTuple):
    """Acceleration-driven damping (ADD): `i_cmd = on` where `zs'' v > 0`, else `off`.

    The frame is the mass that the damper accelerates: of the two currents it takes the one with the smaller |zs''| at
    the next instant. Meant for frequencies above the resonance of the seat.
    """

    on: Annotated[float, param("A", "current that damps", low=0, high=100)] = 1.0
    off: Annotated[float, param("A", "current otherwise", low=0, high=100)] = 0.0

    def wanted_current(self, y: Measurement, state: State) -> float:
        """Return the commanded current in A."""
        return self.on if y.frame_acceleration * y.velocity > 0.0 else self.off


@law("skyhook_add", source="Savaresi and Spelta 2007, J. Dyn. Syst. Meas. Control 129:382")
class SkyhookAdd(NamedTuple):
    """Mixed skyhook and ADD: by the skyhook's rule at low frequencies, by that of ADD at high ones.

        a = zs' where zs''^2 <= (2 pi crossover)^2 zs'^2, else zs'';   i_cmd = on where a v > 0, else off

    A slow motion has little acceleration for its velocity, and is ruled by the skyhook.
    """

    crossover: Annotated[float, param("Hz", "frequency up to which skyhook rules", above=0, high=100)] = 2.0
    on: Annotated[float, param("A", "current that damps", low=0, high=100)] = 1.0
    off: Annotated[float, param("A", "current otherwise", low=0, high=100)] = 0.0

    def wanted_current(self, y: Measurement, state: State) -> float:
        """Return the commanded current in A."""
        slow = abs(y.frame_acceleration) <= 2.0 * math.pi * self.crossover * abs(y.frame_velocity)
        deciding = y.frame_velocity if slow else y.frame_acceleration
        return self.on if deciding * y.velocity > 0.0 else self.off


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
