"""Suspension, cushion, occupant and base of the true seat: forces in N, lengths in m, signs of the contract.

`ms zs'' = -Fs + Fc - Fd`, `m zc'' = -Fc`, `Fs = kf x + cf v`, `Fc = kc y + cc y'`, `x = zs - z0`, `y = zc - zs`.
"""

from __future__ import annotations

import math

from seatsim.blind.truth import slots as s
from seatsim.blind.truth.compiled import Parameters, compiled
from seatsim.blind.truth.damper_physics import FASTEST, bristle_rate
from seatsim.blind.truth.slots import Array


@compiled
def stop_force(x: float, v: float, p: Parameters) -> float:
    """Return the buffer force: rubber `k d^1.5 (1 + loss d')`, or an exponential foam buffer; never pulls."""
    side = 1.0 if x > 0.0 else -1.0
    depth = x - p.stop_gap_up if x > 0.0 else -x - p.stop_gap_down
    if depth <= 0.0 or p.stop_k == 0.0:
        return 0.0
    if p.stop_power == 0.0:
        size = p.stop_k * p.stop_length * (math.exp(min(depth / p.stop_length, 6.0)) - 1.0)
    else:
        size = p.stop_k * depth**p.stop_power
    return side * max(size * (1.0 + p.stop_loss * side * v), 0.0)


@compiled
def spring_force(x: float, p: Parameters) -> float:
    """Return the spring force: linear; hardening as sinh or by a helper leaf; softening with the lever's angle."""
    force = p.kf * x
    if p.sinh_length > 0.0:
        u = min(max(x / p.sinh_length, -4.0), 4.0)
        force = p.kf * p.sinh_length * math.sinh(u)
    if p.leaf_gain != 0.0:
        force += p.kf * p.leaf_gain * x * x * x / (x * x + p.leaf_length * p.leaf_length)
    if p.soften_length > 0.0:
        force = force / (1.0 + (x / p.soften_length) ** 2)
    return force


@compiled
def suspension_force(y: Array, dy: Array, p: Parameters) -> float:
    """Return Fs: spring, damping, buffers, linkage friction (LuGre, may depend on travel), bushing, creep."""
    x = y[s.X]
    v = y[s.V]
    force = spring_force(x, p) + p.cf * v + stop_force(x, v, p)
    if p.fr_force != 0.0:
        rate = bristle_rate(y[s.FRIC], v, p.fr_length, p.fr_stribeck, p.fr_speed)
        dy[s.FRIC] = rate
        sticky = math.exp(-((v / p.fr_speed) ** 2))
        level = p.fr_force * max(1.0 + p.fr_travel * x, 0.2)
        force += level * (y[s.FRIC] + 0.001 * sticky * rate) + p.fr_damping * v
    if p.bush_k != 0.0:
        dy[s.BUSH] = v - y[s.BUSH] / p.bush_tau
        force += p.bush_k * y[s.BUSH]
    if p.creep_k != 0.0:
        dy[s.CREEP] = (x - y[s.CREEP]) / p.creep_tau
        force -= p.creep_k * y[s.CREEP]
    return float(force)


@compiled
def cushion_force(y: Array, dy: Array, p: Parameters) -> float:
    """Return Fc, positive in tension: foam (exponential or polynomial), lift-off, memory foam, cover friction."""
    d = y[s.Y]
    w = y[s.W]
    force = p.kc * d
    damping = p.cc
    if p.foam_length > 0.0:
        u = min(max(-d / p.foam_length, -3.0), 3.0)
        force = -p.kc * p.foam_length * (math.exp(u) - 1.0)
    if p.foam_poly != 0.0:
        u = max(-d, 0.0) / p.foam_scale
        force -= p.kc * p.foam_scale * p.foam_poly * (u * u + u * u * u)
        damping *= 1.0 + p.foam_loss * p.foam_poly * u
    if p.foam_v != 0.0:
        damping *= 1.0 + p.foam_v * abs(w)
    force += damping * w
    if p.zener_k != 0.0:
        dy[s.ZENER] = w - y[s.ZENER] / p.zener_tau
        force += p.zener_k * y[s.ZENER]
    if p.cover_force != 0.0:
        rate = min(abs(w) / p.cover_length, FASTEST)
        dy[s.COVER] = rate * ((1.0 if w > 0.0 else -1.0) - y[s.COVER])
        force += p.cover_force * y[s.COVER]
    if p.lift_force > 0.0:
        if p.lift_form == 1.0:
            u = (force - p.lift_force) / p.lift_width
            over = p.lift_width * (u + math.log1p(math.exp(-u)) if u > 0.0 else math.log1p(math.exp(u)))
            force -= over
        elif force > 0.0:
            force = force / (1.0 + (force / p.lift_force) ** 4) ** 0.25
    return float(force)


@compiled
def occupant_force(y: Array, late: float, p: Parameters) -> float:
    """Return the extra force on the seated mass: inner bodies, feet on the floor, muscles that answer late."""
    force = 0.0
    m = p.m * (1.0 + p.mass_gain)
    if p.body_fraction > 0.0:
        mass = m * p.body_fraction
        force += mass * p.body_rate * (p.body_rate * y[s.BODY] + 2.0 * p.body_damping * y[s.BODY_V])
    if p.body2_fraction > 0.0:
        mass = m * p.body2_fraction
        force += mass * p.body2_rate * (p.body2_rate * y[s.BODY2] + 2.0 * p.body2_damping * y[s.BODY2_V])
    force -= p.foot_k * (y[s.X] + y[s.Y]) + p.foot_c * (y[s.V] + y[s.W])
    return float(force - p.muscle_gain * late)


@compiled
def occupant_rates(y: Array, dy: Array, seated: float, p: Parameters) -> None:
    """Write the rates of the inner bodies: `q'' = -w^2 q - 2 z w q' - zc''`."""
    if p.body_fraction > 0.0:
        dy[s.BODY] = y[s.BODY_V]
        pull = p.body_rate * (p.body_rate * y[s.BODY] + 2.0 * p.body_damping * y[s.BODY_V])
        dy[s.BODY_V] = -pull - seated
    if p.body2_fraction > 0.0:
        dy[s.BODY2] = y[s.BODY2_V]
        pull = p.body2_rate * (p.body2_rate * y[s.BODY2] + 2.0 * p.body2_damping * y[s.BODY2_V])
        dy[s.BODY2_V] = -pull - seated
