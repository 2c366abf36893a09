"""From the current in the winding to the field that the fluid feels, expressed as a current, A."""

from __future__ import annotations

import math

from seatsim.blind.truth.physics import state
from seatsim.blind.truth.physics.compiled import compiled
from seatsim.blind.truth.physics.parameters import RigParameters
from seatsim.schema.arrays import Array

SERIES = 1e-3
"""Argument below which the Langevin function is its own tangent, whose closed form would cancel."""
RISE = 200.0
"""1/s, at which a decaying magnetisation follows a rising current: within a row and a half."""


@compiled
def yield_current(y: Array, memory: Array, p: RigParameters) -> float:
    """Return the current that the yield force feels, A.

    Remanence: mean of relays with several widths (Preisach), or a magnetisation that rises at once and decays slowly.
    Saturation: Froehlich `i / (1 + b i)` or Langevin `I (coth(3 i / I) - I / (3 i))`.
    """
    i: float = y[state.CURRENT]
    felt = i
    if p.relay_share != 0.0:
        felt += p.relay_share * (memory[state.RELAYS_MEAN] - i)
    if p.remanence_gain != 0.0:
        felt += p.remanence_gain * (y[state.MAGNETISATION] - i)
    if p.saturation_froehlich != 0.0:
        felt = felt / (1.0 + p.saturation_froehlich * max(felt, 0.0))
    if p.saturation_langevin != 0.0:
        u = 3.0 * felt * p.saturation_langevin
        if u > SERIES:
            felt = (1.0 / math.tanh(u) - 1.0 / u) / p.saturation_langevin
    return felt


@compiled
def write_magnetisation_rate(y: Array, rates: Array, p: RigParameters) -> None:
    """Write the rate of a magnetisation that follows a rising current and decays after a falling one.

    The further the current has fallen, the faster it decays: `(0.4 + 2 |di|) / tau`, as domains need a field to turn.
    """
    if p.remanence_gain != 0.0:
        rise = y[state.CURRENT] - y[state.MAGNETISATION]
        fall_rate = rise * (0.4 - 2.0 * rise) / p.remanence_time
        rates[state.MAGNETISATION] = rise * RISE if rise > 0.0 else fall_rate


@compiled
def update_relays(y: Array, memory: Array, relays: Array, p: RigParameters) -> None:
    """Switch the hysteresis relays (Preisach 1935) with the current, and keep their mean.

    Relay k is centred at `(k + 1/2) / N` A; widths of 0.4 to 1.6 times the mean are dealt out in steps of seven, which
    shares no divisor with N, so that width and centre are uncorrelated.
    """
    total = 0.0
    for k in range(state.RELAYS):
        half = 0.5 * p.relay_width * (0.4 + 1.2 * ((k * 7) % state.RELAYS) / state.RELAYS)
        centre = (k + 0.5) / state.RELAYS
        if y[state.CURRENT] > centre + half:
            relays[k] = 1.0
        elif y[state.CURRENT] < centre - half:
            relays[k] = 0.0
        total += relays[k]
    memory[state.RELAYS_MEAN] = total / state.RELAYS
