"""Dry friction of seal and linkage: a LuGre bristle (Canudas de Wit et al. 1995), in shares of the sliding force."""

from __future__ import annotations

import math

from seatsim.blind.truth.physics.compiled import compiled

FASTEST = 15000.0
"""Bound on the rate of a bristle, 1/s: 1.5 per step of 0.1 ms, inside the stability limit of Runge-Kutta 4 (2.78)."""
MICRO_DAMPING = 0.001
"""Damping of the bristles, s: keeps a sticking friction from ringing; it acts below the Stribeck speed only."""


@compiled
def bristle_rate(deflection: float, v: float, length: float, stribeck: float, speed: float) -> float:
    """Return the rate of the bristle `s`, in shares of the sliding force, 1/s.

    `s' = |v| / length (sign v - s / G(v))` with `G(v) = 1 + (stribeck - 1) exp(-(v / speed)^2)`.
    """
    level = 1.0 + (stribeck - 1.0) * math.exp(-((v / speed) ** 2))
    rate = min(abs(v) / length, FASTEST)
    return rate * ((1.0 if v > 0.0 else -1.0) - deflection / level)
