"""Effects of the damper on its force: gas spring, asymmetry, seal friction, free play, pre-yield hysteresis."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

from seatsim.effects.base import effect
from seatsim.effects.laws import State, dahl_rate
from seatsim.fields import param
from seatsim.jit import jit
from seatsim.registry import card_of
from seatsim.temperature import Heat

SWITCH = 0.01
"""m/s; scale of speed over which rebound turns into compression."""


@effect(
    "damper.gas_spring",
    source="accumulator of a monotube damper, linearised",
    starts=({"preload": 20.0, "stiffness": 500.0},),
)
class GasSpring(NamedTuple):
    """Preload and stiffness of the accumulator: `F + preload + stiffness x`."""

    preload: Annotated[float, param("N", "force at x = 0, positive against extension", low=-1e4, high=1e4)]
    stiffness: Annotated[float, param("N/m", "stiffness", low=0, high=1e6)] = 0.0

    def added_force(self, x: float, v: float, z: State) -> float:
        """Return the force in N beside the damper's."""
        return self.preload + self.stiffness * x


@effect(
    "damper.asymmetry",
    source="Yu et al. 2019 (Front. Mater. 6:227): rebound and compression differ",
    starts=({"viscous": 0.1, "yielding": 0.1},),
)
class Asymmetry(NamedTuple):
    """Rebound stronger and compression weaker: both parts of the force times `1 + a tanh(v / 1 cm/s)`."""

    viscous: Annotated[float, param("-", "a of the viscous part", low=-0.9, high=0.9)]
    yielding: Annotated[float, param("-", "a of the yield part", low=-0.9, high=0.9)] = 0.0

    def conditioned(self, heat: Heat, v: float, z: State) -> Heat:
        """Return the factors of the damper's parts at a speed."""
        if self.viscous == 0.0 and self.yielding == 0.0:
            return heat
        side = math.tanh(v / SWITCH)
        viscous, yielding = heat.viscous * (1.0 + self.viscous * side), heat.yielding * (1.0 + self.yielding * side)
        return Heat(viscous, heat.stiffness, yielding)


@effect(
    "damper.seal_friction",
    source="Coulomb's law; with presliding Dahl 1968",
    initial=(0.0,),
    starts=({"force": 20.0, "presliding": 2e-4}, {"force": 20.0, "presliding": 1e-3}),
)
class SealFriction(NamedTuple):
    """Rate-independent friction inside the damper, at every current, seen by the load cell.

    `F + force z` with `z' = v (1 - z sgn v) / presliding`; without presliding set-valued, `F + force sgn(v)`.
    """

    force: Annotated[float, param("N", "friction of seals and bearings", low=0, high=1e4)]
    presliding: Annotated[float, param("m", "travel over which friction builds up; 0: none", low=0, high=0.02)] = 0.0

    def stiction(self, z: State) -> float:
        """Return the limit of the set-valued friction in N."""
        return self.force if self.presliding <= 0.0 else 0.0

    def added_force(self, x: float, v: float, z: State) -> float:
        """Return the friction in N that builds up over a travel."""
        return self.force * z[0] if self.presliding > 0.0 else 0.0

    def rates(self, x: float, v: float, i: float, z: State) -> State:
        """Return z'."""
        return (dahl_rate(self.presliding, v, z[0]),)


@effect(
    "damper.free_play",
    source="backlash: the damper's end stays while the gap is crossed",
    initial=(0.0,),
    off={"softness": 0.3},
    starts=({"gap": 1e-3}, {"gap": 2e-3, "softness": 0.8}),
)
class FreePlay(NamedTuple):
    """Backlash at the mount or trapped air: after each reversal a travel `gap` without force.

    With u = 2 g tanh(v / 1 cm/s) / gap the damper gets the share h(u) of the speed and hands on the share h of its
    force, h rising smoothly from 0 at `u = 1 - 2 softness` to 1 at u = 1; `g' = v (1 - h)`.
    """

    gap: Annotated[float, param("m", "travel without force after a reversal", low=0, high=0.05)]
    softness: Annotated[float, param("-", "share of the gap over which the force returns", above=0, high=1)] = 0.3

    def engaged(self, h: float, v: float, z: State) -> float:
        """Return the share of the speed, and of the force, that gets through."""
        return h * _passed(self.gap, self.softness, v, z[0]) if self.gap > 0.0 else h

    def rates(self, x: float, v: float, i: float, z: State) -> State:
        """Return g'."""
        return (v * (1.0 - _passed(self.gap, self.softness, v, z[0])) if self.gap > 0.0 else 0.0,)


@jit
def _passed(gap: float, softness: float, v: float, g: float) -> float:
    """Return h, the share of a speed that gets through the gap."""
    u = 2.0 * g * math.tanh(v / SWITCH) / gap
    s = min(1.0, max(0.0, 1.0 - 0.5 * (1.0 - u) / softness))
    return s * s * (3.0 - 2.0 * s)


def _without_state(damper: Any) -> bool:
    """Whether a damper has no hysteresis of its own."""
    return not card_of(type(damper)).initial


@effect(
    "damper.preyield_hysteresis",
    source="Bouc-Wen form of the yield force (Wen 1976); lag after Kwok et al. 2006",
    initial=(0.0, 0.0),
    off={"sharpness": 1.0},
    starts=({"travel": 5e-4}, {"travel": 5e-4, "sharpness": 2.0}, {"lag": 3e-3}),
    suits=_without_state,
)
class PreyieldHysteresis(NamedTuple):
    """Yield force that builds up over a travel, or follows the speed with a lag: a loop at low speed.

    The yield force is its full size times z, `z' = v / travel (1 - |z|^sharpness (1 + sgn(v z)) / 2)`; without travel it
    is taken at the speed u, `u' = (v - u) / lag`.
    """

    travel: Annotated[float, param("m", "travel before the fluid yields", low=0, high=0.02)]
    sharpness: Annotated[float, param("-", "exponent of yielding", low=1, high=10)] = 1.0
    lag: Annotated[float, param("s", "lag of the yield force behind the speed", low=0, high=0.1)] = 0.0

    def yield_shape(self, shape: float, z: State) -> float:
        """Return the share of the yield force, NaN where the damper's own law holds."""
        return z[0] if self.travel > 0.0 else shape

    def yield_speed(self, v: float, z: State) -> float:
        """Return the speed that the yield force follows, in m/s."""
        return z[1] if self.lag > 0.0 else v

    def rates(self, x: float, v: float, i: float, z: State) -> State:
        """Return (z', u')."""
        lagging = (v - z[1]) / self.lag if self.lag > 0.0 else 0.0
        if self.travel <= 0.0:
            return (0.0, lagging)
        resistance = abs(z[0]) ** self.sharpness if v * z[0] > 0.0 else 0.0
        return (v / self.travel * (1.0 - resistance), lagging)
