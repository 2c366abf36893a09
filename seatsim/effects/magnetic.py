"""Effects of magnetism and heat on the damper's fluid: saturation, remanence, thermal fade."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from seatsim.compilation.jit import jit
from seatsim.effects.base import Form, effect
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.arrays import Array
from seatsim.schema.fields import param

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
    source="play operator (Krasnosel'skii and Pokrovskii 1989), two of them; magnetic after-effect",
    initial=(0.0, 0.0, 0.0),
    forms=(
        {"width": 0.01},
        {"width": 0.15},
        {"width": 0.01, "spread": 0.7},
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
    once, so that only a falling current is remembered. The after-effect adds `share (m - i)`, where m follows a rising
    current at once and falls as `m' = decay (i - m)`.
    """

    width: Annotated[float, param("A", "current that stays remembered", low=0, high=1)]
    spread: Annotated[float, param("-", "difference between the two plays", low=0, high=1)] = 0.0
    lift: Annotated[float, param("-", "share of the width added to a current that flows", low=0, high=1)] = 0.0
    decay: Annotated[float, param("1/s", "rate at which the memory fades", low=0, high=200)] = 0.0
    share: Annotated[float, param("-", "share of a current that fell that stays for a while", low=0, high=1)] = 0.0

    def yield_current(self, i: float, z: State) -> float:
        """Return the current that the yield force feels, in A."""
        after = self.share * max(z[2] - i, 0.0)
        if self.width <= 0.0:
            return i + after
        wide, narrow = self.width * (1.0 + self.spread), self.width * (1.0 - self.spread)
        felt = 0.5 * (_play(z[0], i, wide) + _play(z[1], i, narrow))
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
