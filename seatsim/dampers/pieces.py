"""Pieces that several damper models share: powers, current laws, the branch of a loop, elements in series."""

import math
from functools import partial
from typing import Annotated

from seatsim.compilation.jit import jit
from seatsim.dampers.base import damper
from seatsim.rig.state import State
from seatsim.schema.fields import param

_Constant = Annotated[float, param("", "constant")]
_Linear = Annotated[float, param("1/A", "linear")]
_Quadratic = Annotated[float, param("1/A^2", "quadratic")]
LinearLaw = tuple[_Constant, _Linear]
"""Coefficients of a linear law in the current."""
QuadraticLaw = tuple[_Constant, _Linear, _Quadratic]
"""Coefficients of a quadratic law in the current."""
CurrentLaw = tuple[_Constant, _Linear, _Quadratic, Annotated[float, param("1/A^3", "cubic")]]
"""Coefficients of a cubic law in the current."""

UTFSM = (
    "defaults fitted by us to measured sine tests of the damper of UTFSM (Chile, repository"
    " DanielMaurelE/vRTHS_AMBC_MRdamper, MIT)"
)
"""Origin of defaults that are not from a published set.

Where a model does not say otherwise they are derived by us from one steady cycle each of 2 mm 5 Hz, 5 mm 3 and 4 Hz,
10 mm 1 and 2 Hz, 25 mm 0.1, 0.25 and 0.5 Hz at 0, 0.25, 0.5, 0.75, 1 A, offset removed; every test counts alike.
Stiffnesses of elements in series were kept to what explicit steps of 1 ms bear; inertances, which such tests do not
show, were chosen.
"""

utfsm_damper = partial(damper, max_speed=0.13, max_current=1.0, temperatures=(20.0, 20.0), defaults=UTFSM)
"""`damper` for a model with such defaults: the data reach 0.13 m/s and 1 A, at 20 degC."""

BRANCH_STATE = "w, the displacement in m about its recent mean, whose sign is the branch of the loop"
branch_damper = partial(damper, initial=(0.0,), state=BRANCH_STATE, centred=True)
"""`damper` for a model whose only state is that of its branch (`branch`)."""
utfsm_branch_damper = partial(utfsm_damper, initial=(0.0,), state=BRANCH_STATE, centred=True)
"""The same, with such defaults."""
_BRANCH_WIDTH = 5e-4
"""Displacement in m over which a branch changes sign, tanh(w / 0.5 mm)."""
BRANCH_MEMORY = 1.0
"""Time in s over which the branch state forgets the mean of the motion.

Both are chosen by us, against swept-sine and seismic records of the damper of UTFSM: 1 s and 0.5 mm predict
motion off centre better than sgn(x) itself (swept sine at 1 A: rms 358 against 506 N) and leave the loops of
centred sines above 0.3 Hz nearly as they are.
"""


@jit
def power(base: float, exponent: float) -> float:
    """Return `base ** exponent` for a base >= 0, without the cost of a general power for 1 and 2."""
    if exponent == 2.0:
        return base * base
    return base if exponent == 1.0 else float(base**exponent)


@jit
def cubic(c: tuple[float, ...], i: float) -> float:
    """Return `c[0] + c[1] i + c[2] i^2 + c[3] i^3`."""
    return c[0] + i * (c[1] + i * (c[2] + i * c[3]))


@jit
def quadratic(c: tuple[float, ...], i: float) -> float:
    """Return `c[0] + c[1] i + c[2] i^2`."""
    return c[0] + i * (c[1] + i * c[2])


@jit
def between(first: float, last: float, i: float, end: float) -> float:
    """Return the law that is `first` at zero current, `last` at the current `end`, linear between, held beyond."""
    return first + (last - first) * min(i, end) / end


@jit
def bouc_wen_rate(A: float, beta: float, gamma: float, n: float, r: float, z: float) -> float:
    """Return `A r - beta r |z|^n - gamma |r| z |z|^(n-1)`, the rate of the Bouc-Wen state at velocity r."""
    size = power(abs(z), n)
    signed = math.copysign(size, z)
    return A * r - beta * r * size - gamma * abs(r) * signed


@jit
def branch(z: State) -> float:
    """Return the smoothed sign (-1 to 1) of the displacement about its recent mean.

    It stands for sgn(x), and for -sgn(dv/dt), which is the same for harmonic motion about zero: a measured
    loop has a positive force at v = 0 where x > 0. Taking it from the displacement keeps it causal and free
    of chatter.
    """
    return math.tanh(z[0] / _BRANCH_WIDTH)


@jit
def branch_rate(v: float, z: State) -> State:
    """Return the rate of the branch state, `w' = v - w / 1 s`."""
    return (v - z[0] / BRANCH_MEMORY,)


SETTLING = 1e-3
"""Shortest time in s in which an inner element settles, chosen by us so that explicit steps of 1 ms are stable.

Forces do not depend on it as long as the motion is slow against it: a few hundredths at 10 Hz.
"""
_INERTANCE_TIME = 2e-3
"""Time in s after which the inner speed of an inertance follows the piston, chosen by us."""


@jit
def limited(force: float, limit: float) -> float:
    """Return a force in N held within `limit` of either sign; no force where the limit is below zero."""
    most = max(limit, 0.0)
    return min(max(force, -most), most)


@jit
def slip(force: float, limit: float, c: float) -> float:
    """Return the speed in m/s at which Coulomb friction `limit` beside a dashpot `c` gives way to a force.

    It is 0 for `|force| <= limit`, else `(force - limit sgn(force)) / c`: continuous, and passive for any limit.
    """
    return (force - limited(force, limit)) / c


@jit
def inertance(mass: float, v: float, u: float) -> float:
    """Return the force in N of an inertance behind a dashpot `mass / tau`: `mass dv/dt` where v is slow against tau.

    u is the inner speed, whose rate is `inertance_rate`. The detour needs no acceleration and is passive.
    """
    return mass * inertance_rate(v, u)


@jit
def inertance_rate(v: float, u: float) -> float:
    """Return the rate in m/s^2 of the inner speed, `u' = (v - u) / tau`."""
    return (v - u) / _INERTANCE_TIME
