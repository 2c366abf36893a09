"""The compiled rig: records that the loop carries, and the time derivative of its state."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from seatsim.jit import jit
from seatsim.kernel.generic import Tuple, coulomb, force, rates
from seatsim.plant import Plant
from seatsim.suspension import SuspensionExtras, extra_force
from seatsim.temperature import Heat

MECHANICAL = 8
"""Length of the mechanical state: x, v, xc, vc, then the work of floor, damper, suspension and cushion in J."""


HELD = 2.0
"""Value of `slip` for a suspension that the set-valued friction holds at rest; -1 and 1 are directions of sliding."""


class Rig(NamedTuple):
    """Everything that moves: plant, damper, and what the suspension has beyond the plant's linear law."""

    plant: Plant
    damper: Any
    suspension: SuspensionExtras


class Flow(NamedTuple):
    """What the derivative tells beside the rates: damper force, set-valued friction and its limit, all in N."""

    damper_force: float
    friction: float
    friction_limit: float


@jit
def derivative(rig: Rig, s: Tuple, floor: float, current: float, heat: Heat, slip: float) -> tuple[Tuple, Flow]:
    """Return the rates of the state `(x, v, xc, vc, works..., *z)` and the flow.

    x = zs - z0, xc = zc - zs; `floor` is z0'' in m/s^2. `slip` is the direction of sliding of the set-valued friction,
    -1 or 1, or HELD, where the friction is the reaction that holds the suspension, whatever its limit. At 0 the sign of
    v decides, and at v = 0 whether the reaction is within the limit.
    """
    plant = rig.plant
    x, v, xc, vc = s[0], s[1], s[2], s[3]
    z = s[8:]
    ratio = plant.damper_ratio
    smooth = force(rig.damper, ratio * x, ratio * v, current, heat, z)
    spring = plant.suspension_stiffness * x
    resistance = plant.suspension_damping * v + extra_force(rig.suspension, x, v)
    cushion = plant.cushion_stiffness * xc + plant.cushion_damping * vc
    free = (cushion - spring - resistance - ratio * smooth) / plant.frame_mass - floor

    damper_limit = ratio * coulomb(rig.damper, current, heat)
    limit = damper_limit + rig.suspension.friction
    friction, acceleration = _friction(free, v, slip, limit, plant.frame_mass)
    share = friction / limit if limit > 0.0 else 0.0
    damper_force = smooth + share * damper_limit / ratio
    frame = acceleration + floor
    cushion_rate = -cushion / plant.driver_mass - frame

    works = (
        -(plant.frame_mass * v + plant.driver_mass * (v + vc)) * floor,
        ratio * damper_force * v,
        (resistance + share * rig.suspension.friction) * v,
        plant.cushion_damping * vc * vc,
    )
    dz = rates(rig.damper, ratio * x, ratio * v, current, heat, z)
    return (v, acceleration, vc, cushion_rate) + works + dz, Flow(damper_force, friction, limit)


@jit
def _friction(free: float, v: float, slip: float, limit: float, mass: float) -> tuple[float, float]:
    """Return the friction in N and the relative acceleration in m/s^2 under it."""
    if slip == HELD:
        return mass * free, 0.0
    if limit <= 0.0:
        return 0.0, free
    if slip == 0.0:
        if v == 0.0 and abs(mass * free) <= limit:
            return mass * free, 0.0
        slip = math.copysign(1.0, free if v == 0.0 else v)
    return slip * limit, free - slip * limit / mass
