"""Normalised Bouc-Wen dampers: shear-mode, large-scale, non-symmetrical."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.compilation.jit import jit
from seatsim.dampers.pieces import CurrentLaw, between, cubic, inertance, inertance_rate, power, utfsm_damper
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.fields import param

NORMALISED = "w, hysteretic variable from -1 to 1"


@jit
def normalised_rate(rho: float, sigma: float, n: float, r: float, w: float) -> float:
    """Return `rho {r - sigma |r| |w|^(n-1) w + (sigma - 1) r |w|^n}` at velocity r; it keeps |w| <= 1."""
    size = power(abs(w), n)
    return rho * r * (1.0 - size if r * w >= 0.0 else 1.0 + (2.0 * sigma - 1.0) * size)


@utfsm_damper("shear_bouc_wen", initial=(0.0,), state=NORMALISED, confidence="recalled")
class ShearBoucWen(NamedTuple):
    """Shear-mode Bouc-Wen damper: a dashpot beside a hysteresis, no spring.

        F  = kx(I) v + kw(I) w + f0
        w' = rho(I) {v - sigma |v| |w|^(n-1) w + (sigma - 1) v |w|^n},   |w| <= 1

    The simple Bouc-Wen damper without its spring; normalised, w stays within its bounds when the current
    changes. Dissipative for sigma >= 1/2. The form is recalled, not read in the papers, which have laws
    linear in the voltage; ours are cubic, rho linear between zero current and `law_end`.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 20 N at 0 A to 100 N at 1 A, 8 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales kx (viscous) and kw (yield).

    Source: Jansen and Dyke 2000, normalised after Ikhouane and Dyke 2007, Smart Mater. Struct. 16:605; form
    recalled
    """

    kx: Annotated[CurrentLaw, param("N s/m", "viscous damping kx(I)")] = (980.0, 3020.0, 4450.0, -3340.0)
    kw: Annotated[CurrentLaw, param("N", "yield force kw(I)")] = (112.0, 584.0, 1228.0, -871.0)
    rho0: Annotated[float, param("1/m", "slope of w from zero, at zero current", low=100, high=1e6)] = 10400.0
    rho1: Annotated[float, param("1/m", "the same at law_end", low=30, high=3e5)] = 2850.0
    sigma: Annotated[float, param("-", "half the slope of unloading over that of loading", low=0.5, high=200)] = 15.0
    n: Annotated[float, param("-", "sharpness of yielding", low=1, high=20)] = 1.4
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        return cubic(self.kx, held) * scaling.viscous * v + cubic(self.kw, held) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        rho = between(self.rho0, self.rho1, i, self.law_end)
        return (normalised_rate(rho, self.sigma, self.n, v, z[0]),)


@utfsm_damper(
    "large_scale_bouc_wen",
    initial=(0.0, 0.0),
    state=f"{NORMALISED}; u, velocity of the inertance in m/s",
    confidence="recalled",
)
class LargeScaleBoucWen(NamedTuple):
    """Bouc-Wen damper for large dampers: damping that falls with speed, and the inertia of fluid and piston.

        F  = alpha(I) w + k x + a1(I) exp{-(a2 |v|)^p} v + m (v - u) / tau + f0
        w' = rho(I) {v - sigma |v| |w|^(n-1) w + (sigma - 1) v |w|^n},   |w| <= 1
        u' = (v - u) / tau

    The form is recalled, not read in the paper; its hysteresis is normalised here. The paper has m v' where we have
    an inertance behind a dashpot m / tau, tau = `pieces_series.INERTANCE_TIME`: the same in slow motion, and passive
    without need of the acceleration. a1 exp{..} is stiction at low speed and shear thinning at high speed.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 16 N at 0 A to 75 N at 1 A, 6 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales a1 and, so that the whole force follows, m (viscous), k (elastic) and alpha (yield).

    Source: Yang, Spencer, Jung and Carlson 2004, J. Eng. Mech. 130:1107; form recalled
    """

    a1: Annotated[CurrentLaw, param("N s/m", "damping a1(I) at low speed")] = (12400.0, 58000.0, 8900.0, -15200.0)
    alpha: Annotated[CurrentLaw, param("N", "yield force alpha(I)")] = (59.7, 245.0, 1451.0, -961.0)
    a2: Annotated[float, param("s/m", "decay of the damping with speed", low=0.1, high=1e4)] = 100.0
    p: Annotated[float, param("-", "exponent of that decay", low=0.05, high=5)] = 0.335
    k: Annotated[float, param("N/m", "stiffness, of the gas accumulator", low=0)] = 830.0
    m: Annotated[float, param("kg", "inertia of fluid and piston", low=0, high=400)] = 4.0
    rho0: Annotated[float, param("1/m", "slope of w from zero, at zero current", low=100, high=1e6)] = 8700.0
    rho1: Annotated[float, param("1/m", "the same at law_end", low=30, high=3e5)] = 2880.0
    sigma: Annotated[float, param("-", "half the slope of unloading over that of loading", low=0.5, high=200)] = 3.1
    n: Annotated[float, param("-", "sharpness of yielding", low=1, high=20)] = 1.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        thinned = cubic(self.a1, held) * math.exp(-power(self.a2 * abs(v), self.p)) * v
        flow = (thinned + inertance(self.m, v, z[1])) * scaling.viscous
        return flow + self.k * scaling.stiffness * x + cubic(self.alpha, held) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w', u')."""
        rho = between(self.rho0, self.rho1, i, self.law_end)
        return (normalised_rate(rho, self.sigma, self.n, v, z[0]), inertance_rate(v, z[1]))


@utfsm_damper("nonsymmetrical_bouc_wen", initial=(0.0,), state=NORMALISED, confidence="recalled", fixed=("mu",))
class NonsymmetricalBoucWen(NamedTuple):
    """Bouc-Wen damper whose hysteresis sees the velocity shifted by mu, so that the loop is not symmetric.

        F  = c(I) v + k x + alpha(I) w + f0
        w' = rho(I) {1 - |w|^n [1 - sigma + sigma sgn(w r)]} r,   r = v - mu,   |w| <= 1

    The form is recalled, not read in the paper: there `z' = {A - |z|^n [gamma + beta sgn(z r)]} r`, here
    normalised with rho = A, rho (1 - sigma) = gamma, rho sigma = beta. With mu != 0 a damper at rest creeps:
    w drifts to -sgn(mu) at the rate rho |mu|, and the force with it, so that the form is dissipative over
    closed cycles only; mu is 0 by default.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 19 N at 0 A to 100 N at 1 A, 8 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales c (viscous), k (elastic) and alpha (yield).

    Source: Kwok, Ha, Nguyen, Li and Samali 2007, ISA Trans. 46:167; form recalled
    """

    c: Annotated[CurrentLaw, param("N s/m", "viscous damping c(I)")] = (990.0, 3030.0, 4520.0, -3410.0)
    alpha: Annotated[CurrentLaw, param("N", "yield force alpha(I)")] = (110.5, 584.5, 1219.0, -863.6)
    mu: Annotated[float, param("m/s", "velocity about which the hysteresis is symmetric", low=-0.02, high=0.02)] = 0.0
    k: Annotated[float, param("N/m", "stiffness, of the gas accumulator", low=0)] = 440.0
    rho0: Annotated[float, param("1/m", "slope of w from zero, at zero current", low=100, high=1e6)] = 10900.0
    rho1: Annotated[float, param("1/m", "the same at law_end", low=30, high=3e5)] = 2860.0
    sigma: Annotated[float, param("-", "half the slope of unloading over that of loading", low=0.5, high=200)] = 15.0
    n: Annotated[float, param("-", "sharpness of yielding", low=1, high=20)] = 1.4
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        smooth = cubic(self.c, held) * scaling.viscous * v + self.k * scaling.stiffness * x
        return smooth + cubic(self.alpha, held) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        rho = between(self.rho0, self.rho1, i, self.law_end)
        return (normalised_rate(rho, self.sigma, self.n, v - self.mu, z[0]),)
