"""What a rig computes from numbers that seldom change, held from step to step beside the numbers it came from.

The numbers are parameters and the temperature, and another program may change any of them between two steps. They are
compared at every step, so that a held value is always the one that would be computed.
"""

import math
from typing import NamedTuple

from seatsim.compilation.jit import jit
from seatsim.kernel.generic import scaling_at
from seatsim.kernel.step import relaxed
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling


class Held(NamedTuple):
    """Shares of a current that remain after half a step where it rises and falls, and temperature factors.

    `rate` and `rate_fall` in 1/s are those of the coil that the shares hold for; the scaling holds for `factors` at a
    `temperature` in degC.
    """

    rate: float
    rate_fall: float
    kept: tuple[float, float]
    factors: TemperatureFactors
    temperature: float
    scaling: TemperatureScaling


def nothing_held() -> Held:
    """Return what agrees with no numbers, so that the first step computes everything."""
    return Held(math.nan, math.nan, (0.0, 0.0), TemperatureFactors(), math.nan, TemperatureScaling())


@jit
def hold(coil: Coil, step: float, factors: TemperatureFactors, temperature: float, held: Held) -> Held:
    """Return what is held for a coil at a step in s, and for temperature factors at a temperature in degC."""
    if coil.rate != held.rate or coil.rate_fall != held.rate_fall:
        kept = (1.0 - relaxed(coil, 0.0, 1.0, 0.5 * step), relaxed(coil, 1.0, 0.0, 0.5 * step))
        held = Held(coil.rate, coil.rate_fall, kept, held.factors, held.temperature, held.scaling)
    if temperature != held.temperature or _differ(factors, held.factors):
        held = Held(held.rate, held.rate_fall, held.kept, factors, temperature, scaling_at(factors, temperature))
    return held


@jit
def _differ(a: TemperatureFactors, b: TemperatureFactors) -> bool:
    return (
        a.viscous != b.viscous
        or a.stiffness != b.stiffness
        or a.yield_force != b.yield_force
        or (a.reference != b.reference)
    )
