"""What no damper can do better: the Lagrangian's minimum, at multipliers that raise it as far as they can.

Whatever the multipliers, the minimum is a bound, so that stopping early costs tightness and nothing else. They are hat
functions of time; their logarithms are ascended (L-BFGS) with the logarithm of the determinant of the Lagrangian's
Hessian as a barrier, which vanishes as `SHARES` fall.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable

import numpy as np
import scipy.sparse

from controllers.clairvoyant.problem import Problem
from controllers.clairvoyant.recursion import Array, Lines

SPACING = 0.02
"""s between the nodes of the multipliers."""
SHARES = (0.1, 0.02, 0.005)
"""Size of the barrier over the criterion, stage by stage."""
STEPS = 120
"""Most steps of a stage."""
_MEMORY, _LONGEST, _SETTLED = 30, 2.0, 1e-6
_NU = 1e-9  # of the criterion a N^2, where the ascent starts

Objective = Callable[[Array], tuple[float, Array] | None]


def lower_bound(problem: Problem, lines: Lines, size: float, start: Array | None = None) -> tuple[float, Array]:
    """Return a lower bound of J over all forces between the lines, and the logarithms of the nodes' multipliers.

    `size` is about J; `start` are the logarithms found at another weight.
    """
    hats = _hats(problem.intervals, max(1, round(SPACING / problem.transcription.step)))
    y = _constant(problem, lines, hats, size) if start is None else start

    def bound(y: Array) -> float:
        found = problem.lagrangian(lines, _spread(hats, y), 0.0)
        return found.bound if found else -math.inf

    while bound(y) == -math.inf:
        y = y - 0.3
    best, at = bound(y), y
    for share in SHARES:
        y = _ascended(_objective(problem, lines, hats, share * size / problem.intervals), y)
        reached = bound(y)
        if reached > best:
            best, at = reached, y
    return best, at


def _hats(count: int, every: int) -> scipy.sparse.csr_array:
    """Return the hat functions over `count` intervals with a node at every so many of them, shape (count, nodes)."""
    k = np.arange(count)
    left, share = k // every, (k % every) / every
    entries = (np.concatenate([1 - share, share]), (np.tile(k, 2), np.concatenate([left, left + 1])))
    return scipy.sparse.csr_array(entries, shape=(count, (count - 1) // every + 2))


def _spread(hats: scipy.sparse.csr_array, y: Array) -> Array:
    return np.ascontiguousarray((hats @ np.exp(y.reshape(3, -1)).T).T)


def _objective(problem: Problem, lines: Lines, hats: scipy.sparse.csr_array, barrier: float) -> Objective:
    def objective(y: Array) -> tuple[float, Array] | None:
        found = problem.lagrangian(lines, _spread(hats, y), barrier)
        if found is None:
            return None
        by: Array = (found.by @ hats) * np.exp(y.reshape(3, -1))
        return found.bound + barrier * found.barrier, by.ravel()

    return objective


def _constant(problem: Problem, lines: Lines, hats: scipy.sparse.csr_array, size: float) -> Array:
    """Return the best of some multipliers that do not change with time: they bound the energy of the whole record."""
    share = size / problem.intervals
    nodes = hats.shape[1]
    found = []
    for level in np.geomspace(1e-4, 1e-1, 10):
        y = np.log(np.repeat([0.5 * level * share, 0.5 * level * share, _NU * share], nodes))
        value = problem.lagrangian(lines, _spread(hats, y), 0.0)
        if value:
            found.append((value.bound, level, y))
    return max(found, key=lambda entry: entry[:2])[2]


def _ascended(objective: Objective, y: Array) -> Array:
    """Return where L-BFGS with backtracking comes to in `STEPS` steps, or when it settles."""
    here = objective(y)
    if here is None:
        return y
    value, slope = here
    pairs: deque[tuple[Array, Array]] = deque(maxlen=_MEMORY)
    for _ in range(STEPS):
        direction = _direction(slope, pairs)
        length, found = 1.0, None
        while length > 1e-6:
            found = objective(y + length * direction)
            if found and found[0] >= value + 1e-4 * length * (direction @ slope):
                break
            length, found = 0.4 * length, None
        if found is None:
            break
        step, bend = length * direction, slope - found[1]
        if step @ bend > 0:
            pairs.append((step, bend))
        y, gained = y + step, found[0] - value
        value, slope = found
        if gained < _SETTLED * abs(value) and len(pairs) == _MEMORY:
            break
    return y


def _direction(slope: Array, pairs: deque[tuple[Array, Array]]) -> Array:
    """Return the quasi-Newton direction (Nocedal and Wright, algorithm 7.4), no entry above `_LONGEST`."""
    q, kept = slope.copy(), []
    for step, bend in reversed(pairs):
        factor = (step @ q) / (step @ bend)
        kept.append(factor)
        q -= factor * bend
    if pairs:
        step, bend = pairs[-1]
        q *= (step @ bend) / (bend @ bend)
    else:
        q *= 0.1 / np.max(np.abs(q))
    for (step, bend), factor in zip(pairs, reversed(kept), strict=True):
        q += step * (factor - (bend @ q) / (step @ bend))
    return q * min(1.0, _LONGEST / float(np.max(np.abs(q))))
