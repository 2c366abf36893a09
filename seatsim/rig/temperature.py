"""Temperature: how it scales a damper's forces, and how the damper warms up."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.schema.fields import param


class TemperatureScaling(NamedTuple):
    """Factors by which temperature scales the viscous, elastic and yield parts of a damper's force (1 = none)."""

    viscous: float = 1.0
    stiffness: float = 1.0
    yield_force: float = 1.0


class TemperatureFactors(NamedTuple):
    """Exponential temperature factors of a damper, `q(T) = q(T0) exp(delta (T - T0))`.

    Source: Yu et al. 2019 (Front. Mater. 6:227) eqs 9-11, where delta1 scales c, delta2 k and delta3 alpha. The paper
    prints no values; its 33 % loss of force and energy from 20 to 80 degC gives delta = ln(0.67)/60 K = -0.0067 1/K
    when all three are equal (derived). Valid for 20-80 degC.
    """

    viscous: Annotated[float, param("1/K", "delta1, of the viscous coefficients", low=-0.1, high=0.1)] = 0.0
    stiffness: Annotated[float, param("1/K", "delta2, of the stiffness", low=-0.1, high=0.1)] = 0.0
    yield_force: Annotated[float, param("1/K", "delta3, of the yield force", low=-0.1, high=0.1)] = 0.0
    reference: Annotated[float, param("degC", "T0, where all factors are 1", low=-50, high=200)] = 20.0


def scaling(factors: TemperatureFactors, temperature: float) -> TemperatureScaling:
    """Return the factors at a damper temperature in degC (Yu et al. 2019, eqs 9-11)."""
    rise = temperature - factors.reference
    return TemperatureScaling(
        math.exp(factors.viscous * rise), math.exp(factors.stiffness * rise), math.exp(factors.yield_force * rise)
    )


class Thermal(NamedTuple):
    """Lumped thermal state of the damper, `C dT/dt = |F v| + i^2 R - h (T - T_ambient)`.

    One node, no radiation; C and h are chosen by the user (no published values for seat dampers were found; the
    defaults suit a 0.8 kg steel body with 50 ml of fluid in still air).
    """

    start: Annotated[float, param("degC", "temperature at time zero", low=-50, high=200, usual=(-40, 130))] = 20.0
    ambient: Annotated[float, param("degC", "temperature of the surroundings", low=-50, high=200, usual=(-40, 80))] = (
        20.0
    )
    heat_capacity: Annotated[float, param("J/K", "lumped heat capacity C of the damper", above=0)] = 500.0
    conductance: Annotated[float, param("W/K", "heat loss h to the surroundings", low=0)] = 1.0
