"""Effects of the suspension: friction in the linkage, end-stop buffers, a progressive spring."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.effects.base import effect
from seatsim.fields import param
from seatsim.kernel.rig import Rig


@effect("suspension.friction", source="Coulomb's law, set-valued at rest")
class Friction(NamedTuple):
    """Rate-independent friction in the linkage, not seen by the damper's load cell.

    `f = force sgn(v)`; at v = 0 whatever holds the suspension, up to `force`.
    """

    force: Annotated[float, param("N", "friction of the linkage", low=0, high=1e4)]

    def change(self, rig: Rig) -> Rig:
        """Add the friction to what the linkage has."""
        s = rig.suspension
        return rig._replace(suspension=s._replace(friction=s.friction + self.force))


@effect("suspension.progressive_spring", source="first odd term of a hardening spring's series")
class ProgressiveSpring(NamedTuple):
    """Stiffness that grows with travel: `f = kf x (1 + rise x^2)`."""

    rise: Annotated[float, param("1/m^2", "relative rise of the spring force per squared travel", low=0, high=1e6)]

    def change(self, rig: Rig) -> Rig:
        """Add the cubic term of the spring force."""
        s = rig.suspension
        return rig._replace(suspension=s._replace(cubic=s.cubic + self.rise * rig.plant.suspension_stiffness))


@effect("suspension.end_stop", source="unilateral spring with Hunt-Crossley damping, k d (1 + c d')")
class EndStop(NamedTuple):
    """Buffers at the ends of the travel.

    `f = stiffness d (1 + damping d')`, never pulling, where d is the depth beyond `low` or `high`.
    """

    low: Annotated[float, param("m", "travel at which the lower buffer is touched", low=-1, high=0)]
    high: Annotated[float, param("m", "travel at which the upper buffer is touched", low=0, high=1)]
    stiffness: Annotated[float, param("N/m", "stiffness of a buffer", low=0, high=1e7)] = 60000.0
    damping: Annotated[float, param("s/m", "Hunt-Crossley damping", low=0, high=100)] = 0.5

    def change(self, rig: Rig) -> Rig:
        """Put buffers at both ends."""
        stops = {"stop_low": self.low, "stop_high": self.high}
        stops |= {"stop_stiffness": self.stiffness, "stop_damping": self.damping}
        return rig._replace(suspension=rig.suspension._replace(**stops))
