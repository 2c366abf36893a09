"""The floor's motion between two communication points, which another program states at these points alone.

Its acceleration goes on as it changed over the last communication step, unless `floor_jerk` says how. Held, it would be
half a step late, and so would every reversal at which a law switches. The velocity that a law may ask for is the
integral of the acceleration, unless `floor_velocity` states it. An input counts as stated once it is not zero.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from seatsim.compilation.jit import jit

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
