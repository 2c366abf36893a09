"""Laws that effects of several blocks share."""

from __future__ import annotations

import math

from seatsim.compilation.jit import jit

REFERENCE_DEPTH = 0.01
"""m; depth at which the force of a buffer does not depend on its exponent."""

FRICTIONS: tuple[dict[str, float], ...] = (
    {"force": 20.0, "presliding": 2e-4}, {"force": 20.0, "presliding": 1e-3, "lubrication": 20.0},
    {"force": 120.0, "presliding": 1e-3, "lubrication": 20.0}, {"force": 20.0},
)  # fmt: skip
"""Starts of a friction's fit; the last is set-valued, as the record is by itself."""


@jit
def dahl_rate(presliding: float, v: float, z: float) -> float:
    """Return z' of Dahl's friction, `v (1 - z sgn v) / presliding`; 0 without presliding."""
    if presliding <= 0.0:
        return 0.0
    return v * (1.0 - z * math.copysign(1.0, v)) / presliding


@jit
def buffer(stiffness: float, damping: float, power: float, depth: float, speed: float) -> float:
    """Return the force in N of a buffer compressed by `depth`, which never pulls."""
    push = stiffness * depth * (1.0 + damping * speed)
    if power > 1.0:
        push *= (depth / REFERENCE_DEPTH) ** (power - 1.0)
    return max(0.0, push)
