"""The compiled rig: records that the loop carries, and the time derivative of its state."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from seatsim.compilation.jit import jit
from seatsim.kernel.chain import Effects, before, folded, joined, own, summed
from seatsim.kernel.generic import Tuple, force, friction_limit, rates
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureScaling

MECHANICAL = 8
"""Length of the mechanical state: x, v, xc, vc, then the work of floor, damper, suspension and cushion in J."""


HELD = 2.0
"""Value of `slip` for a suspension that the set-valued friction holds at rest; -1 and 1 are directions of sliding."""


class Motion(NamedTuple):
    """Motion of the seat: suspension x, v in m and m/s; cushion xc, vc; accelerations of frame and driver in m/s^2."""

    x: float
    v: float
    xc: float
    vc: float
    frame: float
    driver: float


class Shake(NamedTuple):
    """What shakes the seat: floor acceleration in m/s^2, forces on frame and driver in N, upward positive."""

    floor: float
    push: float
    lift: float


class Rig(NamedTuple):
    """Everything that moves: plant, damper, and effects on suspension, cushion and driver.

    An effect may have `suspension_force(plant, x, v, z)`, added to the spring; `linkage_friction(z)`, set-valued;
    `cushion_force(force, plant, xc, vc, z)`, which changes the cushion's; `inner_mass(plant, z)`, carried by the
    driver's body through `inner_force(plant, z)`; and `rates(plant, motion, z)` of its own state.
    """

    plant: Plant
    damper: Any
    effects: Effects = ()


suspension_force = summed("suspension_force")
linkage_friction = summed("linkage_friction")
cushion_force = folded("cushion_force")
inner_mass = summed("inner_mass")
inner_force = summed("inner_force")
effect_rates = joined("rates")


class Flow(NamedTuple):
    """What the derivative tells beside the rates: damper force, set-valued friction and its limit, all in N."""

    damper_force: float
    friction: float
    friction_limit: float


@jit
def derivative(
    rig: Rig, s: Tuple, shake: Shake, current: float, scaling: TemperatureScaling, slip: float
) -> tuple[Tuple, Flow]:
    """Return the rates of the state `(x, v, xc, vc, works..., *z, *effects)` and the flow.

    x = zs - z0, xc = zc - zs. `slip` is the direction of sliding of the set-valued friction, -1 or 1, or HELD, where
    the friction is the reaction that holds the suspension, whatever its limit. At 0 the sign of v decides, and at v = 0
    whether the reaction is within the limit.
    """
    plant, effects = rig.plant, rig.effects
    x, v, xc, vc = s[0], s[1], s[2], s[3]
    z, ze = before(effects, s[8:]), own(effects, s[8:])
    ratio = plant.damper_ratio
    smooth = force(rig.damper, ratio * x, ratio * v, current, scaling, z)
    spring = plant.suspension_stiffness * x
    resistance = plant.suspension_damping * v + suspension_force(effects, ze, plant, x, v)
    linear = plant.cushion_stiffness * xc + plant.cushion_damping * vc
    cushion = cushion_force(effects, ze, linear, plant, xc, vc)
    free = (cushion - spring - resistance - ratio * smooth + shake.push) / plant.frame_mass - shake.floor

    damper_limit = ratio * friction_limit(rig.damper, ratio * v, current, scaling, z)
    linkage = linkage_friction(effects, ze)
    limit = damper_limit + linkage
    friction, acceleration = _friction(free, v, slip, limit, plant.frame_mass)
    share = friction / limit if limit > 0.0 else 0.0
    damper_force = smooth + share * damper_limit / ratio
    frame = acceleration + shake.floor
    body = plant.driver_mass - inner_mass(effects, ze, plant)
    driver = (inner_force(effects, ze, plant) - cushion + shake.lift) / body

    works = (
        shake.push * v + shake.lift * (v + vc) - (plant.frame_mass * v + plant.driver_mass * (v + vc)) * shake.floor,
        ratio * damper_force * v,
        (resistance + share * linkage) * v,
        (cushion - plant.cushion_stiffness * xc) * vc,
    )
    dz = rates(rig.damper, ratio * x, ratio * v, current, scaling, z)
    de = effect_rates(effects, ze, plant, Motion(x, v, xc, vc, frame, driver))
    return (v, acceleration, vc, driver - frame) + works + dz + de, Flow(damper_force, friction, limit)


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
