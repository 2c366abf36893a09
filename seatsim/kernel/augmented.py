"""A damper with effects: a damper record that the kernel treats like any other.

    P   = F_damper(x, v, i) with the yield part at its effective current i_y, or of a shape of its own
    F   = h P + added forces, u = h v          h: share that a free play transmits, u: speed of the piston
    F   = S + added forces, P(u) = S           behind an elastic mount with the force S

P is the demanded force: the force of the damper without play or mount. The yield part is the part of the force that
vanishes when the temperature factor `yield_force` is zero.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from seatsim.compilation.jit import jit
from seatsim.kernel.generic import DamperModel, coulomb, force, rates
from seatsim.kernel.hooks import Effects, effect_state, fold_hook, join_hook, leading_state, sum_hook
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling

_FAST = 10.0
"""m/s; speed at which a yield force has its full size: a hundred times any regularisation of the sign."""
SETTLING = 4e4
"""1/s; greatest rate at which a mount's force settles to the damper's.

It allows an explicit integration: an undamped mount on a massless piston would settle at once. A damper of 300 N s/m
settles a mount of 3 MN/m at 10 000 1/s, which this hardly slows.
"""
_FORCE_TOLERANCE, _TRIALS = 0.01, 40
"""N; tolerance between the forces of mount and damper, below any load cell's noise; and the most iterations."""

part_scaling = fold_hook("part_scaling")
transmitted_share = fold_hook("transmitted_share")
mount_force = fold_hook("mount_force")
mount_stiffness = sum_hook("mount_stiffness")
yield_current = fold_hook("yield_current")
yield_speed = fold_hook("yield_speed")
yield_shape = fold_hook("yield_shape")
yield_force = fold_hook("yield_force")
added_force = sum_hook("added_force")
stiction = sum_hook("stiction")
effect_rates = join_hook("rates")


class AugmentedDamper(NamedTuple):
    """A damper record and a tuple of effects on it; the state is the damper's, then the effects'.

    The hooks that effects may have are listed in `seatsim.effects.base`.
    """

    damper: DamperModel
    effects: Effects

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return the smooth force in N."""
        at = _operate(self, x, i, scaling, z)
        return _end_force(at, v, _demanded_force(at, v))

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return the rates of the damper's state, then of the effects'."""
        at = _operate(self, x, i, scaling, z)
        return _all_rates(at, v, _demanded_force(at, v))

    def force_and_rates(
        self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State
    ) -> tuple[float, State]:
        """Return both; what they share, the demanded force, is most of their work."""
        at = _operate(self, x, i, scaling, z)
        demanded = _demanded_force(at, v)
        changes = _all_rates(at, v, demanded)
        return _end_force(at, v, demanded), changes

    def friction_limit(self, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return the limit of the set-valued friction in N: that of the yield force plus those of the effects."""
        effects, outer = self.effects, effect_state(self.effects, z)
        limit = stiction(effects, outer)
        # A yield force with a shape of its own is computed by the effect and is part of `force` already.
        if math.isnan(yield_shape(effects, outer, math.nan, 0.0, 0.0)):
            h = transmitted_share(effects, outer, 1.0, v, v)
            felt = part_scaling(effects, outer, scaling, v)
            limit += h * coulomb(self.damper, yield_current(effects, outer, i), felt)
        return limit


class _Operation(NamedTuple):
    """A damper with effects in operation: displacement in m, current in A, temperature factors and both states."""

    damper: DamperModel
    effects: Effects
    x: float
    i: float
    scaling: TemperatureScaling
    inner: State
    outer: State


@jit
def _operate(unit: AugmentedDamper, x: float, i: float, scaling: TemperatureScaling, z: State) -> _Operation:
    effects = unit.effects
    return _Operation(unit.damper, effects, x, i, scaling, leading_state(effects, z), effect_state(effects, z))


@jit
def _end_force(at: _Operation, v: float, demanded: float) -> float:
    """Return the smooth force in N at the damper's end, where the damper itself would bear `demanded`."""
    transmitted = mount_force(at.effects, at.outer, math.nan)
    if math.isnan(transmitted):
        transmitted = transmitted_share(at.effects, at.outer, 1.0, v, demanded) * demanded
    return transmitted + added_force(at.effects, at.outer, at.x, v)


@jit
def _all_rates(at: _Operation, v: float, demanded: float) -> State:
    """Return the rates of the damper's state, then of the effects', where the force is `demanded` in N."""
    effects, x, i, outer = at.effects, at.x, at.i, at.outer
    u = _piston_speed(at, v, demanded)
    target = 0.0
    if not math.isnan(yield_shape(effects, outer, math.nan, 0.0, 0.0)):
        felt = part_scaling(effects, outer, at.scaling, u)
        target = _split(at.damper, x, u, yield_current(effects, outer, i), felt, at.inner).shape
    changes = rates(at.damper, x, u, i, at.scaling, at.inner)
    return changes + effect_rates(effects, outer, x, v, u, i, demanded, target)


@jit
def _piston_speed(at: _Operation, v: float, demanded: float) -> float:
    """Return the piston's speed u in m/s, with the damper's end at speed v, at which its force is `demanded` in N.

    Behind an elastic mount u solves `P(u) + (u - v) stiffness / SETTLING = S`, by false position (Illinois).
    """
    transmitted = mount_force(at.effects, at.outer, math.nan)
    if math.isnan(transmitted):
        return transmitted_share(at.effects, at.outer, 1.0, v, demanded) * v
    slope = mount_stiffness(at.effects, at.outer) / SETTLING
    other, e_other = v, demanded - transmitted
    u = v - e_other / slope
    e_u = _demanded_force(at, u) + (u - v) * slope - transmitted
    for _ in range(_TRIALS):
        if abs(e_u) < _FORCE_TOLERANCE or e_u == e_other:
            break
        trial = u - e_u * (u - other) / (e_u - e_other)
        e_trial = _demanded_force(at, trial) + (trial - v) * slope - transmitted
        if e_trial * e_u < 0.0:
            other, e_other = u, e_u
        else:
            e_other *= 0.5
        u, e_u = trial, e_trial
    return u


@jit
def _demanded_force(at: _Operation, v: float) -> float:
    """Return the damper's force in N before the loss in a gap and without added forces."""
    damper, effects, x, i, inner, outer = at.damper, at.effects, at.x, at.i, at.inner, at.outer
    felt = part_scaling(effects, outer, at.scaling, v)
    i_y = yield_current(effects, outer, i)
    base = force(damper, x, v, i, _without_yield(felt), inner)
    if not math.isnan(yield_shape(effects, outer, math.nan, 0.0, 0.0)):
        now = _split(damper, x, v, i_y, felt, inner)
        late = _split(damper, x, yield_speed(effects, outer, v), i_y, felt, inner).shape
        part = now.middle + now.size * yield_shape(effects, outer, math.nan, now.shape, late)
    elif i_y == i:
        # By far the most common case: it saves one evaluation of the damper.
        part = force(damper, x, v, i, felt, inner) - base
    else:
        part = _yield(damper, x, v, i_y, felt, inner)
    return base + yield_force(effects, outer, part)


class YieldPart(NamedTuple):
    """The yield part of a force: mean of both directions and full size in N, and its share of that, -1 to 1."""

    middle: float
    size: float
    shape: float


@jit
def _split(damper: DamperModel, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> YieldPart:
    """Return the yield part of a damper's force, with its set-valued friction."""
    rebound, compression = _yield(damper, x, _FAST, i, scaling, z), _yield(damper, x, -_FAST, i, scaling, z)
    friction = coulomb(damper, i, scaling)
    middle, size = 0.5 * (rebound + compression), 0.5 * (rebound - compression) + friction
    now = _yield(damper, x, v, i, scaling, z) - middle + (0.0 if v == 0.0 else math.copysign(friction, v))
    return YieldPart(middle, size, now / size if size > 0.0 else 0.0)


@jit
def _yield(damper: DamperModel, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
    """Return the yield part in N: the force less that without a yield force."""
    return force(damper, x, v, i, scaling, z) - force(damper, x, v, i, _without_yield(scaling), z)


@jit
def _without_yield(scaling: TemperatureScaling) -> TemperatureScaling:
    return TemperatureScaling(scaling.viscous, scaling.stiffness, 0.0)


def classes_of(damper: DamperModel) -> list[type]:
    """Return the classes that a loop with this damper is compiled for."""
    if isinstance(damper, AugmentedDamper):
        return [AugmentedDamper, type(damper.damper), *map(type, damper.effects)]
    return [type(damper)]
