"""A damper with effects: a damper record that the kernel treats like any other.

    h   = share of the stroke that reaches the damper (free play), i_y = current that its yield force feels
    F   = h (F_damper(x, v, i) with the yield part at i_y, v_y or of a shape of its own) + added forces

The yield part is what a damper loses when its temperature factor `yielding` is zero.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from seatsim.jit import jit
from seatsim.kernel.chain import Effects, before, folded, joined, own, summed
from seatsim.kernel.generic import Tuple, coulomb, force, rates
from seatsim.temperature import Heat

FAST = 10.0
"""m/s; speed at which a yield force has its full size."""

conditioned = folded("conditioned")
engaged = folded("engaged")
yield_current = folded("yield_current")
yield_speed = folded("yield_speed")
yield_shape = folded("yield_shape")
added_force = summed("added_force")
stiction = summed("stiction")
effect_rates = joined("rates")


class AugmentedDamper(NamedTuple):
    """A damper record and a tuple of effects on it; the state is the damper's, then the effects'."""

    damper: Any
    effects: Effects

    def force(self, x: float, v: float, i: float, heat: Heat, z: Tuple) -> float:
        """Return the smooth force in N."""
        effects, inner, outer = self.effects, before(self.effects, z), own(self.effects, z)
        felt = conditioned(effects, outer, heat, v)
        h = engaged(effects, outer, 1.0, v)
        i_y = yield_current(effects, outer, i)
        v_y = yield_speed(effects, outer, v)
        shape = yield_shape(effects, outer, math.nan)
        total: float = h * _force(self.damper, x, v, i, v_y, i_y, shape, felt, inner)
        return total + added_force(effects, outer, x, v)

    def rates(self, x: float, v: float, i: float, heat: Heat, z: Tuple) -> Tuple:
        """Return the rates of the damper's state, then of the effects'."""
        effects, inner, outer = self.effects, before(self.effects, z), own(self.effects, z)
        h = engaged(effects, outer, 1.0, v)
        answer: Tuple = rates(self.damper, x, h * v, i, heat, inner) + effect_rates(effects, outer, x, v, i)
        return answer

    def friction_limit(self, v: float, i: float, heat: Heat, z: Tuple) -> float:
        """Return the limit of the set-valued friction in N: the yield force's, and what the effects add."""
        effects, outer = self.effects, own(self.effects, z)
        limit: float = stiction(effects, outer)
        if math.isnan(yield_shape(effects, outer, math.nan)):
            h = engaged(effects, outer, 1.0, v)
            limit += h * coulomb(self.damper, yield_current(effects, outer, i), conditioned(effects, outer, heat, v))
        return limit


@jit
def _force(
    damper: Any, x: float, v: float, i: float, v_y: float, i_y: float, shape: float, heat: Heat, z: Tuple
) -> float:
    """Return the damper's force with the yield part at `v_y` and `i_y`, or of `shape` (NaN: as the damper has it)."""
    if i_y == i and v_y == v and math.isnan(shape):
        return force(damper, x, v, i, heat, z)
    rest = Heat(heat.viscous, heat.stiffness, 0.0)
    remainder = force(damper, x, v, i, rest, z)
    if math.isnan(shape):
        return remainder + _yield(damper, x, v_y, i_y, heat, rest, z)
    rebound, compression = _yield(damper, x, FAST, i_y, heat, rest, z), _yield(damper, x, -FAST, i_y, heat, rest, z)
    size = 0.5 * (rebound - compression) + coulomb(damper, i_y, heat)
    return remainder + 0.5 * (rebound + compression) + size * shape


@jit
def _yield(damper: Any, x: float, v: float, i: float, heat: Heat, rest: Heat, z: Tuple) -> float:
    return force(damper, x, v, i, heat, z) - force(damper, x, v, i, rest, z)


def classes_of(damper: Any) -> list[type]:
    """Return the classes that a loop with this damper is compiled of."""
    if isinstance(damper, AugmentedDamper):
        return [type(damper.damper), *map(type, damper.effects)]
    return [type(damper)]
