"""The compiled rig: records that the loop carries, and the time derivative of its state."""

from __future__ import annotations

from typing import Any, NamedTuple

from seatsim.kernel.generic import Tuple, coulomb, force, rates
from seatsim.kernel.options import jit
from seatsim.plant import Plant
from seatsim.suspension import SuspensionExtras, extra_force
from seatsim.temperature import Heat

MECHANICAL = 8
"""Length of the mechanical state: x, v, xc, vc, then the work of floor, damper, suspension and cushion in J."""


class Rig(NamedTuple):
    """Everything that moves: plant, damper, and what the suspension has beyond the plant's linear law."""

    plant: Plant
    damper: Any
    suspension: SuspensionExtras


class Flow(NamedTuple):
    """What the derivative tells beside the rates: damper force [N] and limit of set-valued friction [N]."""

    damper_force: float
    friction_limit: float


@jit
def derivative(
    rig: Rig, s: Tuple, floor: float, current: float, heat: Heat, slip: float
) -> tuple[Tuple, Flow]:
    """Return the rates of the state `(x, v, xc, vc, works..., *z)` and the flow.

    x = zs - z0, xc = zc - zs; `floor` is z0'' in m/s^2. `slip` is the direction of sliding of the set-valued friction,
    -1, 0 or 1; at 0 and v = 0 the friction is the reaction that holds the suspension, up to its limit.
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
    share, acceleration = _friction(free, v, slip, limit, plant.frame_mass)
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
    return (v, acceleration, vc, cushion_rate) + works + dz, Flow(damper_force, limit)


@jit
def _friction(free: float, v: float, slip: float, limit: float, mass: float) -> tuple[float, float]:
    """Return the friction as a share of its limit (-1 to 1) and the relative acceleration under it."""
    if limit <= 0.0:
        return 0.0, free
    if slip == 0.0:
        if v == 0.0:
            if abs(mass * free) <= limit:
                return mass * free / limit, 0.0
            slip = 1.0 if free > 0.0 else -1.0
        else:
            slip = 1.0 if v > 0.0 else -1.0
    return slip, free - slip * limit / mass
