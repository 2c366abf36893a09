"""BFGS with a weak Wolfe line search, which also works on functions with kinks.

Values and the gradient of whatever side of a kink it stands on are all that the search needs, and where a step is
rejected not even these: `function(x, ceiling)` may answer with any value above `ceiling` where it exceeds that.
Source: Lewis & Overton 2013, Math. Program. 141:135.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from seatsim.schema.arrays import Array

Function = Callable[[Array, float], tuple[float, Array]]

# The usual weak Wolfe constants. The curvature condition is loose on purpose: at a kink a strong one cannot be met.
_ARMIJO, _CURVATURE = 1e-4, 0.5
# Each step halves or doubles: 40 of them span twelve decades of step length.
_LINE_STEPS = 40


class Iterate(NamedTuple):
    """A place with the function's value and gradient there."""

    x: Array
    value: float
    gradient: Array


def minimise(
    function: Function,
    start: Array,
    unit: Array,
    deadline: float,
    enough: float = -np.inf,
    patience: int = 20,
    progress: float = 1e-6,
    iterations: int = 1000,
) -> Iterate:
    """Descend from `start`, where `function` must be finite; the first steps are steepest in x / unit.

    Args:
        function: value and gradient (n,) at x (n,); above `ceiling` the value need only exceed it.
        start: where to begin, (n,).
        unit: natural size of a change of every entry, (n,).
        deadline: by `time.monotonic()`.
        enough: the search ends at this value or below.
        patience: number of steps that together must gain `progress`, else the search ends.
        progress: least gain of so many steps, in the value's unit.
        iterations: most steps.

    Returns:
        The lowest point found, which no step lowered or one of the limits stopped.
    """
    here = Iterate(start, *function(start, np.inf))
    inverse = first = np.diag(unit**2)
    history, fresh = [here.value], True
    for _ in range(iterations):
        if here.value <= enough or not np.any(here.gradient) or time.monotonic() > deadline:
            break
        following = _line_search(function, here, -inverse @ here.gradient)
        if following is None:
            # Steepest descent found nothing either: a minimum, or a kink that no direction leaves.
            if fresh:
                break
            inverse, fresh = first, True
            continue
        inverse = _update(inverse, here, following, fresh)
        here, fresh = following, False
        history.append(here.value)
        if len(history) > patience and history[-1 - patience] - here.value < progress:
            break
    return here


def _line_search(function: Function, here: Iterate, direction: Array) -> Iterate | None:
    """Find a point with sufficient decrease and a flatter slope; None where nothing lower is found."""
    slope = float(here.gradient @ direction)
    if not slope < 0:
        return None
    low, high, step = 0.0, np.inf, 1.0
    lowest: Iterate | None = None
    for _ in range(_LINE_STEPS):
        x, ceiling = here.x + step * direction, here.value + _ARMIJO * step * slope
        trial = Iterate(x, *function(x, ceiling))
        if not trial.value < ceiling:
            high = step
        else:
            lowest, low = trial, step
            if trial.gradient @ direction >= _CURVATURE * slope:
                return trial
        step = (low + high) / 2 if np.isfinite(high) else 2 * low
    return lowest


def _update(inverse: Array, here: Iterate, following: Iterate, fresh: bool) -> Array:
    """BFGS update of the inverse Hessian; the first one also sets its scale."""
    s, y = following.x - here.x, following.gradient - here.gradient
    curvature = float(s @ y)
    # Without curvature the update would lose positive definiteness, and with it descent.
    if not curvature > 1e-14 * float(np.linalg.norm(s) * np.linalg.norm(y)):
        return inverse
    if fresh:
        inverse = inverse * curvature / float(y @ inverse @ y)
    Hy = inverse @ y
    along = (1 + float(y @ Hy) / curvature) * np.outer(s, s)
    return np.asarray(inverse + (along - np.outer(Hy, s) - np.outer(s, Hy)) / curvature)
