"""Driver on the true seat: a mass, inner bodies on springs, feet on the floor, muscles that answer late."""

from __future__ import annotations

from seatsim.blind.truth.physics import state
from seatsim.blind.truth.physics.compiled import compiled
from seatsim.blind.truth.physics.parameters import RigParameters
from seatsim.schema.arrays import Array


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
