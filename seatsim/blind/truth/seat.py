"""The true seat: suspension `Fs = kf x + cf v`, cushion `Fc = kc y + cc y'` (N, positive in tension), and the driver.

Beside them stand buffers, linkage friction, bushing and creep; what foam and cover do; inner bodies on springs, feet on
the floor, muscles that answer late.
"""

import math

from seatsim.blind.truth import state
from seatsim.blind.truth.state import FASTEST, MICRO_DAMPING, RigParameters, bristle_rate, compiled
from seatsim.schema.arrays import Array

_DEEPEST = 6.0
"""Depth of an exponential buffer over its length, beyond which its force grows no further (400 times its scale)."""
_FARTHEST = 4.0
"""The same for the hyperbolic sine of the spring (27 times its scale)."""
_LEAST_FRICTION = 0.2
"""Of the friction at mid travel, where it falls with travel; it never changes its sign."""
_DEEPEST_FOAM = 3.0
"""Deflection of an exponential foam over its length, beyond which its force grows no further (19 times its scale)."""


@compiled
def _stop_force(x: float, v: float, p: RigParameters) -> float:
    """Return the buffer force: rubber `k d^1.5 (1 + loss d')`, or an exponential foam buffer; never pulls.

    The power 1.5 is that of Hertz' contact of a sphere; the loss is that of Hunt and Crossley (1975).
    """
    side = 1.0 if x > 0.0 else -1.0
    depth = x - p.stop_gap_up if x > 0.0 else -x - p.stop_gap_down
    if depth <= 0.0 or p.stop_stiffness == 0.0:
        return 0.0
    if p.stop_power == 0.0:
        size = p.stop_stiffness * p.stop_length * (math.exp(min(depth / p.stop_length, _DEEPEST)) - 1.0)
    else:
        size = p.stop_stiffness * depth**p.stop_power
    return side * max(size * (1.0 + p.stop_loss * side * v), 0.0)


@compiled
def _spring_force(x: float, p: RigParameters) -> float:
    """Return the spring force: linear; hardening as sinh or by a helper leaf; softening with the lever's angle."""
    force = p.kf * x
    if p.sinh_length > 0.0:
        u = min(max(x / p.sinh_length, -_FARTHEST), _FARTHEST)
        force = p.kf * p.sinh_length * math.sinh(u)
    if p.leaf_gain != 0.0:
        force += p.kf * p.leaf_gain * x * x * x / (x * x + p.leaf_length * p.leaf_length)
    if p.softening_length > 0.0:
        force = force / (1.0 + (x / p.softening_length) ** 2)
    return force


@compiled
def _linkage_friction(y: Array, rates: Array, p: RigParameters) -> float:
    """Return the linkage friction (LuGre), which may depend on travel, N, and write the rate of its bristle."""
    v = y[state.V]
    rate = bristle_rate(y[state.FRICTION], v, p.friction_length, p.friction_stribeck, p.friction_speed)
    rates[state.FRICTION] = rate
    sticking = math.exp(-((v / p.friction_speed) ** 2))
    level = p.friction_force * max(1.0 + p.friction_travel * y[state.X], _LEAST_FRICTION)
    return float(level * (y[state.FRICTION] + MICRO_DAMPING * sticking * rate) + p.friction_damping * v)


@compiled
def suspension_force(y: Array, rates: Array, p: RigParameters) -> float:
    """Return Fs, N, and write the rates of friction, bushing (a Maxwell element) and creep (a Kelvin-Voigt element)."""
    x = y[state.X]
    v = y[state.V]
    force = _spring_force(x, p) + p.cf * v + _stop_force(x, v, p)
    if p.friction_force != 0.0:
        force += _linkage_friction(y, rates, p)
    if p.bushing_stiffness != 0.0:
        rates[state.BUSHING] = v - y[state.BUSHING] / p.bushing_time
        force += p.bushing_stiffness * y[state.BUSHING]
    if p.creep_stiffness != 0.0:
        rates[state.CREEP] = (x - y[state.CREEP]) / p.creep_time
        force -= p.creep_stiffness * y[state.CREEP]
    return float(force)


@compiled
def _foam_force(d: float, w: float, p: RigParameters) -> float:
    """Return the force of foam deflected by d at speed w, N: linear, exponential, or polynomial in compression."""
    force = p.kc * d
    damping = p.cc
    if p.foam_length > 0.0:
        u = min(max(-d / p.foam_length, -_DEEPEST_FOAM), _DEEPEST_FOAM)
        force = -p.kc * p.foam_length * (math.exp(u) - 1.0)
    if p.foam_poly != 0.0:
        u = max(-d, 0.0) / p.foam_scale
        force -= p.kc * p.foam_scale * p.foam_poly * (u * u + u * u * u)
        damping *= 1.0 + p.foam_loss * p.foam_poly * u
    if p.foam_rate != 0.0:
        damping *= 1.0 + p.foam_rate * abs(w)
    return force + damping * w


@compiled
def _limit_tension(force: float, p: RigParameters) -> float:
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
    force = _foam_force(y[state.Y], w, p)
    if p.zener_stiffness != 0.0:
        rates[state.ZENER] = w - y[state.ZENER] / p.zener_time
        force += p.zener_stiffness * y[state.ZENER]
    if p.cover_force != 0.0:
        rate = min(abs(w) / p.cover_length, FASTEST)
        rates[state.COVER] = rate * ((1.0 if w > 0.0 else -1.0) - y[state.COVER])
        force += p.cover_force * y[state.COVER]
    if p.separation_force > 0.0:
        force = _limit_tension(force, p)
    return float(force)


@compiled
def occupant_force(y: Array, late: float, p: RigParameters) -> float:
    """Return the extra force on the seated mass, N; `late` is the speed y' of one muscle delay ago, m/s."""
    force = 0.0
    m = p.m * (1.0 + p.mass_gain)
    if p.body_fraction > 0.0:
        mass = m * p.body_fraction
        force += mass * p.body_rate * (p.body_rate * y[state.BODY] + 2.0 * p.body_damping * y[state.BODY_V])
    if p.second_body_fraction > 0.0:
        mass = m * p.second_body_fraction
        w = p.second_body_rate
        force += mass * w * (w * y[state.BODY2] + 2.0 * p.second_body_damping * y[state.BODY2_V])
    force -= p.foot_stiffness * (y[state.X] + y[state.Y]) + p.foot_damping * (y[state.V] + y[state.W])
    return float(force - p.muscle_gain * late)


@compiled
def write_occupant_rates(y: Array, rates: Array, seated: float, p: RigParameters) -> None:
    """Write the rates of the inner bodies, `q'' = -w^2 q - 2 z w q' - zc''`; `seated` is zc'', m/s^2."""
    if p.body_fraction > 0.0:
        rates[state.BODY] = y[state.BODY_V]
        restoring = p.body_rate * (p.body_rate * y[state.BODY] + 2.0 * p.body_damping * y[state.BODY_V])
        rates[state.BODY_V] = -restoring - seated
    if p.second_body_fraction > 0.0:
        w = p.second_body_rate
        rates[state.BODY2] = y[state.BODY2_V]
        restoring = w * (w * y[state.BODY2] + 2.0 * p.second_body_damping * y[state.BODY2_V])
        rates[state.BODY2_V] = -restoring - seated
