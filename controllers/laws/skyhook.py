"""Skyhook laws: the damper acts as if it stood between the seat frame and the sky, where it can.

With groundhook, and the hybrid of both. A seat's floor stands for the unsprung mass of the car literature. Its motion
is given, so that no damper can calm it: what groundhook does for a seat is to hold the frame to the floor, which keeps
travel small. The force of the no-jerk skyhook goes to zero with the suspension's velocity, so that it does not jump
where the clip lets go.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.rig.control import Measurement, State, law
from seatsim.schema.fields import param

SOURCE = "Karnopp, Crosby and Harwood 1974, J. Eng. Industry 96:619"


@law("on_off_skyhook", source=SOURCE)
class OnOffSkyhook(NamedTuple):
    """On-off skyhook: `i_cmd = on` where `zs' (zs' - z0') > 0`, else `off`.

    zs' is the absolute velocity of the seat frame. The command switches at the controller's samples only.
    """

    on: Annotated[float, param("A", "current that damps", low=0, high=100)] = 1.0
    off: Annotated[float, param("A", "current otherwise", low=0, high=100)] = 0.0

    def wanted_current(self, y: Measurement, state: State) -> float:
        """Return the commanded current in A."""
        return self.on if y.frame_velocity * y.velocity > 0.0 else self.off


@law("skyhook", source=SOURCE)
class Skyhook(NamedTuple):
    """Continuous skyhook: wanted force `Fd = damping zs'`, of which the inverse delivers what dissipates."""

    damping: Annotated[float, param("N s/m", "skyhook damping", low=0, high=1e6)] = 2000.0

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return self.damping * y.frame_velocity


@law(
    "no_jerk_skyhook",
    source="Ahmadian, Song and Southward 2004, J. Vib. Acoust. 126:580, and US patent 6,115,658, which leave the shape"
    " of the factor open; |v| is chosen here",
)
class NoJerkSkyhook(NamedTuple):
    """No-jerk skyhook: wanted force `Fd = gain zs' |v|`, continuous where v changes its sign."""

    gain: Annotated[float, param("N s^2/m^2", "force over absolute times relative velocity", low=0, high=1e8)] = 20000.0

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return self.gain * y.frame_velocity * abs(y.velocity)


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
