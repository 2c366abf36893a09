"""What the fluid of the true damper feels: three temperatures and what they do to it, and the field of the coil."""

from __future__ import annotations

import math

from seatsim.blind.truth import state
from seatsim.blind.truth.parameters import RigParameters
from seatsim.blind.truth.state import compiled
from seatsim.schema.arrays import Array

REFERENCE = 20.0
"""degC at which the nominal parameters hold."""
ZERO = 273.15
"""K at 0 degC."""
_REFERENCE_KELVIN = 293.15
_COLDEST = -15.0
"""K below the reference, where the hyperbola of the viscosity ends before its pole."""
_SERIES = 1e-3
"""Argument below which the Langevin function is its own tangent, whose closed form would cancel."""
RISE = 200.0
"""1/s, at which a decaying magnetisation follows a rising current: within a row and a half."""


@compiled
def viscous_factor(t: float, p: RigParameters) -> float:
    """Return viscosity at `t` degC over that at 20: Arrhenius `exp(B (1/T - 1/T20))` or `1 / (1 + b (t - 20))`."""
    if p.fade_law == 1.0:
        return math.exp(p.fade_viscous * (1000.0 / (t + ZERO) - 1000.0 / _REFERENCE_KELVIN))
    return 1.0 / (1.0 + p.fade_viscous * max(t - REFERENCE, _COLDEST))


@compiled
def yield_factor(t: float, p: RigParameters) -> float:
    """Return yield stress at `t` degC over that at 20: exponential or a power of the absolute temperature."""
    if p.fade_law == 1.0:
        return math.exp(-p.fade_yield * (t - REFERENCE))
    return float(((t + ZERO) / _REFERENCE_KELVIN) ** (-p.fade_yield))


@compiled
def write_heat_rates(y: Array, rates: Array, power: float, p: RigParameters) -> None:
    """Write the rates of fluid, housing and thermometer, K/s: the fluid is heated by |power| and cools to the air."""
    flow = p.fluid_to_housing * (y[state.T_FLUID] - y[state.T_HOUSING])
    rates[state.T_FLUID] = (abs(power) - flow) / p.fluid_heat
    rates[state.T_HOUSING] = (flow - p.housing_to_air * (y[state.T_HOUSING] - p.t_ambient)) / p.housing_heat
    rates[state.T_THERMOMETER] = (y[state.T_HOUSING] - y[state.T_THERMOMETER]) / p.thermometer_time


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
        if u > _SERIES:
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
