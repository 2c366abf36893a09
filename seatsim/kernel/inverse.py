"""The inverse of a damper: from a wanted force to the current that comes closest to it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from numba import types

from seatsim.compilation.jit import jit, specialise
from seatsim.kernel.generic import DamperModel, force, friction_limit
from seatsim.kernel.hooks import method_of, record_class
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.arrays import Array
from seatsim.schema.registry import current_order

CELLS = 16
"""Cells of the grid on which a non-polynomial force-current map is searched for its first crossing.

A turn towards the force and back within one cell, of which no point of the grid is nearer, is missed.
"""
_INSIDE = 1e-4
"""Distance in cells from an end of the grid at which is seen whether the force turns within the last cell."""
_BESIDE = 1e-2
"""Distance from a turn, over the width of its interval, of the currents whose forces fix the parabola through it."""
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
SERVED = 1e-6
"""Difference of given and wanted force, over the wanted force plus 1 N, up to which it counts as reached."""
_STRAIGHT = 1e-10
"""Curvature of a force-current map, over the size of its forces, below which it is rounding error of a line."""
CLOSE = 1e-6
"""N; difference from the wanted force up to which an end or a turn meets it."""
_TRIALS = 60
"""Most iterations of a search; the Illinois method needs about ten, bisection alone reaches rounding error by 60."""


class InverseSolution(NamedTuple):
    """Current in A, the force in N that the inverse's damper gives with it, and 1.0 where that is the wanted force."""

    current: float
    force: float
    served: float


class Demand(NamedTuple):
    """A force that a damper is to give: `wanted` in N, positive when it opposes extension.

    x [m], v [m/s], `scaling` and z are motion, temperature factors and state with which the damper is evaluated,
    `max_current` [A] is above zero.
    """

    damper: DamperModel
    wanted: float
    x: float
    v: float
    scaling: TemperatureScaling
    z: State
    max_current: float


@jit
def invert(demand: Demand, grid: Array) -> InverseSolution:
    """Return the least current in `[0, max_current]` whose force comes closest to `wanted`, clipped to the possible.

    `grid`, shape (CELLS + 1,), is scratch.

    Outside the dissipative quadrant (`wanted v <= 0`) the current is zero; inside, the wanted force is clipped to the
    range of forces over the permitted currents at this motion, temperature and state. Where the force of the damper's
    class is a polynomial in the current of degree 1 or 2 (`current_order`), it is recovered exactly from three values
    and solved in closed form. Any other map, which need not be monotone, is searched from zero current upward for the
    first cell, or the first turn, that reaches the force, then bracketed there; where none does, the closest turn or
    end is taken. So is a map of that degree whose set-valued friction vanishes at some current, since it has a corner
    there.
    """
    wanted = demand.wanted
    current = 0.0 if wanted * demand.v <= 0.0 else find_current(demand, grid)
    got = _force_at(demand, current)
    served = 1.0 if abs(got - wanted) <= SERVED * (1.0 + abs(wanted)) else 0.0
    return InverseSolution(current, got, served)


def find_current(demand: Demand, grid: Array) -> float:
    """Return the least current whose force is closest to the wanted one, in the way of the damper's class."""
    return _choose_way(type(demand.damper))(demand, grid)


@specialise(find_current)
def _find_current(demand: types.NamedTuple, grid: types.Type) -> Callable[..., float]:
    return _choose_way(record_class(demand.types[0]))


def _choose_way(cls: type) -> Callable[..., float]:
    """Return the search, or the closed form: a search that a class never uses would be a fifth of what is compiled."""
    order = current_order(cls)
    if order == 0:
        return _search
    if not (method_of(cls, "coulomb") or method_of(cls, "friction_limit")):
        return lambda demand, grid: _closed_form(demand, order)
    return lambda demand, grid: _search(demand, grid) if _friction_vanishes(demand) else _closed_form(demand, order)


@jit
def total_force(damper: DamperModel, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
    """Return the damper force in N with its set-valued friction, which is zero at v = 0."""
    smooth = force(damper, x, v, i, scaling, z)
    friction = friction_limit(damper, v, i, scaling, z)
    return smooth + friction * (0.0 if v == 0.0 else math.copysign(1.0, v))


@jit
def _force_at(demand: Demand, i: float) -> float:
    """Return the force in N at a current in A."""
    return total_force(demand.damper, demand.x, demand.v, i, demand.scaling, demand.z)


@jit
def _friction_vanishes(demand: Demand) -> bool:
    """Return whether the set-valued friction is zero at one end of the range of currents, but not at the other."""
    first = friction_limit(demand.damper, demand.v, 0.0, demand.scaling, demand.z)
    last = friction_limit(demand.damper, demand.v, demand.max_current, demand.scaling, demand.z)
    return min(first, last) <= 0.0 < max(first, last)


@jit
def _closed_form(demand: Demand, order: int) -> float:
    """Return the current whose force is closest to the wanted one, of a force of degree 1 or 2.

    With s = i / max_current the force is `f0 + b s + a s^2`, through its values at s = 0 and 1, and at 1/2 for a degree
    of 2.
    """
    target, top = demand.wanted, demand.max_current
    f0, f2 = _force_at(demand, 0.0), _force_at(demand, top)
    # Differences of forces come first: what does not depend on the current falls out of them without rounding.
    rise, a, c = f2 - f0, 0.0, f0 - target
    if order > 1:
        a = 2.0 * (rise - 2.0 * (_force_at(demand, 0.5 * top) - f0))
    # A square term of zero leaves a rounding error in a, whose second root would be far away or, by chance, near.
    if abs(a) <= _STRAIGHT * (abs(f0) + abs(f2)):
        a = 0.0
    b = rise - a
    # Where no root lies within 0 to 1, the closest force is that of an end or of the turning point.
    best = 0.0 if abs(c) <= abs(f2 - target) else 1.0
    turn = -0.5 * b / a if a != 0.0 else -1.0
    if 0.0 < turn < 1.0 and abs(c + turn * (b + a * turn)) < min(abs(c), abs(f2 - target)):
        best = turn
    if a == 0.0:
        if b != 0.0 and 0.0 <= -c / b <= 1.0:
            best = -c / b
        return best * top
    square = b * b - 4.0 * a * c
    if square < 0.0:
        return best * top
    # This form of the two roots does not subtract nearly equal numbers.
    q = -0.5 * (b + math.copysign(math.sqrt(square), b))
    r1 = q / a
    r2 = c / q if q != 0.0 else r1
    low, high = min(r1, r2), max(r1, r2)
    if 0.0 <= low <= 1.0:
        return low * top
    if 0.0 <= high <= 1.0:
        return high * top
    return best * top


@jit
def _search(demand: Demand, grid: Array) -> float:
    """Return the least current at which the grid shows that the wanted force is met, or the closest one."""
    top = demand.max_current
    # The whole grid is evaluated first: without an early exit the compiler can evaluate several currents at once.
    for j in range(CELLS + 1):
        grid[j] = _force_at(demand, top * j / CELLS) - demand.wanted
    best, closest = 0.0, abs(grid[0])
    if closest <= CLOSE:
        return best
    side = math.copysign(1.0, grid[0])
    for j in range(CELLS + 1):
        left, right = top * max(j - 1, 0) / CELLS, top * min(j + 1, CELLS) / CELLS
        if j > 0 and side * grid[j] < 0.0:
            return _bracket(demand, left, grid[j - 1], top * j / CELLS, grid[j])
        current, missed = top * j / CELLS, grid[j]
        if _turns_near(demand, grid, side, j):
            current, missed = _closest(demand, side, left, right)
            # The turn may lie beyond the target, which is then met before it.
            if side * missed < 0.0:
                return _bracket(demand, left, grid[max(j - 1, 0)], current, missed)
        if abs(missed) < closest:
            best, closest = current, abs(missed)
        if closest <= CLOSE:
            return best
    return best


@jit
def _turns_near(demand: Demand, grid: Array, side: float, j: int) -> bool:
    """Return whether the force comes closest to the target, or passes it, about the grid's point `j`.

    `side` is the sign of force less target up to there. A force that stays the same from some current on comes closest
    where that begins. At an end of the grid, a current just inside tells whether the force turns within the last cell.
    """
    here = side * grid[j]
    if j > 0 and side * grid[j - 1] <= here:
        return False
    if j < CELLS and side * grid[j + 1] < here:
        return False
    if 0 < j < CELLS:
        return True
    inside = _INSIDE if j == 0 else CELLS - _INSIDE
    near = side * (_force_at(demand, demand.max_current * inside / CELLS) - demand.wanted)
    turns: bool = near < here if j == 0 else near <= here
    return turns


@jit
def _closest(demand: Demand, side: float, left: float, right: float) -> tuple[float, float]:
    """Return the least current in `[left, right]` whose force is closest to the target, and force less target there.

    By golden section search, which ends as soon as the target is passed: `side` is the sign of the difference before.
    """
    target, first, last, beside = demand.wanted, left, right, _BESIDE * (right - left)
    low, high = right - _GOLDEN * (right - left), left + _GOLDEN * (right - left)
    f_low = _force_at(demand, low) - target
    f_high = _force_at(demand, high) - target
    for _ in range(_TRIALS):
        if side * f_low < 0.0:
            return low, f_low
        # Of two equal forces the lesser current is kept.
        if side * f_low <= side * f_high:
            right, high, f_high = high, low, f_low
            low = right - _GOLDEN * (right - left)
            f_low = _force_at(demand, low) - target
        else:
            left, low, f_low = low, high, f_high
            high = left + _GOLDEN * (right - left)
            f_high = _force_at(demand, high) - target
    # A corner is not where the parabola has its vertex: the force there is another one.
    turn = _turn(demand, high, min(beside, high - first, last - high))
    f_turn = _force_at(demand, turn) - target
    return (turn, f_turn) if side * (f_turn - f_high) <= CLOSE else (high, f_high)


@jit
def _turn(demand: Demand, i: float, beside: float) -> float:
    """Return the current at the vertex of the parabola through the forces at `i` and `beside` it on either side.

    About a smooth turn the forces are equal but for rounding over the square root of it, so that comparing them places
    the turn no better. The forces some way off place it to rounding.
    """
    before, here, after = _force_at(demand, i - beside), _force_at(demand, i), _force_at(demand, i + beside)
    bend = (after - here) - (here - before)
    if abs(after - before) >= abs(bend):
        return i
    return i - 0.5 * beside * (after - before) / bend


@jit
def _bracket(demand: Demand, left: float, f_left: float, right: float, f_right: float) -> float:
    """Return the root in `[left, right]` by the Illinois method, which halves the value of an end that stays put.

    It goes on until no number is left between the ends, in whatever precision: with a tolerance, rounding would decide
    how many iterations there are, and the current would depend on that.
    """
    side = 0
    middle = right
    for _ in range(_TRIALS):
        middle = (left * f_right - right * f_left) / (f_right - f_left)
        if not left < middle < right:
            break
        f_middle = _force_at(demand, middle) - demand.wanted
        if f_middle == 0.0:
            break
        if f_middle * f_left > 0.0:
            left, f_left = middle, f_middle
            f_right *= 0.5 if side == -1 else 1.0
            side = -1
        else:
            right, f_right = middle, f_middle
            f_left *= 0.5 if side == 1 else 1.0
            side = 1
    return min(max(middle, left), right)
