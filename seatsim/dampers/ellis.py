"""A damper filled with an Ellis fluid, in series with a free play, beside the friction of its seal."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.compilation.jit import jit
from seatsim.dampers.base import damper
from seatsim.dampers.pieces import UTFSM, CurrentLaw, cubic
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.fields import param

V_REF = 0.1
"""m/s, the speed at which the power law has the force K(I)."""
LEAST_FORCE = 1.0
"""N; the force K(I) of a law that falls below it."""
LEAST_EXPONENT = 0.03
CORNER = 0.1
"""Half width of the rounded corners of the free play, over half of the play."""
MOST_STEPS = 30
ACCURACY = 1e-10


@jit
def beyond(y: float, half: float) -> float:
    """Return how far y in m lies beyond the play +-half; the corners are rounded by parabolas."""
    size, soft = abs(y) - half, CORNER * half
    if size <= -soft:
        return 0.0
    return math.copysign(size if size >= soft else (size + soft) ** 2 / (4.0 * soft), y)


@jit
def ellis_force(v: float, damping: float, height: float, exponent: float) -> float:
    """Return the force q in N at which `q / damping + V (|q| / height)^(1/exponent) sgn(q) = v`.

    Newton's method from above, where the left side is convex, so that it cannot overshoot. A fluid of no height flows
    freely: the force is 0.
    """
    speed, power_of = abs(v), 1.0 / exponent
    if speed == 0.0 or height == 0.0:
        return 0.0
    q = min(speed * damping, height * (speed / V_REF) ** exponent)
    for _ in range(MOST_STEPS):
        flow = V_REF * (q / height) ** power_of
        step = (q / damping + flow - speed) / (1.0 / damping + power_of * flow / q)
        q -= step
        if abs(step) < ACCURACY * q:
            break
    return math.copysign(q, v)


@jit
def series_force(d: Ellis, v: float, i: float, scaling: TemperatureScaling, stop: float) -> float:
    """Return the force q in N through fluid and play, where the stops of the play push with `stop` N."""
    play = d.c_y * scaling.viscous
    damping = 1.0 / (1.0 / (d.c_p * scaling.viscous) + 1.0 / play)
    height = max(cubic(d.K, i), LEAST_FORCE) * scaling.yield_force
    return ellis_force(v + stop / play, damping, height, max(d.p_a + d.p_b * i, LEAST_EXPONENT))


@damper(
    "ellis",
    source="composed by us from the fluid of Ellis (Bird, Armstrong and Hassager, Dynamics of Polymeric Liquids) and a"
    f" free play; {UTFSM}",
    initial=(0.0, 0.0),
    state="y, position in the free play in m; w, seal friction over its limit",
    max_speed=0.13,
    max_current=1.0,
    temperatures=(20.0, 20.0),
    confidence="derived",
)
class Ellis(NamedTuple):
    """Fluid whose viscous and power-law flows add, in series with an elastic stop that has a free play.

        F  = q + c0(I) v + f_s w + k0 x + f0
        v  = q / c_p + V (|q| / K(I))^(1/p(I)) sgn(q) + y',   V = 0.1 m/s
        y' = (q - k_s d(y)) / c_y,   w' = (v - |v| w) / x_s

    The first two terms of v are the flow of the fluid (Ellis), the third is motion in the play: d(y) is what of y lies
    beyond +-half. After a reversal the force falls, dwells at what c_y carries over a travel of 2 half, then rises
    again, as measured loops do. p(I) = p_a + p_b I. Small forces leak through c_p: after a stop the force relaxes at
    the rate k_s / (c_p + c_y). Below yield the slope of force over velocity is c_p, beyond it the force grows as the
    power p: a smooth bi-viscous damper whose hysteresis is that of the play and its stops.

    The fluid is published, the damper composed of it is ours. K and c0 are cubic laws, held beyond `law_end`. The
    defaults are derived by us from 20 measured sine tests, 25 mm 0.25 and 0.5 Hz, 5 mm 3 Hz, 2 mm 5 Hz at 0, 0.25,
    0.5, 0.75, 1 A. Held out, the tests of 10 mm 2 Hz and 5 mm 4 Hz are predicted, start and stop included, with a fit
    1 - rms error / standard deviation of 92.1 % on average over the currents. Valid to 0.13 m/s and 1 A. Temperature
    scales K and f_s (yield), c0, c_p, c_y (viscous), k_s and k0 (stiffness).
    """

    K: Annotated[CurrentLaw, param("N", "force K(I) of the power law at 0.1 m/s")] = (130.0, 685.0, 1396.0, -947.0)
    p_a: Annotated[float, param("-", "exponent of the power law at zero current", low=0.03, high=1)] = 0.168
    p_b: Annotated[float, param("1/A", "its rise with the current", low=-1, high=1)] = -0.091
    c0: Annotated[CurrentLaw, param("N s/m", "viscous damping c0(I) beside it")] = (136.0, 2513.0, 1771.0, -2120.0)
    c_p: Annotated[float, param("N s/m", "viscous damping below yield", above=0, low=1e3, high=1e8)] = 2.05e5
    c_y: Annotated[float, param("N s/m", "viscous damping within the free play", above=0, low=1e2, high=1e7)] = 2.68e4
    k_s: Annotated[float, param("N/m", "stiffness of its stops", above=0, low=1e4, high=5e7)] = 7.74e6
    half: Annotated[float, param("m", "half of the free play", above=0, low=1e-6, high=5e-3)] = 1.3e-4
    f_s: Annotated[float, param("N", "friction of the seal (Dahl)", above=0, low=0.1, high=1e4)] = 48.0
    x_s: Annotated[float, param("m", "travel over which it builds up", above=0, low=1e-5, high=1e-2)] = 1.4e-4
    k0: Annotated[float, param("N/m", "stiffness, of the gas accumulator")] = 690.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        stop = scaling.stiffness * self.k_s * beyond(z[0], self.half)
        q = series_force(self, v, held, scaling, stop)
        elastic = scaling.stiffness * self.k0 * x
        return (
            q + cubic(self.c0, held) * scaling.viscous * v + self.f_s * scaling.yield_force * z[1] + elastic + self.f0
        )

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (y', w')."""
        held = min(i, self.law_end)
        stop = scaling.stiffness * self.k_s * beyond(z[0], self.half)
        play = (series_force(self, v, held, scaling, stop) - stop) / (self.c_y * scaling.viscous)
        return (play, (v - abs(v) * z[1]) / self.x_s)
