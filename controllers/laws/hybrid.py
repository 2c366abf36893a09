"""Groundhook, and the hybrid of skyhook and groundhook.

A seat's floor stands for the unsprung mass of the car literature. Its motion is given, so that no damper can calm it:
what groundhook does for a seat is to hold the frame to the floor, which keeps travel small.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.rig.control import Measurement, State, law
from seatsim.schema.fields import param


@law("groundhook", source="Valasek, Novak, Sika and Vaculin 1997, Veh. Syst. Dyn. 27:289; the floor as the wheel")
class Groundhook(NamedTuple):
    """Groundhook: wanted force `Fd = -damping z0'`, with the floor's velocity `z0' = zs' - v`."""

    damping: Annotated[float, param("N s/m", "groundhook damping", low=0, high=1e6)] = 1000.0

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return -self.damping * (y.frame_velocity - y.velocity)


@law("hybrid", source="Goncalves and Ahmadian 2003, Shock and Vibration 10:59; the floor as the wheel")
class Hybrid(NamedTuple):
    """Hybrid: wanted force `Fd = damping (share zs' - (1 - share) z0')`.

    `share` 1 is skyhook, 0 is groundhook, and 0.5 is a viscous damper of `damping / 2`.
    """

    damping: Annotated[float, param("N s/m", "damping of both hooks", low=0, high=1e6)] = 2000.0
    share: Annotated[float, param("-", "share of skyhook", low=0, high=1)] = 0.8

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        floor_velocity = y.frame_velocity - y.velocity
        return self.damping * (self.share * y.frame_velocity - (1.0 - self.share) * floor_velocity)
