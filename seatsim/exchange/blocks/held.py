"""What a rig holds from step to step: how the floor goes on, and what is computed from numbers that seldom change."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from seatsim.compilation.jit import jit
from seatsim.kernel.generic import scaling_at
from seatsim.kernel.step import relaxed
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling

if TYPE_CHECKING:
    from seatsim.exchange.blocks.rig_motion import RigInputs


class GivenFloor(NamedTuple):
    """What is known of the floor at a communication point.

    `acceleration` in m/s^2 was given at the step of the number `sample`, `rate` in m/s^3 is how it goes on; `velocity`
    in m/s is that of the present step. `has_rate` and `has_velocity` say whether these two inputs are stated.
    """

    acceleration: float = 0.0
    sample: int = 0
    rate: float = 0.0
    velocity: float = 0.0
    has_rate: bool = False
    has_velocity: bool = False


@jit
def follow_floor(u: RigInputs, floor: GivenFloor, age: float, sample: int, step: float) -> GivenFloor:
    """Return what is known of the floor at a step of the number `sample`, `age` s after the inputs were given."""
    has_rate = floor.has_rate or u.floor_jerk != 0.0
    has_velocity = floor.has_velocity or u.floor_velocity != 0.0
    last, begun, rate, velocity = floor.acceleration, floor.sample, floor.rate, floor.velocity
    if has_rate:
        rate = u.floor_jerk
    elif age == 0.0:
        rate = (u.floor_acceleration - last) / ((sample - begun) * step) if sample > begun else 0.0
    if age == 0.0:
        last, begun = u.floor_acceleration, sample
    if has_velocity:
        velocity = u.floor_velocity + age * (u.floor_acceleration + 0.5 * rate * age)
    return GivenFloor(last, begun, rate, velocity, has_rate, has_velocity)


@jit
def leave_floor(floor: GivenFloor, acceleration: float, step: float) -> GivenFloor:
    """Return the same a step later, of a floor with an acceleration in m/s^2 at the step's begin."""
    velocity = floor.velocity + step * (acceleration + 0.5 * floor.rate * step)
    return GivenFloor(floor.acceleration, floor.sample, floor.rate, velocity, floor.has_rate, floor.has_velocity)


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
