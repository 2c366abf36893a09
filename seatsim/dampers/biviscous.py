"""Bi-viscous dampers: steep damping before yield, flat damping after it, with hysteresis of three kinds."""

import math
from typing import Annotated, NamedTuple

from seatsim.dampers import State, TemperatureScaling, jit, param
from seatsim.dampers.pieces import (
    SETTLING,
    CurrentLaw,
    between,
    branch,
    branch_rate,
    cubic,
    limited,
    utfsm_branch_damper,
    utfsm_damper,
)


@jit
def two_slopes(pre: float, post: float, fy: float, v: float, shift: float) -> float:
    """Return the bi-viscous force in N: `post v` and, limited to `fy`, the rest of the pre-yield `pre v + shift`."""
    return post * v + limited((pre - post) * v + shift, fy)


@utfsm_damper("biviscous", confidence="recalled")
class Biviscous(NamedTuple):
    """Nonlinear bi-viscous damper, without hysteresis.

        F = c_post v + fy + f0   (v >= vy),   c_pre v + f0   (|v| <= vy),   c_post v - fy + f0   (v <= -vy)
        vy = fy / (c_pre - c_post)

    The form is recalled. All three coefficients are cubic laws in the current, held beyond `law_end`; c_pre is
    above c_post. The defaults are derived by us (see `pieces.UTFSM`); rms error 28, 62, 135, 219, 288 N at
    0, 0.25, 0.5, 0.75, 1 A. Valid to 0.13 m/s and 1 A. Temperature scales the damping (viscous) and fy (yield).

    Source: Wereley, Pang and Kamath 1998, J. Intell. Mater. Syst. Struct. 9:642; form recalled, no parameter
    set found
    """

    c_pre: Annotated[CurrentLaw, param("N s/m", "damping before yield")] = (12480.0, 87900.0, -16640.0, 3062.0)
    c_post: Annotated[CurrentLaw, param("N s/m", "damping past yield")] = (883.8, 3909.0, 5301.0, -3783.0)
    fy: Annotated[CurrentLaw, param("N", "yield force, past yield extended to rest")] = (119.8, 499.4, 1216.0, -876.1)
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        pre, post = cubic(self.c_pre, held) * scaling.viscous, cubic(self.c_post, held) * scaling.viscous
        return two_slopes(pre, post, cubic(self.fy, held) * scaling.yield_force, v, 0.0) + self.f0


@utfsm_branch_damper("hysteretic_biviscous", confidence="recalled")
class HystereticBiviscous(NamedTuple):
    """Nonlinear hysteretic bi-viscous damper: the pre-yield line crosses zero force at a speed v0, not at rest.

        v' > 0:  F - f0 = c_post v - fy (v <= -v1),  c_pre (v - v0) (-v1 <= v <= v2),  c_post v + fy (v >= v2)
        v' < 0:  the same mirrored, F - f0 = c_pre (v + v0) for -v2 <= v <= v1
        v1 = (fy - c_pre v0) / (c_pre - c_post),   v2 = (fy + c_pre v0) / (c_pre - c_post)

    The form is recalled, its signs checked by us on measured loops. Both branches are c_post v + [(c_pre - c_post)
    v - c_pre v0 sgn(v')] limited to fy; -sgn(v') is the smoothed sign of the displacement about its recent mean
    (`pieces.branch`). v0 = v0_a + v0_b I; the rest are cubic laws, held beyond `law_end`. The defaults are derived
    by us (see `pieces.UTFSM`); rms error 23, 47, 96, 155, 206 N at 0, 0.25, 0.5, 0.75, 1 A. Valid to 0.13
    m/s and 1 A. Temperature scales the damping (viscous) and fy (yield).

    Source: Wereley, Pang and Kamath 1998, J. Intell. Mater. Syst. Struct. 9:642; form recalled, no parameter
    set found
    """

    c_pre: Annotated[CurrentLaw, param("N s/m", "damping before yield")] = (12410.0, 71070.0, -13320.0, -10410.0)
    c_post: Annotated[CurrentLaw, param("N s/m", "damping past yield")] = (863.8, 3801.0, 4338.0, -4161.0)
    fy: Annotated[CurrentLaw, param("N", "yield force, past yield extended to rest")] = (121.2, 505.9, 1289.0, -844.8)
    v0_a: Annotated[float, param("m/s", "speed of zero force at zero current", low=0, high=0.1)] = 3.0e-3
    v0_b: Annotated[float, param("m/(s A)", "rise of that speed with current", low=0, high=0.1)] = 3.57e-3
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        pre, post = cubic(self.c_pre, held) * scaling.viscous, cubic(self.c_post, held) * scaling.viscous
        shift = pre * (self.v0_a + self.v0_b * held) * branch(z)
        return two_slopes(pre, post, cubic(self.fy, held) * scaling.yield_force, v, shift) + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        return branch_rate(v, z)


@utfsm_branch_damper("hysteretic_arctangent", confidence="recalled")
class HystereticArctangent(NamedTuple):
    """Nonlinear hysteretic arctangent damper: the hysteretic bi-viscous one with rounded corners.

        F = c_post(I) v + (2/pi) fy(I) arctan{K(I) [v - v0(I) sgn(v')]} + f0

    The form is recalled. It is that of `weng_arctangent` with a steepness K, k_0 to k_1, that follows the
    current, so that the damping before yield, about c_post + 2 fy K / pi, has a law of its own. -sgn(v') is the
    smoothed sign of the displacement about its recent mean (`pieces.branch`); v0 = v0_a + v0_b I; c_post and fy
    are cubic laws, held beyond `law_end`. The defaults are derived by us (see `pieces.UTFSM`), with c_post
    chosen; rms error 23, 45, 94, 152, 202 N at 0, 0.25, 0.5, 0.75, 1 A. Valid to 0.13 m/s and 1 A. Temperature
    scales c_post (viscous) and fy (yield).

    Source: named in Table 2.1 of Braz-Cesar and Barros 2012; form recalled, no parameter set found
    """

    c_post: Annotated[CurrentLaw, param("N s/m", "damping past yield")] = (350.0, 900.0, 500.0, 0.0)
    fy: Annotated[CurrentLaw, param("N", "yield force")] = (170.0, 765.5, 1707.0, -1167.0)
    k_0: Annotated[float, param("s/m", "steepness K at zero current", low=1, high=5000)] = 137.0
    k_1: Annotated[float, param("s/m", "steepness K at law_end", low=1, high=5000)] = 90.0
    v0_a: Annotated[float, param("m/s", "half width v0 of the loop at zero current", low=0, high=0.1)] = 3.01e-3
    v0_b: Annotated[float, param("m/(s A)", "rise of the half width with current", low=0, high=0.1)] = 2.86e-3
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        shifted = v + (self.v0_a + self.v0_b * held) * branch(z)
        angle = math.atan(between(self.k_0, self.k_1, i, self.law_end) * shifted)
        yielding = cubic(self.fy, held) * scaling.yield_force * 2.0 / math.pi * angle
        return cubic(self.c_post, held) * scaling.viscous * v + yielding + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        return branch_rate(v, z)


@utfsm_damper(
    "lumped_biviscous",
    initial=(0.0, 0.0),
    state="e = x - x1, deflection in m of the compressible fluid; u = x1', speed in m/s of the flow",
    confidence="recalled",
)
class LumpedBiviscous(NamedTuple):
    """Lumped bi-viscous damper: the fluid's mass m and compressibility k in series with a bi-viscous flow.

        m x1'' = k (x - x1) - Fb(x1'),   F = k (x - x1) + f0,   Fb as in `biviscous`

    The form is recalled. k = k_a + k_b I. To keep the flow from settling faster than tau = `pieces.SETTLING`
    before yield, where c_pre / m can be 10^4 1/s, the mass counts as m + tau dFb/du (ours): a mass that depends on
    the speed still stores what it takes, so the model stays passive, and motion slow against tau does not feel it.
    The mass scales with the viscous factor of the temperature (ours), so that three equal factors scale the whole
    force. The defaults are derived by us (see `pieces.UTFSM`), with m chosen; rms error 25, 50, 84, 102, 143 N
    at 0, 0.25, 0.5, 0.75, 1 A. Valid to 0.13 m/s, 1 A and 20 Hz. Temperature scales the damping (viscous), k
    (elastic) and fy (yield).

    Source: Sims, Peel, Stanway, Johnson and Bullough 2000, J. Sound Vib. 229:207; form recalled, no parameter
    set found
    """

    c_pre: Annotated[CurrentLaw, param("N s/m", "damping before yield")] = (14960.0, 59430.0, 82700.0, -42600.0)
    c_post: Annotated[CurrentLaw, param("N s/m", "damping past yield")] = (887.3, 4023.0, 4354.0, -3791.0)
    fy: Annotated[CurrentLaw, param("N", "yield force, past yield extended to rest")] = (119.8, 487.3, 1310.0, -884.7)
    k_a: Annotated[float, param("N/m", "stiffness k at zero current", low=1e4, high=1e8)] = 2.0e6
    k_b: Annotated[float, param("N/(m A)", "rise of the stiffness with current", low=0, high=1e8)] = 4.0e6
    m: Annotated[float, param("kg", "mass m of the flow, reduced to the piston", low=0.01, high=100)] = 1.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        return (self.k_a + self.k_b * held) * scaling.stiffness * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (e', u')."""
        held, u = min(i, self.law_end), z[1]
        pre, post = cubic(self.c_pre, held) * scaling.viscous, cubic(self.c_post, held) * scaling.viscous
        fy = cubic(self.fy, held) * scaling.yield_force
        slope = pre if abs((pre - post) * u) < fy else post
        driven = (self.k_a + self.k_b * held) * scaling.stiffness * z[0] - two_slopes(pre, post, fy, u, 0.0)
        return (v - u, driven / (self.m * scaling.viscous + SETTLING * slope))
