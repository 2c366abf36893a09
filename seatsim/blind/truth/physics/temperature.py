"""Heat of the true damper: three temperatures, and what the fluid's does to viscosity and yield stress."""

from __future__ import annotations

import math

from seatsim.blind.truth.physics import state
from seatsim.blind.truth.physics.compiled import compiled
from seatsim.blind.truth.physics.parameters import RigParameters
from seatsim.schema.arrays import Array

REFERENCE = 20.0
"""degC at which the nominal parameters hold."""
ZERO = 273.15
"""K at 0 degC."""
REFERENCE_KELVIN = 293.15
COLDEST = -15.0
"""K below the reference, where the hyperbola of the viscosity ends before its pole."""


@compiled
def viscous_factor(t: float, p: RigParameters) -> float:
    """Return viscosity at `t` degC over that at 20: Arrhenius `exp(B (1/T - 1/T20))` or `1 / (1 + b (t - 20))`."""
    if p.fade_law == 1.0:
        return math.exp(p.fade_viscous * (1000.0 / (t + ZERO) - 1000.0 / REFERENCE_KELVIN))
    return 1.0 / (1.0 + p.fade_viscous * max(t - REFERENCE, COLDEST))


@compiled
def yield_factor(t: float, p: RigParameters) -> float:
    """Return yield stress at `t` degC over that at 20: exponential or a power of the absolute temperature."""
    if p.fade_law == 1.0:
        return math.exp(-p.fade_yield * (t - REFERENCE))
    return float(((t + ZERO) / REFERENCE_KELVIN) ** (-p.fade_yield))


@compiled
def write_heat_rates(y: Array, rates: Array, power: float, p: RigParameters) -> None:
    """Write the rates of fluid, housing and thermometer, K/s: the fluid is heated by |power| and cools to the air."""
    flow = p.fluid_to_housing * (y[state.T_FLUID] - y[state.T_HOUSING])
    rates[state.T_FLUID] = (abs(power) - flow) / p.fluid_heat
    rates[state.T_HOUSING] = (flow - p.housing_to_air * (y[state.T_HOUSING] - p.t_ambient)) / p.housing_heat
    rates[state.T_THERMOMETER] = (y[state.T_HOUSING] - y[state.T_THERMOMETER]) / p.thermometer_time
