"""Effects of the damper: gas spring, asymmetry, seal friction, free play, pre-yield hysteresis.

And those of magnetism and heat on its fluid: saturation, remanence, thermal fade.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.compilation.jit import jit
from seatsim.effects.base import FRICTIONS, Form, dahl_rate, effect
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling
from seatsim.schema.arrays import Array
from seatsim.schema.fields import param
from seatsim.schema.registry import specification_of

_SHORTEST = 2e-5
"""m; least travel over which a force returns at the end of a gap."""
_FASTEST = 1000.0
"""1/s; greatest rate at which a yield force builds up."""
_SWITCH = 0.01
"""m/s; width of the transition from compression to rebound, unless stated otherwise."""


@effect(
    "damper.gas_spring",
    source="accumulator of a monotube damper, linearised",
    forms=({"preload": 20.0}, Form({"preload": 20.0, "stiffness": 500.0}, sizes=2)),
)
class GasSpring(NamedTuple):
    """Preload and stiffness of the accumulator: `F + preload + stiffness x`."""

    preload: Annotated[float, param("N", "force at x = 0, positive against extension", low=-5e3, high=5e3)]
    stiffness: Annotated[float, param("N/m", "stiffness", low=0, high=1e5)] = 0.0

    def added_force(self, x: float, v: float, z: State) -> float:
        """Return the force in N beside the damper's."""
        return self.preload + self.stiffness * x


@effect(
    "damper.asymmetry",
    source="Yu et al. 2019 (Front. Mater. 6:227): rebound and compression differ",
    off={"speed": _SWITCH},
    forms=(
        Form({"viscous": 0.1, "yielding": 0.1}, sizes=2),
        Form({"viscous": 0.1, "yielding": 0.1, "speed": 0.03}, sizes=2),
        Form({"viscous": 0.1, "yielding": 0.1, "speed": 0.03, "offset": 0.5}, sizes=2),
        Form({"viscous": 0.1, "pulling": 0.1, "speed": 0.03, "offset": 0.5}, sizes=2),
    ),
)
class Asymmetry(NamedTuple):
    """Rebound stronger and compression weaker: both parts of the force times `1 + a (tanh(v / speed) + offset)`.

    With an offset of 1 only rebound differs from the nominal damper, with -1 only compression. In a hysteretic damper,
    whose yield force Fy reverses later than the speed, the sign of Fy may count instead: `Fy (1 + pulling (sgn Fy +
    offset))`.
    """

    viscous: Annotated[float, param("-", "a of the viscous part", low=-0.9, high=0.9)]
    yielding: Annotated[float, param("-", "a of the yield part", low=-0.9, high=0.9)] = 0.0
    speed: Annotated[float, param("m/s", "speed over which one turns into the other", above=0, high=1)] = _SWITCH
    offset: Annotated[float, param("-", "mean of both sides over a", low=-1, high=1)] = 0.0
    pulling: Annotated[float, param("-", "a of the yield part, by its own sign", low=-0.9, high=0.9)] = 0.0

    def yield_force(self, force: float, z: State) -> float:
        """Return the yield force in N, given that of a damper symmetric in both directions."""
        return force * (1.0 + self.pulling * self.offset) + self.pulling * abs(force)

    def part_scaling(self, scaling: TemperatureScaling, v: float, z: State) -> TemperatureScaling:
        """Return the factors of the damper's parts at a speed."""
        if self.viscous == 0.0 and self.yielding == 0.0:
            return scaling
        side = math.tanh(v / self.speed) + self.offset
        viscous = scaling.viscous * (1.0 + self.viscous * side)
        return TemperatureScaling(viscous, scaling.stiffness, scaling.yield_force * (1.0 + self.yielding * side))


@effect("damper.seal_friction", source="Coulomb's law; with presliding Dahl 1968", initial=(0.0,), forms=FRICTIONS)
class SealFriction(NamedTuple):
    """Rate-independent friction inside the damper, at every current, seen by the load cell.

    `F + force z / (1 + lubrication |v|)` with `z' = v (1 - z sgn v) / presliding`; without presliding set-valued,
    `F + force sgn(v)`. Without a load cell it is `suspension.friction`.
    """

    force: Annotated[float, param("N", "friction of seals and bearings", low=0, high=2e3)]
    presliding: Annotated[float, param("m", "travel over which friction builds up; 0: none", low=0, high=0.02)] = 0.0
    lubrication: Annotated[float, param("s/m", "fall of friction with speed (Stribeck)", low=0, high=200)] = 0.0

    def stiction(self, z: State) -> float:
        """Return the limit of the set-valued friction in N."""
        return self.force if self.presliding <= 0.0 else 0.0

    def added_force(self, x: float, v: float, z: State) -> float:
        """Return the friction in N that builds up over a travel."""
        return self.force * z[0] / (1.0 + self.lubrication * abs(v)) if self.presliding > 0.0 else 0.0

    def rates(self, x: float, v: float, u: float, i: float, demanded: float, target: float, z: State) -> State:
        """Return z'."""
        return (dahl_rate(self.presliding, v, z[0]),)


def _mount(gap: float, softness: float) -> Form:
    """Return a free play behind which the mount yields: at once or, where air is trapped, gradually."""
    return Form({"gap": gap, "stiffness": 3e6}, {"softness": softness}, within={"stiffness": (1e6, 1e9)})


@effect(
    "damper.free_play",
    source="backlash: the damper's end stays while the gap is crossed; behind it a mount that yields, or trapped air",
    initial=(0.0,),
    off={"softness": 0.3},
    forms=(
        *({"gap": gap} for gap in (1e-4, 3e-4, 1e-3, 2e-3)),
        {"gap": 3e-4, "softness": 0.9},
        *(_mount(gap, softness=0.1) for gap in (3e-5, 1e-4, 3e-4, 8e-4)),
        *(_mount(gap, softness=1.0) for gap in (1e-4, 4e-4)),
        *(Form({"gap": 1e-4 * 1.32**k}, {"softness": 0.05, "turning": 3e-4}) for k in range(12)),
    ),
)
class FreePlay(NamedTuple):
    """Backlash at the mount or trapped air: after each reversal a travel `gap` without force.

    With g the position in the gap, `g' = v - u` where u is the speed of the piston. Without stiffness the mount is
    rigid: the damper transmits the share h of its force and `u = h v`. With s = 2 g sgn(F) / gap, h rises smoothly from
    0 at `s = 1 - 2 softness` to 1 at s = 1, so a reversal of the force opens the gap. With `turning` a reversal of the
    motion opens it, and the damper keeps its state while it transmits nothing: `h = (1 + w) h+ / 2 + (1 - w) h- / 2`,
    `w = tanh(v / turning)`, with h+ and h- for the two signs of s. A small `turning` makes the force chatter in an
    unpredictable way where the damper is at rest. With stiffness the force is that of the mount, `S = stiffness g (1 -
    (1 + |2 g / gap|^p)^(-1 / p))` with `p = 2 / softness`, which is `stiffness (|g| - gap / 2) sgn g` far outside the
    gap, and u is the speed at which the damper's force is S. Trapped air, of softness 1, carries gradually.
    """

    gap: Annotated[float, param("m", "travel without force after a reversal", low=0, high=0.02)]
    softness: Annotated[float, param("-", "share of the gap over which the force returns", above=0, high=1)] = 0.3
    stiffness: Annotated[float, param("N/m", "stiffness of the mount; 0: rigid", low=0, high=1e9)] = 0.0
    turning: Annotated[float, param("m/s", "speed from which motion opens the gap; 0: force", low=0, high=1)] = 0.0

    def transmitted_share(self, h: float, v: float, demanded: float, z: State) -> float:
        """Return the transmitted share h of speed and force; `demanded` [N] is the force without the gap."""
        if self.gap <= 0.0:
            return h
        if self.turning <= 0.0:
            return h * _transmitted_share(self.gap, self.softness, demanded, z[0])
        w = math.tanh(v / self.turning)
        up = _transmitted_share(self.gap, self.softness, 1.0, z[0])
        down = _transmitted_share(self.gap, self.softness, -1.0, z[0])
        return 0.5 * h * ((1.0 + w) * up + (1.0 - w) * down)

    def mount_stiffness(self, z: State) -> float:
        """Return the stiffness in N/m of the mount, 0 where it is rigid."""
        return self.stiffness

    def mount_force(self, force: float, z: State) -> float:
        """Return S in N, NaN where the mount is rigid."""
        if self.stiffness <= 0.0:
            return force
        if self.gap <= 0.0:
            return self.stiffness * z[0]
        power = 2.0 / self.softness
        share: float = 1.0 - (1.0 + abs(2.0 * z[0] / self.gap) ** power) ** (-1.0 / power)
        return self.stiffness * z[0] * share

    def rates(self, x: float, v: float, u: float, i: float, demanded: float, target: float, z: State) -> State:
        """Return g'."""
        return (v - u,)


@jit
def _transmitted_share(gap: float, softness: float, demanded: float, g: float) -> float:
    """Return h, the share of speed and force that the gap transmits."""
    missing = 0.5 * gap - g * math.copysign(1.0, demanded)
    s = min(1.0, max(0.0, 1.0 - missing / max(softness * gap, _SHORTEST)))
    return s * s * (3.0 - 2.0 * s)


def _without_state(damper: object) -> bool:
    """Whether a damper has no hysteresis of its own."""
    return not specification_of(type(damper)).initial


@effect(
    "damper.preyield_hysteresis",
    source="yield force that relaxes over a travel (Dahl 1968) or a time (Maxwell), or follows a lagging speed",
    initial=(0.0, 0.0),
    off={"share": 1.0},
    forms=(
        {"travel": 3e-4},
        {"travel": 3e-4, "share": 0.3},
        {"lag": 1e-3},
        {"lag": 3e-3, "share": 0.3},
        {"behind": 1e-3},
        {"behind": 3e-3, "share": 0.3},
    ),
    suits=_without_state,
)
class PreyieldHysteresis(NamedTuple):
    """Yield force that builds up over a travel, or with a lag: a loop at low speed.

    Of the yield force with its nominal shape s(u) at the speed u of the piston, -1 to 1, the `share` is replaced by z,
    which follows it: `z' = (|u| / travel + 1 / lag) (s(u) - z)`, where a travel or lag of zero is left out, at most at
    1000 1/s; or by s(w), where w lags the speed, `w' = (u - w) / behind`.
    """

    travel: Annotated[float, param("m", "travel over which the yield force builds up", low=0, high=0.02)]
    lag: Annotated[float, param("s", "time over which it builds up", low=0, high=0.05)] = 0.0
    behind: Annotated[float, param("s", "time by which its speed lags", low=0, high=0.05)] = 0.0
    share: Annotated[float, param("-", "share of the yield force that builds up", low=0, high=2)] = 1.0

    def yield_speed(self, v: float, z: State) -> float:
        """Return w in m/s."""
        return z[1] if self.behind > 0.0 else v

    def yield_shape(self, shape: float, target: float, late: float, z: State) -> float:
        """Return the share of the yield force, NaN where the damper's own law holds."""
        if self.travel <= 0.0 and self.lag <= 0.0 and self.behind <= 0.0:
            return shape
        built = late if self.behind > 0.0 else z[0]
        return self.share * built + (1.0 - self.share) * target

    def rates(self, x: float, v: float, u: float, i: float, demanded: float, target: float, z: State) -> State:
        """Return (z', w')."""
        rate = abs(u) / self.travel if self.travel > 0.0 else 0.0
        if self.lag > 0.0:
            rate += 1.0 / self.lag
        following = (u - z[1]) / max(self.behind, 1.0 / _FASTEST) if self.behind > 0.0 else 0.0
        return (rate / (1.0 + rate / _FASTEST) * (target - z[0]), following)


_FOLLOWING = 500.0
"""1/s; rate at which a play follows the current that drags it along."""
_SMOOTHING = 2.0
"""s; time over which a thermocouple's reading is averaged before its slope is taken."""


@effect(
    "damper.magnetic_saturation",
    source="Froehlich's law, generalised by an exponent",
    off={"sharpness": 2.0},
    forms=({"bend": 0.5}, {"bend": 0.8, "sharpness": 3.0}),
)
class MagneticSaturation(NamedTuple):
    """Yield force that grows ever less with current: it feels `i / (1 + (bend i)^sharpness)^(1 / sharpness)`."""

    bend: Annotated[float, param("1/A", "one over the current at which the force saturates", low=0, high=10)]
    sharpness: Annotated[float, param("-", "exponent; 1 is Froehlich's law", low=0.5, high=12)] = 2.0

    def yield_current(self, i: float, z: State) -> float:
        """Return the current that the yield force feels, in A."""
        if self.bend <= 0.0 or i <= 0.0:
            return i
        felt: float = i / (1.0 + (self.bend * i) ** self.sharpness) ** (1.0 / self.sharpness)
        return felt


@effect(
    "damper.remanence",
    source="play operators (Krasnosel'skii, Pokrovskii 1989), reversible share (Jiles, Atherton 1986), after-effect",
    initial=(0.0, 0.0, 0.0),
    forms=(
        {"width": 0.01},
        {"width": 0.15},
        {"width": 0.05, "reversible": 0.5, "spread": 0.5},
        {"width": 0.01, "lift": 0.5},
        {"width": 0.15, "lift": 0.5},
        {"width": 0.02, "decay": 1.0},
        {"width": 0.1, "decay": 20.0},
        {"share": 0.1, "decay": 2.0},
    ),
    shown_by_fall=True,
)
class Remanence(NamedTuple):
    """Yield force that remembers past current: it feels the mean of two plays of the current, and an after-effect.

    The plays' half-widths are `width (1 +- spread)`: after a reversal the current has to move by more than that before
    the magnetisation follows, and meanwhile the magnetisation creeps towards the current at the rate `decay`. `lift`
    raises the play's output: at 0 it lags a rising and a falling current alike, at 1 it follows a rising current at
    once, so that only a falling current is remembered. A `reversible` share of the plays' magnetisation follows the
    current at once. The after-effect adds `share (m - i)`, where m follows a rising current at once and falls as
    `m' = decay (i - m)`.
    """

    width: Annotated[float, param("A", "current that stays remembered", low=0, high=1)]
    spread: Annotated[float, param("-", "difference between the two plays", low=0, high=1)] = 0.0
    lift: Annotated[float, param("-", "share of the width added to a current that flows", low=0, high=1)] = 0.0
    decay: Annotated[float, param("1/s", "rate at which the memory fades", low=0, high=200)] = 0.0
    share: Annotated[float, param("-", "share of a current that fell that stays for a while", low=0, high=1)] = 0.0
    reversible: Annotated[float, param("-", "share of the plays that follows the current at once", low=0, high=1)] = 0.0

    def yield_current(self, i: float, z: State) -> float:
        """Return the current that the yield force feels, in A."""
        after = self.share * max(z[2] - i, 0.0)
        if self.width <= 0.0:
            return i + after
        wide, narrow = self.width * (1.0 + self.spread), self.width * (1.0 - self.spread)
        plays = 0.5 * (_play(z[0], i, wide) + _play(z[1], i, narrow))
        felt = plays + self.reversible * (i - plays)
        return felt + self.lift * min(self.width, max(felt, 0.0)) + after

    def rates(self, x: float, v: float, u: float, i: float, demanded: float, target: float, z: State) -> State:
        """Return the rates of the two plays and of the current that fell."""
        fading = (self.decay if z[2] > i else _FOLLOWING) * (i - z[2])
        if self.width <= 0.0:
            return (0.0, 0.0, fading)
        wide, narrow = self.width * (1.0 + self.spread), self.width * (1.0 - self.spread)
        return (
            _FOLLOWING * (_play(z[0], i, wide) - z[0]) + self.decay * (i - z[0]),
            _FOLLOWING * (_play(z[1], i, narrow) - z[1]) + self.decay * (i - z[1]),
            fading,
        )


@jit
def _play(z: float, i: float, width: float) -> float:
    """Return the play's output: what it was, unless the current is further off than the width."""
    return min(i + width, max(i - width, z))


@effect(
    "damper.thermal_fade",
    source="exponential factors of Yu et al. 2019 eqs 9-11; thermocouple as a first-order lag",
    forms=(
        Form({"viscous": 0.004, "yielding": 0.004}, sizes=2),
        Form({"viscous": 0.004, "yielding": 0.004, "lag": 5.0}, sizes=2),
    ),
)
class ThermalFade(NamedTuple):
    """Viscous and yield force that fall as the fluid warms.

    Their factors are `exp(-viscous (T - T0))` and `exp(-yielding (T - T0))`; T0 is the reference of the damper's
    temperature factors. The thermocouple follows the fluid with a lag: the fluid is at `T = T_c + lag dT_c/dt + rise`.
    """

    viscous: Annotated[float, param("1/K", "fade of the viscous force", low=-0.02, high=0.05)]
    yielding: Annotated[float, param("1/K", "fade of the yield force", low=-0.02, high=0.05)] = 0.0
    lag: Annotated[float, param("s", "lag of the thermocouple behind the fluid", low=0, high=600)] = 0.0
    rise: Annotated[float, param("K", "what the fluid is warmer than its thermocouple", low=-50, high=150)] = 0.0

    def factors(self, factors: TemperatureFactors) -> TemperatureFactors:
        """Return the damper's temperature factors with the fade."""
        return factors._replace(viscous=factors.viscous - self.viscous, yield_force=factors.yield_force - self.yielding)

    def temperature(self, step: float, values: Array) -> Array:
        """Return the temperature of the fluid in degC out of that of the thermocouple, shape (N,)."""
        if self.lag <= 0.0:
            return values + self.rise
        # Takes its time to load, and few rigs have the effect.
        from scipy.ndimage import uniform_filter1d

        smooth = uniform_filter1d(uniform_filter1d(values, round(_SMOOTHING / step)), round(_SMOOTHING / step))
        return smooth + self.lag * np.gradient(smooth, step) + self.rise
