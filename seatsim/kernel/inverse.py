"""The inverse of a damper: from a wanted force to the current that comes closest to it."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.jit import jit
from seatsim.kernel.generic import Tuple, force, friction_limit
from seatsim.rig.temperature import TemperatureScaling

Array = NDArray[np.float64]

CELLS = 16
"""Cells of the grid on which a non-polynomial force-current map is searched for its first crossing."""


class Answer(NamedTuple):
    """Current in A, the force in N that the believed damper gives with it, and 1.0 where that is the wanted force."""

    current: float
    force: float
    served: float


@jit
def invert(
    damper: Any,
    order: int,
    wanted: float,
    x: float,
    v: float,
    scaling: TemperatureScaling,
    z: Tuple,
    max_current: float,
    grid: Array,
) -> Answer:
    """Return the least current in `[0, max_current]` whose force comes closest to `wanted` clipped to what can be done.

    `grid`, shape (CELLS + 1,), is scratch.

    Outside the dissipative quadrant (`wanted v <= 0`) the current is zero; inside, the wanted force is clipped to the
    range of forces over the permitted currents at this motion, temperature and state. Where the force is a polynomial
    in the current of `order` 1 or 2 it is recovered exactly from three values and solved in closed form. Any other map,
    which need not be monotone, is searched from zero current upward for the first cell that holds the force, then
    bracketed there; where no cell does, the grid's closest point is refined by a parabola.
    """
    if wanted * v <= 0.0:
        current = 0.0
    elif order > 0:
        current = _closed_form(damper, wanted, x, v, scaling, z, max_current)
    else:
        current = _search(damper, wanted, x, v, scaling, z, max_current, grid)
    got = total(damper, x, v, current, scaling, z)
    served = 1.0 if abs(got - wanted) <= 1e-6 * (1.0 + abs(wanted)) else 0.0
    return Answer(current, got, served)


@jit
def total(damper: Any, x: float, v: float, i: float, scaling: TemperatureScaling, z: Tuple) -> float:
    """Return the damper force in N with its set-valued friction, which is zero at v = 0."""
    smooth: float = force(damper, x, v, i, scaling, z)
    friction: float = friction_limit(damper, v, i, scaling, z)
    return smooth + friction * (0.0 if v == 0.0 else math.copysign(1.0, v))


@jit
def _closed_form(
    damper: Any, target: float, x: float, v: float, scaling: TemperatureScaling, z: Tuple, top: float
) -> float:
    f0 = total(damper, x, v, 0.0, scaling, z)
    f1 = total(damper, x, v, 0.5 * top, scaling, z)
    f2 = total(damper, x, v, top, scaling, z)
    a, b, c = 2.0 * (f0 - 2.0 * f1 + f2), 4.0 * f1 - 3.0 * f0 - f2, f0 - target
    size = abs(f0) + abs(f1) + abs(f2)
    if abs(a) <= 1e-10 * size:
        a = 0.0
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
def _search(
    damper: Any, target: float, x: float, v: float, scaling: TemperatureScaling, z: Tuple, top: float, grid: Array
) -> float:
    # The whole grid first: without an early exit the compiler evaluates several currents at once.
    for j in range(CELLS + 1):
        grid[j] = total(damper, x, v, top * j / CELLS, scaling, z) - target
    if grid[0] == 0.0:
        return 0.0
    for j in range(CELLS):
        if grid[j] * grid[j + 1] <= 0.0:
            left, right = top * j / CELLS, top * (j + 1) / CELLS
            return _bracket(damper, target, x, v, scaling, z, left, grid[j], right, grid[j + 1])
    closest = abs(grid[0])
    for j in range(1, CELLS + 1):
        closest = min(closest, abs(grid[j]))
    best = 0
    while best < CELLS and abs(grid[best]) > closest:
        best += 1
    if 0 < best < CELLS:
        return _turn(damper, target, x, v, scaling, z, top, grid, best)
    return top * best / CELLS


@jit
def _turn(
    damper: Any,
    target: float,
    x: float,
    v: float,
    scaling: TemperatureScaling,
    z: Tuple,
    top: float,
    grid: Array,
    best: int,
) -> float:
    """Return the current near the grid's `best`, where the force turns, that comes closest to the target.

    The turn of the parabola through three points may lie beyond the target, which is then met before it.
    """
    a, b = grid[best - 1] - grid[best], grid[best + 1] - grid[best]
    turn = top * (best + 0.5 * (a - b) / (a + b)) / CELLS if a + b != 0.0 else top * best / CELLS
    f_turn = total(damper, x, v, turn, scaling, z) - target
    if grid[best] * f_turn <= 0.0:
        return _bracket(damper, target, x, v, scaling, z, top * (best - 1) / CELLS, grid[best - 1], turn, f_turn)
    return turn if abs(f_turn) < abs(grid[best]) else top * best / CELLS


@jit
def _bracket(
    damper: Any,
    target: float,
    x: float,
    v: float,
    scaling: TemperatureScaling,
    z: Tuple,
    left: float,
    f_left: float,
    right: float,
    f_right: float,
) -> float:
    """Return the root in `[left, right]` by the Illinois method, to 1e-6 N."""
    side = 0
    middle = right
    for _ in range(60):
        middle = (left * f_right - right * f_left) / (f_right - f_left)
        f_middle = total(damper, x, v, middle, scaling, z) - target
        if abs(f_middle) <= 1e-6:
            break
        if f_middle * f_left > 0.0:
            left, f_left = middle, f_middle
            f_right *= 0.5 if side == -1 else 1.0
            side = -1
        else:
            right, f_right = middle, f_middle
            f_left *= 0.5 if side == 1 else 1.0
            side = 1
    return middle
