"""Pieces of dampers with elements in series: a limited force, slip beyond the limit, an inertance."""

from __future__ import annotations

from seatsim.compilation.jit import jit

SETTLING = 1e-3
"""Shortest time in s in which an inner element settles, chosen by us so that explicit steps of 1 ms are stable.

Forces do not depend on it as long as the motion is slow against it: a few hundredths at 10 Hz.
"""
INERTANCE_TIME = 2e-3
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
    return (v - u) / INERTANCE_TIME
