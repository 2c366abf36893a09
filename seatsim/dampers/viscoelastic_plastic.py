"""Visco-elastic-plastic dampers: a solid before yield, a flow past it; elasto-slide, and lumped elements."""

import math
from typing import Annotated, NamedTuple

from seatsim.dampers import State, TemperatureScaling, jit, param
from seatsim.dampers.pieces import SETTLING, CurrentLaw, cubic, inertance, inertance_rate, limited, slip, utfsm_damper


@jit
def yielded(force: float, limit: float) -> float:
    """Return the share Y of the flow, rising from 0 to 1 as the force of the solid reaches its limit."""
    return 1.0 if abs(force) >= limit else (force / limit) ** 2


@jit
def solid_force(k1: float, k2: float, scaling: TemperatureScaling, z: State) -> float:
    """Return the force in N of a standard solid with the deflections z[0] of spring k1 and z[1] of spring k2."""
    return (k1 * z[0] + k2 * z[1]) * scaling.stiffness


@utfsm_damper(
    "viscoelastic_plastic",
    initial=(0.0, 0.0),
    state="e, deflection in m of the pre-yield spring; u, inner speed in m/s of the inertance",
    confidence="reading",
)
class ViscoelasticPlastic(NamedTuple):
    """General visco-elastic-plastic damper: shape functions of the speed pass from a pre-yield to a post-yield branch.

        F = S_ve k1(I) e + S_vi [c(I) v + m u'] + S_c fc(I) + f0
        S_vi = {1 + tanh[(|v| - vy) / (4 eps)]} / 2,   S_ve = 1 - S_vi
        S_c = {tanh[(v - vy) / (4 eps)] + tanh[(v + vy) / (4 eps)]} / 2
        e' = S_ve v - k1 e / c1(I),   u' = (S_vi v - u) / tau

    S_ve and S_vi are recalled. S_c, vaguely recalled as S_vi sgn(v), is read as its continuous form, which is that
    for vy >> eps; one eps serves all three. Pre-yield is a Maxwell element, the recalled solid without its
    equilibrium spring, which would make the force depend on where the motion started. The speed is split (ours):
    each branch is driven by its share, S_ve v or S_vi v, because a branch that is weighted in force but driven by
    all of v can return more work than it took. m u' stands for m v': an inertance behind a dashpot m / tau, tau =
    2 ms; it scales with the viscous factor of the temperature (ours). k1 = k_a + k_b I;
    c1, c and fc are cubic laws, held beyond `law_end`. The defaults are derived by us (see `pieces.UTFSM`),
    with m and vy chosen; rms error 22, 44, 74, 102, 140 N at 0, 0.25, 0.5, 0.75, 1 A. Valid to 0.13 m/s and 1 A.
    Temperature scales c1, c, m (viscous), k1 (elastic) and fc (yield).

    Source: Kamath and Wereley 1997, J. Guidance Control Dyn. 20:1125; shape functions recalled, the elements
    between them read by us, no parameter set found
    """

    c1: Annotated[CurrentLaw, param("N s/m", "damping c1(I) before yield")] = (15770.0, 58330.0, 166400.0, -93440.0)
    c: Annotated[CurrentLaw, param("N s/m", "damping c(I) past yield")] = (330.3, 612.6, 4254.0, -1902.0)
    fc: Annotated[CurrentLaw, param("N", "yield force fc(I)")] = (166.4, 763.6, 1361.0, -1069.0)
    k_a: Annotated[float, param("N/m", "stiffness k1 at zero current", low=1e4, high=1e8)] = 6.9e5
    k_b: Annotated[float, param("N/(m A)", "rise of the stiffness with current", low=0, high=1e8)] = 4.64e6
    m: Annotated[float, param("kg", "inertance m past yield", low=0, high=100)] = 1.0
    v_y: Annotated[float, param("m/s", "yield speed vy", low=1e-3, high=0.3)] = 0.02
    eps: Annotated[float, param("m/s", "quarter width eps of the passage through yield", low=2e-4, high=0.1)] = 6.25e-3
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held, width = min(i, self.law_end), 4.0 * self.eps
        low, high = math.tanh((v - self.v_y) / width), math.tanh((v + self.v_y) / width)
        post = 0.5 * (1.0 + math.tanh((abs(v) - self.v_y) / width))
        solid = (1.0 - post) * (self.k_a + self.k_b * held) * scaling.stiffness * z[0]
        flow = post * scaling.viscous * (cubic(self.c, held) * v + inertance(self.m, post * v, z[1]))
        return solid + flow + 0.5 * (low + high) * cubic(self.fc, held) * scaling.yield_force + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (e', u')."""
        held = min(i, self.law_end)
        post = 0.5 * (1.0 + math.tanh((abs(v) - self.v_y) / (4.0 * self.eps)))
        elastic = (self.k_a + self.k_b * held) * scaling.stiffness * z[0]
        creep = elastic / (cubic(self.c1, held) * scaling.viscous)
        return ((1.0 - post) * v - creep, inertance_rate(post * v, z[1]))


@utfsm_damper(
    "li_viscoelastic_plastic",
    initial=(0.0, 0.0, 0.0),
    state="e1, deflection in m of spring k1; e2, deflection in m of spring k2; u, inner speed in m/s of the inertance",
    confidence="reading",
)
class LiViscoelasticPlastic(NamedTuple):
    """Visco-elastic-plastic damper after Li et al.: a standard solid until its force reaches the yield force.

        |f| < fc:  F = f + fs sgn(v) + f0,   f = k1(I) e1 + k2 e2,   e1' = v,   e2' = v - k2 e2 / c2
        |f| = fc:  F = fc(I) sgn(v) + cv(I) v + R v' + fs sgn(v) + f0

    Vaguely recalled: the two modes and the criterion. Ours is what makes their passage continuous and passive: at
    yield the solid slips at y' = (f - fc sgn f) / (k tau), k = k1 + k2, tau = `pieces.SETTLING`, which is
    taken off both rates, and gives fc; the flow's terms are weighted by Y = min(1, |f| / fc)^2, the inertance
    driven by its share Y v. R v' is an inertance behind a dashpot R / tau', tau' =
    2 ms; it scales with the viscous factor of the temperature (ours). The seal's
    friction fs is set-valued. k1 = k_a + k_b I; fc and cv are cubic laws, held beyond `law_end`. The defaults are
    derived by us (see `pieces.UTFSM`), with R chosen; rms error 29, 51, 92, 133, 174 N at 0, 0.25, 0.5,
    0.75, 1 A. Valid to 0.13 m/s and 1 A. Temperature scales cv, c2, R (viscous), k1, k2 (elastic), fc and fs
    (yield).

    Source: Li, Yao, Chen, Yeo and Yap 2000, Smart Mater. Struct. 9:95; form vaguely recalled, the passage
    through yield read by us, no parameter set found
    """

    fc: Annotated[CurrentLaw, param("N", "yield force fc(I)")] = (65.2, 506.4, 902.5, -617.9)
    cv: Annotated[CurrentLaw, param("N s/m", "damping cv(I) past yield")] = (1054.0, 3828.0, 10170.0, -7645.0)
    k_a: Annotated[float, param("N/m", "stiffness k1 at zero current", low=1e3, high=1e7)] = 1.67e5
    k_b: Annotated[float, param("N/(m A)", "rise of the stiffness k1 with current", low=0, high=1e7)] = 1.1e6
    k2: Annotated[float, param("N/m", "stiffness k2", low=1e4, high=1e8)] = 7.8e6
    c2: Annotated[float, param("N s/m", "damping c2 in series with k2", low=1e3, high=1e6)] = 1.0e5
    R: Annotated[float, param("kg", "inertance R of the flow", low=0, high=100)] = 1.0
    fs: Annotated[float, param("N", "static friction fs of the seal", low=0, high=200)] = 43.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N, without the friction of the seal."""
        held = min(i, self.law_end)
        f, fc = solid_force(self.k_a + self.k_b * held, self.k2, scaling, z), cubic(self.fc, held) * scaling.yield_force
        share = yielded(f, fc)
        flow = cubic(self.cv, held) * v + inertance(self.R, share * v, z[2])
        return limited(f, fc) + share * scaling.viscous * flow + self.f0

    def coulomb(self, i: float, scaling: TemperatureScaling) -> float:
        """Return the magnitude of the seal's set-valued friction in N."""
        return self.fs * scaling.yield_force

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (e1', e2', u')."""
        held = min(i, self.law_end)
        k1, fc = self.k_a + self.k_b * held, cubic(self.fc, held) * scaling.yield_force
        f = solid_force(k1, self.k2, scaling, z)
        rate = v - slip(f, fc, (k1 + self.k2) * scaling.stiffness * SETTLING)
        creep = self.k2 * scaling.stiffness * z[1] / (self.c2 * scaling.viscous)
        return (rate, rate - creep, inertance_rate(yielded(f, fc) * v, z[2]))


@utfsm_damper(
    "stiffness_viscosity_elasto_slide",
    initial=(0.0,),
    state="e, deflection in m of the elasto-slide element",
    confidence="recalled",
)
class StiffnessViscosityElastoSlide(NamedTuple):
    """Spring and dashpot beside an elasto-slide (Jenkins) element: a spring ke that slides at the force N_s.

        F = k0 x + c0(I) v + F_e + f0,   F_e = ke(I) e limited to N_s(I)
        e' = v - (ke e - F_e) / (ke tau)

    The form is recalled: F_e' = ke v while |F_e| < N_s, clipped there. The slide is ours: what ke e exceeds F_e by
    relaxes within tau = `pieces.SETTLING`, also where N_s falls with the current, so that F_e never exceeds
    N_s and leaves it at a reversal. ke = ke_a + ke_b I; c0 and N_s are cubic laws, held beyond `law_end`. The
    defaults are derived by us (see `pieces.UTFSM`); rms error 27, 60, 105, 141, 186 N at 0, 0.25, 0.5, 0.75,
    1 A. Valid to 0.13 m/s and 1 A. Temperature scales c0 (viscous), k0 and ke (elastic), and N_s (yield).

    Source: named in Table 2.1 of Braz-Cesar and Barros 2012, of the group of Wereley; form recalled, no
    parameter set found
    """

    c0: Annotated[CurrentLaw, param("N s/m", "viscous damping c0(I)")] = (1169.0, 5098.0, 8317.0, -6917.0)
    n_s: Annotated[CurrentLaw, param("N", "slide force N_s(I)")] = (101.0, 427.2, 1022.0, -668.0)
    ke_a: Annotated[float, param("N/m", "elasto-slide stiffness ke at zero current", low=1e4, high=1e8)] = 5.6e6
    ke_b: Annotated[float, param("N/(m A)", "rise of that stiffness with current", low=0, high=1e8)] = 1.9e6
    k0: Annotated[float, param("N/m", "stiffness k0", low=0, high=1e5)] = 900.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        linear = self.k0 * scaling.stiffness * x + cubic(self.c0, held) * scaling.viscous * v
        elastic = (self.ke_a + self.ke_b * held) * scaling.stiffness * z[0]
        return linear + limited(elastic, cubic(self.n_s, held) * scaling.yield_force) + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (e',)."""
        held = min(i, self.law_end)
        ke = (self.ke_a + self.ke_b * held) * scaling.stiffness
        return (v - slip(ke * z[0], cubic(self.n_s, held) * scaling.yield_force, ke * SETTLING),)


@utfsm_damper(
    "equivalent_oh_onoda", initial=(0.0,), state="e, elongation of the series spring in m", confidence="reading"
)
class EquivalentOhOnoda(NamedTuple):
    """Lumped elements: a spring before friction and dashpot of the flow, beside seal and accumulator.

        F  = ks e + ka x + fs sgn(v) + f0
        e' = v - y',   y' = 0 for |ks e| <= fy(I),  {ks e - fy(I) sgn(e)} / c(I) beyond

    ks is the stiffness of the fluid and its housing, e the elongation of that spring, y the flow through the
    valve with its yield force and viscosity. Our reading, physically sound, not the paper's equations: that the
    damper is lumped into friction, viscous elements and the stiffness of the accumulator is all we know of
    them. `fs` is set-valued at rest. Dissipative.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 23 N at 0 A to 152 N at 1 A, 10 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales c (viscous), ks and ka (elastic), fy and fs (yield).

    Source: Oh and Onoda 2002, Smart Mater. Struct. 11:156, whose equations were not at hand: our reading of
    its lumped elements
    """

    c: Annotated[CurrentLaw, param("N s/m", "viscous damping c(I) of the flow")] = (1105.0, 3240.0, 7970.0, -5580.0)
    fy: Annotated[CurrentLaw, param("N", "yield force fy(I) of the flow")] = (81.2, 557.0, 999.0, -744.0)
    ks: Annotated[float, param("N/m", "stiffness of the series spring", low=1e5, high=1e8)] = 1.1e7
    ka: Annotated[float, param("N/m", "stiffness of the accumulator", low=0)] = 930.0
    fs: Annotated[float, param("N", "friction of the seal", low=0)] = 20.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N, without the friction of the seal."""
        return (self.ks * z[0] + self.ka * x) * scaling.stiffness + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (e',)."""
        held = min(i, self.law_end)
        q = self.ks * scaling.stiffness * z[0]
        return (v - slip(q, cubic(self.fy, held) * scaling.yield_force, cubic(self.c, held) * scaling.viscous),)

    def coulomb(self, i: float, scaling: TemperatureScaling) -> float:
        """Return the friction of the seal in N."""
        return self.fs * scaling.yield_force
