"""Cushion of the true seat: `Fc = kc y + cc y'`, N, positive in tension, and what foam and cover do besides."""

from __future__ import annotations

import math

from seatsim.blind.truth.physics import state
from seatsim.blind.truth.physics.compiled import compiled
from seatsim.blind.truth.physics.friction import FASTEST
from seatsim.blind.truth.physics.parameters import RigParameters
from seatsim.schema.arrays import Array

DEEPEST = 3.0
"""Deflection of an exponential foam over its length, beyond which its force grows no further (19 times its scale)."""


@compiled
def foam_force(d: float, w: float, p: RigParameters) -> float:
    """Return the force of foam deflected by d at speed w, N: linear, exponential, or polynomial in compression."""
    force = p.kc * d
    damping = p.cc
    if p.foam_length > 0.0:
        u = min(max(-d / p.foam_length, -DEEPEST), DEEPEST)
        force = -p.kc * p.foam_length * (math.exp(u) - 1.0)
    if p.foam_poly != 0.0:
        u = max(-d, 0.0) / p.foam_scale
        force -= p.kc * p.foam_scale * p.foam_poly * (u * u + u * u * u)
        damping *= 1.0 + p.foam_loss * p.foam_poly * u
    if p.foam_rate != 0.0:
        damping *= 1.0 + p.foam_rate * abs(w)
    return force + damping * w


@compiled
def limit_tension(force: float, p: RigParameters) -> float:
    """Return the cushion force where driver and cushion separate: its tension is limited, softly or by a power, N."""
    if p.separation_law == 1.0:
        u = (force - p.separation_force) / p.separation_width
        # the soft plus, written so that no exponential overflows on either side
        over = p.separation_width * (u + math.log1p(math.exp(-u)) if u > 0.0 else math.log1p(math.exp(u)))
        return force - over
    if force > 0.0:
        return float(force / (1.0 + (force / p.separation_force) ** 4) ** 0.25)
    return force


@compiled
def cushion_force(y: Array, rates: Array, p: RigParameters) -> float:
    """Return Fc, N: foam, memory foam (a Maxwell element), friction of the cover (Dahl); all of it may separate."""
    w = y[state.W]
    force = foam_force(y[state.Y], w, p)
    if p.zener_stiffness != 0.0:
        rates[state.ZENER] = w - y[state.ZENER] / p.zener_time
        force += p.zener_stiffness * y[state.ZENER]
    if p.cover_force != 0.0:
        rate = min(abs(w) / p.cover_length, FASTEST)
        rates[state.COVER] = rate * ((1.0 if w > 0.0 else -1.0) - y[state.COVER])
        force += p.cover_force * y[state.COVER]
    if p.separation_force > 0.0:
        force = limit_tension(force, p)
    return float(force)
