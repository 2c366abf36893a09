"""Effects of the suspension: friction in the linkage, end-stop buffers, a progressive spring."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.effects.base import Form, effect
from seatsim.effects.laws import FRICTIONS, buffer, dahl_rate
from seatsim.kernel.rig import SeatMotion
from seatsim.rig.plant import Plant
from seatsim.rig.state import State
from seatsim.schema.fields import param


@effect(
    "suspension.friction",
    source="Coulomb's law; with presliding Dahl 1968",
    initial=(0.0,),
    forms=FRICTIONS,
)
class Friction(NamedTuple):
    """Rate-independent friction in the linkage, not seen by the damper's load cell.

    `f = force z / (1 + lubrication |v|)` with `z' = v (1 - z sgn v) / presliding`. Without presliding f is set-valued:
    `force sgn(v)`, and at v = 0 whatever holds the suspension, up to `force`.
    """

    force: Annotated[float, param("N", "friction of the linkage", low=0, high=2e3)]
    presliding: Annotated[float, param("m", "travel over which friction builds up; 0: none", low=0, high=0.02)] = 0.0
    lubrication: Annotated[float, param("s/m", "fall of friction with speed (Stribeck)", low=0, high=200)] = 0.0

    def linkage_friction(self, z: State) -> float:
        """Return the set-valued friction in N."""
        return self.force if self.presliding <= 0.0 else 0.0

    def suspension_force(self, plant: Plant, x: float, v: float, z: State) -> float:
        """Return the friction in N that builds up over a travel."""
        return self.force * z[0] / (1.0 + self.lubrication * abs(v)) if self.presliding > 0.0 else 0.0

    def rates(self, plant: Plant, motion: SeatMotion, z: State) -> State:
        """Return z'."""
        return (dahl_rate(self.presliding, motion.v, z[0]),)


@effect(
    "suspension.progressive_spring",
    source="odd terms of a hardening spring's series; a helper spring that comes to bear",
    forms=(
        {"rise": 300.0},
        {"rise": 4000.0},
        {"rise": 300.0, "skew": 1.0},
        {"rise": 4000.0, "skew": 1.0},
        {"helper": 0.5, "reach": 0.01},
        {"helper": 4.0, "reach": 0.01},
    ),
)
class ProgressiveSpring(NamedTuple):
    """Stiffness that grows with travel: `f = kf x (1 + skew x + rise x^2)`, and a helper spring beside it.

    The helper adds `kf helper (sqrt(x^2 + reach^2) - reach) sgn x`: nothing at small travel, `helper` times the
    stiffness beyond the travel `reach`.
    """

    rise: Annotated[float, param("1/m^2", "rise of the spring force per squared travel", low=0, high=1e5)] = 0.0
    skew: Annotated[float, param("1/m", "relative rise per travel, in extension only", low=-100, high=100)] = 0.0
    helper: Annotated[float, param("-", "stiffness of a helper spring over the spring's", low=0, high=100)] = 0.0
    reach: Annotated[float, param("m", "travel over which it comes to bear", low=0, high=0.5)] = 0.0

    def suspension_force(self, plant: Plant, x: float, v: float, z: State) -> float:
        """Return the spring force beyond `kf x` in N."""
        helper = math.copysign(self.helper * (math.sqrt(x * x + self.reach * self.reach) - self.reach), x)
        return plant.suspension_stiffness * (x * x * (self.skew + self.rise * x) + helper)


@effect(
    "suspension.end_stop",
    source="unilateral spring with Hunt-Crossley damping, k d (1 + c d')",
    off={"low": -1.0, "high": 1.0, "power": 1.0},
    forms=(
        Form(
            {"low": -0.012, "high": 0.012, "stiffness": 10000.0, "damping": 0.5, "power": 1.0},
            within={"stiffness": (5000.0, 1e6)},
        ),
    ),
)
class EndStop(NamedTuple):
    """Buffers at the ends of the travel.

    `f = stiffness d (d / 10 mm)^(power - 1) (1 + damping d')`, never pulling, where d is the depth beyond `low` or
    `high`; power 1 is a linear buffer. A diagnosis takes one that is softer than a seat's spring for a helper spring.
    """

    low: Annotated[float, param("m", "travel at which the lower buffer is touched", low=-1, high=0)]
    high: Annotated[float, param("m", "travel at which the upper buffer is touched", low=0, high=1)]
    stiffness: Annotated[float, param("N/m", "stiffness of a buffer", low=0, high=1e7)] = 60000.0
    damping: Annotated[float, param("s/m", "Hunt-Crossley damping", low=0, high=100)] = 0.5
    power: Annotated[float, param("-", "exponent of the buffer's law", low=1, high=3)] = 1.0

    def plant(self, plant: Plant) -> Plant:
        """Return the seat with its travel between the buffers, beyond which its end stops are met."""
        return plant._replace(travel=(self.low, self.high)) if self.stiffness > 0.0 else plant

    def suspension_force(self, plant: Plant, x: float, v: float, z: State) -> float:
        """Return the force of the buffers in N, positive against extension."""
        if self.stiffness <= 0.0:
            return 0.0
        if x > self.high:
            return buffer(self.stiffness, self.damping, self.power, x - self.high, v)
        if x < self.low:
            return -buffer(self.stiffness, self.damping, self.power, self.low - x, -v)
        return 0.0
