"""Suspension of the true seat: `Fs = kf x + cf v`, N, and buffers, linkage friction, bushing and creep beside it."""

from __future__ import annotations

import math

from seatsim.blind.truth.physics import state
from seatsim.blind.truth.physics.compiled import compiled
from seatsim.blind.truth.physics.friction import MICRO_DAMPING, bristle_rate
from seatsim.blind.truth.physics.parameters import RigParameters
from seatsim.schema.arrays import Array

DEEPEST = 6.0
"""Depth of an exponential buffer over its length, beyond which its force grows no further (400 times its scale)."""
FARTHEST = 4.0
"""The same for the hyperbolic sine of the spring (27 times its scale)."""
LEAST_FRICTION = 0.2
"""Of the friction at mid travel, where it falls with travel; it never changes its sign."""


@compiled
def stop_force(x: float, v: float, p: RigParameters) -> float:
    """Return the buffer force: rubber `k d^1.5 (1 + loss d')`, or an exponential foam buffer; never pulls.

    The power 1.5 is that of Hertz' contact of a sphere; the loss is that of Hunt and Crossley (1975).
    """
    side = 1.0 if x > 0.0 else -1.0
    depth = x - p.stop_gap_up if x > 0.0 else -x - p.stop_gap_down
    if depth <= 0.0 or p.stop_stiffness == 0.0:
        return 0.0
    if p.stop_power == 0.0:
        size = p.stop_stiffness * p.stop_length * (math.exp(min(depth / p.stop_length, DEEPEST)) - 1.0)
    else:
        size = p.stop_stiffness * depth**p.stop_power
    return side * max(size * (1.0 + p.stop_loss * side * v), 0.0)


@compiled
def spring_force(x: float, p: RigParameters) -> float:
    """Return the spring force: linear; hardening as sinh or by a helper leaf; softening with the lever's angle."""
    force = p.kf * x
    if p.sinh_length > 0.0:
        u = min(max(x / p.sinh_length, -FARTHEST), FARTHEST)
        force = p.kf * p.sinh_length * math.sinh(u)
    if p.leaf_gain != 0.0:
        force += p.kf * p.leaf_gain * x * x * x / (x * x + p.leaf_length * p.leaf_length)
    if p.softening_length > 0.0:
        force = force / (1.0 + (x / p.softening_length) ** 2)
    return force


@compiled
def linkage_friction(y: Array, rates: Array, p: RigParameters) -> float:
    """Return the linkage friction (LuGre), which may depend on travel, N, and write the rate of its bristle."""
    v = y[state.V]
    rate = bristle_rate(y[state.FRICTION], v, p.friction_length, p.friction_stribeck, p.friction_speed)
    rates[state.FRICTION] = rate
    sticking = math.exp(-((v / p.friction_speed) ** 2))
    level = p.friction_force * max(1.0 + p.friction_travel * y[state.X], LEAST_FRICTION)
    return float(level * (y[state.FRICTION] + MICRO_DAMPING * sticking * rate) + p.friction_damping * v)


@compiled
def suspension_force(y: Array, rates: Array, p: RigParameters) -> float:
    """Return Fs, N, and write the rates of friction, bushing (a Maxwell element) and creep (a Kelvin-Voigt element)."""
    x = y[state.X]
    v = y[state.V]
    force = spring_force(x, p) + p.cf * v + stop_force(x, v, p)
    if p.friction_force != 0.0:
        force += linkage_friction(y, rates, p)
    if p.bushing_stiffness != 0.0:
        rates[state.BUSHING] = v - y[state.BUSHING] / p.bushing_time
        force += p.bushing_stiffness * y[state.BUSHING]
    if p.creep_stiffness != 0.0:
        rates[state.CREEP] = (x - y[state.CREEP]) / p.creep_time
        force -= p.creep_stiffness * y[state.CREEP]
    return float(force)
