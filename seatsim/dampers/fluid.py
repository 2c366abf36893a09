"""Dampers read from their fluid: an Ellis fluid with a free play, lumped hydraulics, yield as a phase transition."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.dampers import State, TemperatureScaling, jit, param
from seatsim.dampers.pieces import SETTLING, CurrentLaw, between, cubic, utfsm_damper

_V_REF = 0.1
"""m/s, the speed at which the power law has the force K(I)."""
_LEAST_FORCE = 1.0
"""N; the force K(I) of a law that falls below it."""
_LEAST_EXPONENT = 0.03
_CORNER = 0.1
"""Half width of the rounded corners of the free play, over half of the play."""
_MOST_STEPS = 30
_ACCURACY = 1e-10


@jit
def beyond(y: float, half: float) -> float:
    """Return how far y in m lies beyond the play +-half; the corners are rounded by parabolas."""
    size, soft = abs(y) - half, _CORNER * half
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
    q = min(speed * damping, height * (speed / _V_REF) ** exponent)
    for _ in range(_MOST_STEPS):
        flow = _V_REF * (q / height) ** power_of
        step = (q / damping + flow - speed) / (1.0 / damping + power_of * flow / q)
        q -= step
        if abs(step) < _ACCURACY * q:
            break
    return math.copysign(q, v)


@jit
def series_force(d: Ellis, v: float, i: float, scaling: TemperatureScaling, stop: float) -> float:
    """Return the force q in N through fluid and play, where the stops of the play push with `stop` N."""
    play = d.c_y * scaling.viscous
    damping = 1.0 / (1.0 / (d.c_p * scaling.viscous) + 1.0 / play)
    height = max(cubic(d.K, i), _LEAST_FORCE) * scaling.yield_force
    return ellis_force(v + stop / play, damping, height, max(d.p_a + d.p_b * i, _LEAST_EXPONENT))


@utfsm_damper(
    "ellis",
    initial=(0.0, 0.0),
    state="y, position in the free play in m; w, seal friction over its limit",
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

    Source: composed by us from the fluid of Ellis (Bird, Armstrong and Hassager, Dynamics of Polymeric
    Liquids) and a free play
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


@utfsm_damper(
    "hydro_mechanical",
    initial=(0.0, 0.0),
    state="V, volume in m^3 that the chambers give; Q, flow in m^3/s through the gap",
    confidence="reading",
    fixed=("A",),
)
class HydroMechanical(NamedTuple):
    """Piston of area A between chambers of compliance C, joined by a gap with inertance L and resistance R.

        V' = A v - Q,   p = V / C,   F = A p + k_g x + fs sgn(v) + f0
        L Q' = p - R(I) Q - P_y(I) tanh(Q / Q_r)

    p is the difference of the chambers' pressures. The form is vaguely recalled, this reading ours. For a flat gap
    of width w, height h and length l, R = 12 mu l / (w h^3), P_y = 2 to 3 l tau_y / h, L = rho l / (w h). Q_r
    regularises the sign of the yield pressure. To keep the flow from settling faster than tau =
    `pieces.SETTLING`, L counts as L + tau d(R Q + P_y tanh)/dQ (ours): an inertance that depends on the flow
    still stores what it takes, so the model stays passive, and motion slow against tau does not feel it. L scales
    with the viscous factor of the temperature (ours), so that three equal factors scale the whole force. The
    seal's friction fs is set-valued; k_g is the accumulator's. R and P_y are cubic laws, held beyond `law_end`.

    The current acts through the flow, so that the force at a given state does not depend on it: an inverse needs
    another model to assume. A is geometry, which the force does not tell from the other parameters. The
    defaults are derived by us (see `pieces.UTFSM`), with A, C, L and fs chosen; rms error 22, 40, 71, 95,
    136 N at 0, 0.25, 0.5, 0.75, 1 A. Valid to 0.13 m/s, 1 A and 20 Hz. Temperature scales R and L (viscous), 1/C
    and k_g (elastic), P_y and fs (yield).

    Source: Hong, Choi, Choi and Wereley 2005, J. Sound Vib. 285:1180; form vaguely recalled, read by us as
    lumped hydraulics, no parameter set found
    """

    R: Annotated[CurrentLaw, param("Pa s/m^3", "resistance R(I) of the gap")] = (8.68e8, 3.03e9, 6.71e9, -5.23e9)
    P_y: Annotated[CurrentLaw, param("Pa", "yield pressure P_y(I)")] = (1.31e5, 6.2e5, 1.266e6, -8.69e5)
    A: Annotated[float, param("m^2", "area A of the piston, less the rod's", low=1e-5, high=1e-2)] = 9.4e-4
    C: Annotated[float, param("m^3/Pa", "compliance C of the chambers", low=1e-15, high=1e-10)] = 2.0e-13
    L: Annotated[float, param("kg/m^4", "inertance L of the gap", low=1e4, high=1e8)] = 5.0e5
    Q_r: Annotated[float, param("m^3/s", "flow Q_r that regularises the sign", low=1e-7, high=1e-3)] = 7.8e-6
    k_g: Annotated[float, param("N/m", "stiffness of the gas accumulator", low=0, high=1e5)] = 1300.0
    fs: Annotated[float, param("N", "friction of the seal", low=0, high=200)] = 5.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N, without the friction of the seal."""
        return (self.A * z[0] / self.C + self.k_g * x) * scaling.stiffness + self.f0

    def coulomb(self, i: float, scaling: TemperatureScaling) -> float:
        """Return the magnitude of the seal's set-valued friction in N."""
        return self.fs * scaling.yield_force

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (V', Q')."""
        held, flow = min(i, self.law_end), z[1]
        resistance, yielding = cubic(self.R, held) * scaling.viscous, cubic(self.P_y, held) * scaling.yield_force
        sign = math.tanh(flow / self.Q_r)
        slope = resistance + yielding * (1.0 - sign * sign) / self.Q_r
        driven = z[0] / self.C * scaling.stiffness - resistance * flow - yielding * sign
        return (self.A * v - flow, driven / (self.L * scaling.viscous + SETTLING * slope))


_ORDERED_AT = 0.1
"""Steady velocity in m/s at which the order parameter is 1, chosen by us: the scale of the damper's speeds."""


@utfsm_damper("phase_transition", initial=(0.0,), state="p, order parameter of the flow", confidence="reading")
class PhaseTransition(NamedTuple):
    """Yield as a phase transition: the flow's order parameter relaxes in a Landau potential.

        F  = c(I) v + fy(I) p + f0
        p' = {v / v_ref - dG/dp} / tau(I),   G = a p^2 / 2 + (1 - a) p^6 / 6,   v_ref = 0.1 m/s

    Steady flow at v_ref has p = 1, of either sign; the smaller a, the closer is p to a sign of v and the slower
    its reversal, which makes the loop. Our reading, physically sound, not the paper's equations: that the order
    parameter of a Landau free energy obeys a differential equation driven by the velocity is all we know of
    them. Two wells (a < 0) are excluded: p would keep its sign at rest and the damper push. Dissipative.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 19 N at 0 A to 108 N at 1 A, 8 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales c (viscous) and fy (yield).

    Source: Wang and Kamath 2006, Smart Mater. Struct. 15:1725, whose equations were not at hand: our reading
    of its idea
    """

    c: Annotated[CurrentLaw, param("N s/m", "viscous damping c(I)")] = (150.0, 0.0, 0.0, 0.0)
    fy: Annotated[CurrentLaw, param("N", "yield force fy(I)")] = (188.0, 883.0, 1770.0, -1297.0)
    a: Annotated[float, param("-", "share of the quadratic term of the potential", low=1e-3, high=1)] = 0.135
    tau0: Annotated[float, param("s", "time of relaxation at zero current", low=1e-4, high=0.1)] = 1e-3
    tau1: Annotated[float, param("s", "the same at law_end", low=2e-4, high=0.2)] = 2.4e-3
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        return cubic(self.c, held) * scaling.viscous * v + cubic(self.fy, held) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (p',)."""
        gradient = z[0] * (self.a + (1.0 - self.a) * z[0] ** 4)
        return ((v / _ORDERED_AT - gradient) / between(self.tau0, self.tau1, i, self.law_end),)
