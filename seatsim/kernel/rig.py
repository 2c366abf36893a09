"""The compiled rig: records that the loop carries, and the time derivative of its state."""

from __future__ import annotations

import math
from typing import NamedTuple

from seatsim.compilation.jit import jit
from seatsim.kernel.generic import DamperModel, force_and_rates, friction_limit
from seatsim.kernel.hooks import Effects, effect_state, fold_hook, join_hook, leading_state, sum_hook
from seatsim.rig.plant import Plant
from seatsim.rig.state import CUSHION_DISPLACEMENT, CUSHION_VELOCITY, DISPLACEMENT, MECHANICAL, VELOCITY, State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.registry import register

STICKING = 2.0
"""Value of `slip` for a suspension stuck by the set-valued friction; -1 and 1 are directions of sliding."""


class SeatMotion(NamedTuple):
    """Motion of the seat: suspension x, v in m and m/s; cushion xc, vc; accelerations of frame and driver in m/s^2."""

    x: float
    v: float
    xc: float
    vc: float
    frame: float
    driver: float


class Disturbance(NamedTuple):
    """What excites the seat: floor acceleration in m/s^2, forces on frame and driver in N, upward positive."""

    floor: float
    frame_force: float
    driver_force: float


class Rig(NamedTuple):
    """Everything that moves: plant, damper, and effects on suspension, cushion and driver.

    An effect may have `suspension_force(plant, x, v, z)`, added to the spring; `linkage_friction(z)`, set-valued;
    `cushion_force(force, plant, xc, vc, z)`, which changes the cushion's; `inner_mass(plant, z)`, carried by the
    driver's body through `inner_force(plant, z)`; and `rates(plant, motion, z)` of its own state.
    """

    plant: Plant
    damper: DamperModel
    effects: Effects = ()


suspension_force = sum_hook("suspension_force")
linkage_friction = sum_hook("linkage_friction")
cushion_force = fold_hook("cushion_force")
inner_mass = sum_hook("inner_mass")
inner_force = sum_hook("inner_force")
effect_rates = join_hook("rates")


class RigForces(NamedTuple):
    """Forces that the derivative returns with the rates: damper force, set-valued friction and its limit, all in N.

    The damper force is that of the load cell at the damper; friction and limit are those on the suspension, damper and
    linkage together.
    """

    damper_force: float
    friction: float
    friction_limit: float


@jit
def derivative(
    rig: Rig, s: State, disturbance: Disturbance, current: float, scaling: TemperatureScaling, slip: float
) -> tuple[State, RigForces]:
    """Return the rates of the state `(x, v, xc, vc, works..., *z, *effects)` and the forces.

        ms zs'' = -kf x - cf v - effects + kc xc + cc vc - r Fd - friction + frame force
        mb zc'' = -kc xc - cc vc + inner force + driver force,   mb = m - inner mass

    x = zs - z0, xc = zc - zs in m; r is the damper's stroke per suspension displacement, Fd its force. `current` [A] is
    that of the coil. `slip` is the direction of sliding of the set-valued friction, -1 or 1. In STICKING the friction
    is the reaction that keeps the suspension at rest, whatever its limit. At 0 the sign of v decides, and at v = 0
    whether the reaction is within the limit.

    Source: Yu et al. 2019 (Front. Mater. 6:227), eqs 13 and 14, with the effects' terms. The works are the integrals of
    the powers, so that supplied less dissipated work is the energy stored (see `seatsim.rig.state`).
    """
    plant, effects = rig.plant, rig.effects
    x, v, xc, vc = s[DISPLACEMENT], s[VELOCITY], s[CUSHION_DISPLACEMENT], s[CUSHION_VELOCITY]
    z, ze = damper_state(rig, s), effect_state(effects, s)
    ratio = plant.damper_ratio
    smooth, dz = force_and_rates(rig.damper, ratio * x, ratio * v, current, scaling, z)
    spring = plant.suspension_stiffness * x
    resistance = plant.suspension_damping * v + suspension_force(effects, ze, plant, x, v)
    linear = plant.cushion_stiffness * xc + plant.cushion_damping * vc
    cushion = cushion_force(effects, ze, linear, plant, xc, vc)
    push = disturbance.frame_force
    # Times the reciprocal of a mass: compilers find that it is the same in every stage of a step, and divide once.
    free = (cushion - spring - resistance - ratio * smooth + push) * (1.0 / plant.frame_mass) - disturbance.floor

    coulomb = friction_limit(rig.damper, ratio * v, current, scaling, z)
    linkage = linkage_friction(effects, ze)
    limit = ratio * coulomb + linkage
    friction, acceleration = _friction(free, v, slip, limit, plant.frame_mass)
    # While sticking, the friction is below its limit, and the load cell's part of it is not determined: damper and
    # linkage bear it in proportion to their limits.
    share = friction / limit if limit > 0.0 else 0.0
    damper_force = smooth + share * coulomb
    frame = acceleration + disturbance.floor
    body = plant.driver_mass - inner_mass(effects, ze, plant)
    driver = (inner_force(effects, ze, plant) - cushion + disturbance.driver_force) * (1.0 / body)

    works = (
        disturbance.frame_force * v
        + disturbance.driver_force * (v + vc)
        - (plant.frame_mass * v + plant.driver_mass * (v + vc)) * disturbance.floor,
        ratio * damper_force * v,
        (resistance + share * linkage) * v,
        (cushion - plant.cushion_stiffness * xc) * vc,
    )
    de = effect_rates(effects, ze, plant, SeatMotion(x, v, xc, vc, frame, driver))
    return (v, acceleration, vc, driver - frame) + works + dz + de, RigForces(damper_force, friction, limit)


@jit
def damper_state(rig: Rig, s: State) -> State:
    """Return the damper's part of the state of a rig."""
    return leading_state(rig.effects, s[MECHANICAL:])


@jit
def _friction(free: float, v: float, slip: float, limit: float, mass: float) -> tuple[float, float]:
    """Return the friction in N and the relative acceleration in m/s^2 under it; `free` is that without friction."""
    if slip == STICKING:
        return mass * free, 0.0
    if limit <= 0.0:
        return 0.0, free
    if slip == 0.0:
        if v == 0.0 and abs(mass * free) <= limit:
            return mass * free, 0.0
        slip = math.copysign(1.0, free if v == 0.0 else v)
    return slip * limit, free - slip * limit / mass


MASSES = 4
"""Masses that a body has room for."""
_Vector = tuple[float, ...]
_Matrix = tuple[_Vector, ...]


class BodySpecification(NamedTuple):
    """What the loop knows of a body: its state at rest, displacements from the contact point in m and their rates."""

    initial: State


@register("body", "seated_body", BodySpecification((0.0,) * (2 * MASSES)))
class SeatedBody(NamedTuple):
    """Masses linked by springs and dashpots to each other and to the point of contact.

        M (x'' + zc'' 1) = -K x - C x',   f = 1' (K x + C x')

    x are the displacements of the masses from the contact point zc, f is the force with which they push it upward;
    where the sum over a column of K or C is not 0 its mass is linked to the contact point. A mass of 0 stays at rest.
    """

    masses: _Vector
    stiffness: _Matrix
    damping: _Matrix

    def inner_mass(self, plant: Plant, z: State) -> float:
        """Return the masses in kg that the contact point carries."""
        return self.masses[0] + self.masses[1] + self.masses[2] + self.masses[3]

    def inner_force(self, plant: Plant, z: State) -> float:
        """Return the upward force of the masses on the contact point in N."""
        pull = _pull(self.stiffness, self.damping, z)
        return pull[0] + pull[1] + pull[2] + pull[3]

    def rates(self, plant: Plant, motion: SeatMotion, z: State) -> State:
        """Return the rates of displacements and speeds."""
        pull, mass, base = _pull(self.stiffness, self.damping, z), self.masses, motion.driver
        return (
            z[4], z[5], z[6], z[7],
            _fall(pull[0], mass[0], base), _fall(pull[1], mass[1], base),
            _fall(pull[2], mass[2], base), _fall(pull[3], mass[3], base),
        )  # fmt: skip


@jit
def _pull(stiffness: _Matrix, damping: _Matrix, z: State) -> _Vector:
    """Return K x + C x' in N."""
    return (
        _row(stiffness[0], damping[0], z),
        _row(stiffness[1], damping[1], z),
        _row(stiffness[2], damping[2], z),
        _row(stiffness[3], damping[3], z),
    )


@jit
def _row(k: _Vector, c: _Vector, z: State) -> float:
    springs = k[0] * z[0] + k[1] * z[1] + k[2] * z[2] + k[3] * z[3]
    return springs + c[0] * z[4] + c[1] * z[5] + c[2] * z[6] + c[3] * z[7]


@jit
def _fall(pull: float, mass: float, base: float) -> float:
    """Return the acceleration of a mass relative to the contact point in m/s^2."""
    return -pull / mass - base if mass > 0.0 else 0.0
