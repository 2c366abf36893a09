"""A damper with effects: a damper record that the kernel treats like any other.

    P   = F_damper(x, v, i) with the yield part at the current i_y that it feels, or of a shape of its own
    F   = h P + added forces, u = h v          h: share that a free play hands on, u: speed of the piston
    F   = S + added forces, P(u) = S           behind an elastic mount with the force S

The yield part is what a damper loses when its temperature factor `yielding` is zero.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from seatsim.compilation.jit import jit
from seatsim.kernel.chain import Effects, before, folded, joined, own, summed
from seatsim.kernel.generic import Tuple, coulomb, force, rates
from seatsim.rig.temperature import TemperatureScaling

FAST = 10.0
"""m/s; speed at which a yield force has its full size."""
SETTLING = 5000.0
"""1/s; greatest rate at which a mount's force settles to the damper's, for the sake of the time steps."""
NEAR, TRIALS = 0.01, 40
"""N, how exactly the forces of mount and damper agree; and the most trials for it."""

conditioned = folded("conditioned")
engaged = folded("engaged")
mount_force = folded("mount_force")
mount_stiffness = summed("mount_stiffness")
yield_current = folded("yield_current")
yield_speed = folded("yield_speed")
yield_shape = folded("yield_shape")
yield_force = folded("yield_force")
added_force = summed("added_force")
stiction = summed("stiction")
effect_rates = joined("rates")


class AugmentedDamper(NamedTuple):
    """A damper record and a tuple of effects on it; the state is the damper's, then the effects'."""

    damper: Any
    effects: Effects

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: Tuple) -> float:
        """Return the smooth force in N."""
        effects, inner, outer = self.effects, before(self.effects, z), own(self.effects, z)
        passed = mount_force(effects, outer, math.nan)
        if math.isnan(passed):
            pull = _pull(self.damper, effects, x, v, i, scaling, inner, outer)
            passed = engaged(effects, outer, 1.0, v, pull) * pull
        answer: float = passed + added_force(effects, outer, x, v)
        return answer

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: Tuple) -> Tuple:
        """Return the rates of the damper's state, then of the effects'."""
        effects, inner, outer = self.effects, before(self.effects, z), own(self.effects, z)
        pull = _pull(self.damper, effects, x, v, i, scaling, inner, outer)
        u = _piston_speed(self.damper, effects, x, v, i, scaling, inner, outer, pull)
        target = 0.0
        if not math.isnan(yield_shape(effects, outer, math.nan, 0.0, 0.0)):
            felt = conditioned(effects, outer, scaling, v)
            target = _split(self.damper, x, v, yield_current(effects, outer, i), felt, inner).shape
        theirs = effect_rates(effects, outer, x, v, u, i, pull, target)
        answer: Tuple = rates(self.damper, x, u, i, scaling, inner) + theirs
        return answer

    def friction_limit(self, v: float, i: float, scaling: TemperatureScaling, z: Tuple) -> float:
        """Return the limit of the set-valued friction in N: the yield force's, and what the effects add."""
        effects, outer = self.effects, own(self.effects, z)
        limit: float = stiction(effects, outer)
        if math.isnan(yield_shape(effects, outer, math.nan, 0.0, 0.0)):
            h = engaged(effects, outer, 1.0, v, v)
            limit += h * coulomb(self.damper, yield_current(effects, outer, i), conditioned(effects, outer, scaling, v))
        return limit


@jit
def _piston_speed(
    damper: Any,
    effects: Effects,
    x: float,
    v: float,
    i: float,
    scaling: TemperatureScaling,
    inner: Tuple,
    outer: Tuple,
    pull: float,
) -> float:
    """Return the piston's speed u in m/s, where the damper's end goes at v and would pull with `pull` at that speed.

    Behind an elastic mount u solves `P(u) + (u - v) stiffness / SETTLING = S`, by false position (Illinois).
    """
    passed = mount_force(effects, outer, math.nan)
    if math.isnan(passed):
        share: float = engaged(effects, outer, 1.0, v, pull)
        return share * v
    slope = mount_stiffness(effects, outer) / SETTLING
    other, e_other = v, pull - passed
    u: float = v - e_other / slope
    e_u = _pull(damper, effects, x, u, i, scaling, inner, outer) + (u - v) * slope - passed
    for _ in range(TRIALS):
        if abs(e_u) < NEAR or e_u == e_other:
            break
        trial = u - e_u * (u - other) / (e_u - e_other)
        e_trial = _pull(damper, effects, x, trial, i, scaling, inner, outer) + (trial - v) * slope - passed
        if e_trial * e_u < 0.0:
            other, e_other = u, e_u
        else:
            e_other *= 0.5
        u, e_u = trial, e_trial
    return u


@jit
def _pull(
    damper: Any, effects: Effects, x: float, v: float, i: float, scaling: TemperatureScaling, inner: Tuple, outer: Tuple
) -> float:
    """Return the damper's force in N before what is lost in a gap and added beside it."""
    felt = conditioned(effects, outer, scaling, v)
    i_y = yield_current(effects, outer, i)
    rest = TemperatureScaling(felt.viscous, felt.stiffness, 0.0)
    base: float = force(damper, x, v, i, rest, inner)
    if not math.isnan(yield_shape(effects, outer, math.nan, 0.0, 0.0)):
        part = _shaped(damper, effects, x, v, i_y, felt, inner, outer)
    elif i_y == i:
        part = force(damper, x, v, i, felt, inner) - base
    else:
        part = _yield(damper, x, v, i_y, felt, rest, inner)
    total: float = base + yield_force(effects, outer, part)
    return total


@jit
def _shaped(
    damper: Any, effects: Effects, x: float, v: float, i: float, scaling: TemperatureScaling, inner: Tuple, outer: Tuple
) -> float:
    """Return the yield part in N where it has a shape of its own."""
    parts = _split(damper, x, v, i, scaling, inner)
    late = _split(damper, x, yield_speed(effects, outer, v), i, scaling, inner).shape
    part: float = parts.middle + parts.size * yield_shape(effects, outer, math.nan, parts.shape, late)
    return part


class YieldPart(NamedTuple):
    """The yield part of a force: mean of both directions and full size in N, and its share of that, -1 to 1."""

    middle: float
    size: float
    shape: float


@jit
def _split(damper: Any, x: float, v: float, i: float, scaling: TemperatureScaling, z: Tuple) -> YieldPart:
    """Return the yield part of a damper's force, with its set-valued friction."""
    rest = TemperatureScaling(scaling.viscous, scaling.stiffness, 0.0)
    rebound, compression = _yield(damper, x, FAST, i, scaling, rest, z), _yield(damper, x, -FAST, i, scaling, rest, z)
    friction = coulomb(damper, i, scaling)
    middle, size = 0.5 * (rebound + compression), 0.5 * (rebound - compression) + friction
    now = _yield(damper, x, v, i, scaling, rest, z) - middle + (0.0 if v == 0.0 else math.copysign(friction, v))
    return YieldPart(middle, size, now / size if size > 0.0 else 0.0)


@jit
def _yield(
    damper: Any, x: float, v: float, i: float, scaling: TemperatureScaling, rest: TemperatureScaling, z: Tuple
) -> float:
    part: float = force(damper, x, v, i, scaling, z) - force(damper, x, v, i, rest, z)
    return part


def classes_of(damper: Any) -> list[type]:
    """Return the classes that a loop with this damper is compiled of."""
    if isinstance(damper, AugmentedDamper):
        return [type(damper.damper), *map(type, damper.effects)]
    return [type(damper)]
