"""Dampers with elements in series: a spring before friction and dashpot, and the Maxwell element.

The force is that of a spring, which the current reaches only through the state: an inverse does better with another
model to assume.
"""

from typing import Annotated, NamedTuple

from seatsim.dampers import State, TemperatureScaling, jit, param
from seatsim.dampers.pieces import (
    SETTLING,
    CurrentLaw,
    cubic,
    inertance,
    inertance_rate,
    limited,
    power,
    slip,
    utfsm_damper,
)


@utfsm_damper("modified_bingham", initial=(0.0,), state="e = x - x1, deflection in m of the series spring")
class ModifiedBingham(NamedTuple):
    """Bingham element (displacement x1) in series with a spring k1.

        F = c0(I) x1' + fc(I) sgn(x1') + f0 = k1(I) (x - x1) + f0

    The form is as printed. Solved for the state by us: with q = k1 e, x1' = 0 for |q| <= fc and (q - fc sgn q) /
    c0 beyond, e' = v - x1', which is continuous and holds the friction at rest without a set-valued sign. k1 =
    k_a + k_b I; c0 and fc are cubic laws, held beyond `law_end`. The defaults are derived by us (see
    `pieces.UTFSM`); rms error 29, 69, 117, 150, 190 N at 0, 0.25, 0.5, 0.75, 1 A. Valid to 0.13 m/s and
    1 A. Temperature scales c0 (viscous), k1 (elastic) and fc (yield).

    Source: Wang and Liao 2011, Smart Mater. Struct. 20:023001, eq 13, without parameters
    """

    c0: Annotated[CurrentLaw, param("N s/m", "viscous damping c0(I)")] = (1163.0, 5447.0, 8467.0, -7215.0)
    fc: Annotated[CurrentLaw, param("N", "yield force fc(I)")] = (101.6, 401.9, 1014.0, -647.2)
    k_a: Annotated[float, param("N/m", "stiffness k1 at zero current", low=1e4, high=1e8)] = 2.2e6
    k_b: Annotated[float, param("N/(m A)", "rise of the stiffness k1 with current", low=0, high=1e8)] = 5.0e6
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        return (self.k_a + self.k_b * held) * scaling.stiffness * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (e',)."""
        held = min(i, self.law_end)
        q = (self.k_a + self.k_b * held) * scaling.stiffness * z[0]
        return (v - slip(q, cubic(self.fc, held) * scaling.yield_force, cubic(self.c0, held) * scaling.viscous),)


@utfsm_damper(
    "gamota_filisko",
    initial=(0.0, 0.0),
    state="e2 = x - x2, deflection in m of the outer spring; e1 = x2 - x1, deflection in m of the inner solid",
    confidence="recalled",
)
class GamotaFilisko(NamedTuple):
    """Bingham element (x1) in series with a standard linear solid: spring k1 beside dashpot c1 (x2 - x1), spring k2.

        |F - f0| > fc:   F = c0(I) x1' + fc(I) sgn(x1') + f0
        always:          F = k1 (x2 - x1) + c1 (x2' - x1') + f0 = k2(I) (x - x2) + f0
        |F - f0| <= fc:  x1' = 0

    The form is recalled, the yield criterion read without the offset. Solved for the states by us: q = k2 e2, x1'
    = 0 for |q| <= fc and (q - fc sgn q) / c0 beyond, e1' = (q - k1 e1) / c1, e2' = v - x1' - e1'. k2 = k2_a +
    k2_b I; c0 and fc are cubic laws, held beyond `law_end`. The defaults are derived by us (see
    `pieces.UTFSM`); rms error 29, 65, 98, 106, 141 N at 0, 0.25, 0.5, 0.75, 1 A; these data leave next to
    no k1, so that the solid creeps. Valid to 0.13 m/s and 1 A. Temperature scales c0 and c1 (viscous), k1 and k2
    (elastic) and fc (yield).

    Source: Gamota and Filisko 1991, J. Rheology 35:399; form recalled, no parameter set found
    """

    c0: Annotated[CurrentLaw, param("N s/m", "viscous damping c0(I) past yield")] = (1146.0, 5505.0, 3984.0, -5248.0)
    fc: Annotated[CurrentLaw, param("N", "yield force fc(I)")] = (105.2, 388.2, 1551.0, -915.3)
    k1: Annotated[float, param("N/m", "stiffness k1 of the inner spring", low=1e2, high=1e8)] = 1.0e4
    c1: Annotated[float, param("N s/m", "damping c1 beside the inner spring", low=1e3, high=1e7)] = 8.4e4
    k2_a: Annotated[float, param("N/m", "stiffness k2 at zero current", low=1e4, high=1e8)] = 1.6e6
    k2_b: Annotated[float, param("N/(m A)", "rise of the stiffness k2 with current", low=0, high=1e8)] = 4.0e6
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        return (self.k2_a + self.k2_b * held) * scaling.stiffness * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (e2', e1')."""
        held = min(i, self.law_end)
        q = (self.k2_a + self.k2_b * held) * scaling.stiffness * z[0]
        flow = slip(q, cubic(self.fc, held) * scaling.yield_force, cubic(self.c0, held) * scaling.viscous)
        creep = (q - self.k1 * scaling.stiffness * z[1]) / (self.c1 * scaling.viscous)
        return (v - flow - creep, creep)


@utfsm_damper(
    "bingmax",
    initial=(0.0,),
    state="e, deflection in m of the Maxwell element's spring",
    confidence="recalled",
)
class Bingmax(NamedTuple):
    """Maxwell element beside set-valued Coulomb friction.

        F = F_m + fy(I) sgn(v) + f0,   F_m' = k v - F_m / lambda,   lambda = c(I) / k

    The form is recalled. The state is the deflection e = F_m / k, e' = v - k e / c, which stays valid where the
    stiffness k = k_a + k_b I follows the current. c and fy are cubic laws, held beyond `law_end`. The defaults are
    derived by us (see `pieces.UTFSM`); rms error 35, 82, 161, 241, 308 N at 0, 0.25, 0.5, 0.75, 1 A. Valid
    to 0.13 m/s and 1 A. Temperature scales c (viscous), k (elastic) and fy (yield).

    Source: Makris, Burton, Hill and Jordan 1996, J. Eng. Mech. 122:1003; form recalled, no parameter set
    found
    """

    c: Annotated[CurrentLaw, param("N s/m", "damping c(I) of the Maxwell element")] = (1282.0, 4943.0, 13030.0, -8457.0)
    fy: Annotated[CurrentLaw, param("N", "yield force fy(I)")] = (93.9, 426.7, 797.4, -601.6)
    k_a: Annotated[float, param("N/m", "stiffness k at zero current", low=1e4, high=1e8)] = 3.15e5
    k_b: Annotated[float, param("N/(m A)", "rise of the stiffness with current", low=0, high=1e8)] = 3.4e5
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N, without the friction."""
        return (self.k_a + self.k_b * min(i, self.law_end)) * scaling.stiffness * z[0] + self.f0

    def coulomb(self, i: float, scaling: TemperatureScaling) -> float:
        """Return the magnitude of the set-valued friction in N."""
        return max(0.0, cubic(self.fy, min(i, self.law_end)) * scaling.yield_force)

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (e',)."""
        held = min(i, self.law_end)
        k = (self.k_a + self.k_b * held) * scaling.stiffness
        return (v - k * z[0] / (cubic(self.c, held) * scaling.viscous),)


@jit
def rising_power(b: float, n: float, size: float, tangent_below: float) -> float:
    """Return `b size^n`, continued below a transition by its tangent there."""
    if size >= tangent_below:
        return b * power(size, n)
    return b * power(tangent_below, n) * (1.0 + n * (size / tangent_below - 1.0))


@utfsm_damper(
    "maxwell_nonlinear_slider",
    initial=(0.0, 0.0),
    state="e, deflection in m of the Maxwell element's spring; u, inner speed in m/s of the inertance",
    confidence="recalled",
)
class MaxwellNonlinearSlider(NamedTuple):
    """Maxwell nonlinear slider (MNS): a Maxwell element before yield, a power law of the speed past it.

        pre-yield:   F = k e + f0,   e' = v - k e / c
        post-yield:  F = {a(I) + b(I) |v|^n + m0 |v|' (where |v|' < 0)} sgn(v) + f0

    The form is recalled; below the transition speed v_t the power law goes on as its tangent. The change of mode is
    ours: the Maxwell element's force is limited to the slider's, and what k e exceeds it by relaxes within
    `pieces.SETTLING`, which is continuous and lets the element unload at a reversal. m0 |v|' is an inertance
    behind a dashpot m0 / tau, tau = 2 ms; it scales with the viscous factor of the
    temperature and fades out below v_t, so that the force has no jump at a reversal (ours). Both directions share one
    law. k = k_a + k_b I, c = c_a + c_b I; a and b are cubic laws, held beyond `law_end`.

    The file of Chae gives for the RD-9001-01 at 1 A, extension, in kN, m, s: c 12000, k 118000, m0 1.6, v_t 0.01, a
    91.46, b 122.5, n 0.517. It is not used: the defaults are derived by us for a seat's damper (see
    `pieces.UTFSM`), with n and v_t chosen; rms error 23, 45, 73, 91, 130 N at 0, 0.25, 0.5, 0.75, 1 A. Valid
    to 0.13 m/s and 1 A. Temperature scales b, c, m0 (viscous), k (elastic) and a (yield).

    Source: Chae, Ricles and Sause 2010, 2013; form recalled, parameters of the 200 kN RD-9001-01 in a file of
    Chae 2010
    """

    a: Annotated[CurrentLaw, param("N", "force a(I) of the slider at rest")] = (50.5, 158.1, 805.0, -436.8)
    b: Annotated[CurrentLaw, param("N (s/m)^n", "coefficient b(I) of the power law")] = (348.4, 1605.0, 2070.0, -1832.0)
    n: Annotated[float, param("-", "exponent n of the power law", low=0.1, high=2)] = 0.35
    v_t: Annotated[float, param("m/s", "transition speed to the tangent", low=2e-4, high=0.1)] = 5e-3
    c_a: Annotated[float, param("N s/m", "pre-yield damping c at zero current", low=1e3, high=1e6)] = 1.9e4
    c_b: Annotated[float, param("N s/(m A)", "rise of that damping with current", low=0, high=1e7)] = 1.16e5
    k_a: Annotated[float, param("N/m", "stiffness k at zero current", low=1e4, high=1e8)] = 3.0e6
    k_b: Annotated[float, param("N/(m A)", "rise of the stiffness with current", low=0, high=1e8)] = 3.2e6
    m0: Annotated[float, param("kg", "inertance m0 while it slows down", low=0, high=100)] = 10.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        maxwell = (self.k_a + self.k_b * held) * scaling.stiffness * z[0]
        return limited(maxwell, slider(self, v, held, scaling, z[1])) + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (e', u')."""
        held = min(i, self.law_end)
        k = (self.k_a + self.k_b * held) * scaling.stiffness
        creep = k * z[0] / ((self.c_a + self.c_b * held) * scaling.viscous)
        over = slip(k * z[0], slider(self, v, held, scaling, z[1]), k * SETTLING)
        return (v - creep - over, inertance_rate(v, z[1]))


@jit
def slider(d: MaxwellNonlinearSlider, v: float, held: float, scaling: TemperatureScaling, u: float) -> float:
    """Return the magnitude in N of the post-yield force at the current `held`."""
    braking = min(0.0, min(max(v / d.v_t, -1.0), 1.0) * inertance(d.m0, v, u))
    rising = rising_power(cubic(d.b, held), d.n, abs(v), d.v_t)
    return (rising + braking) * scaling.viscous + cubic(d.a, held) * scaling.yield_force
