"""The minimum of a strictly convex quadratic under bounds, by block principal pivoting.

A bounded least-squares routine for tall matrices spends most of its time on factorising what is a matrix of some twenty
rows here; a diagnosis solves about a thousand of these.
"""

from __future__ import annotations

import numpy as np

from seatsim.schema.arrays import Array

PATIENCE = 3
"""Exchanges of whole blocks without fewer components out of place, after which one component at a time is exchanged."""
_ALLOWANCE = 1e-12
"""Violations of a bound and gradients below this, in units of the largest right-hand side, are rounding errors."""


def minimise_bounded(matrix: Array, right: Array, low: Array, high: Array) -> Array:
    """Return the x that minimises `x' matrix x - 2 right' x` with `low <= x <= high`.

    Each component is free or at one of its bounds. The free ones are solved for; then all that are out of place change
    sides: free ones beyond a bound go to it, and those at a bound whose gradient points inwards become free. Where that
    stops making progress only the last of them changes, which ends after finitely many exchanges.

    Args:
        matrix: symmetric and positive definite, shape (components, components), of a diagonal near 1.
        right: shape (components,).
        low: lower bounds, shape (components,), not above `high`.
        high: upper bounds, shape (components,).

    Source: J. J. Judice and F. M. Pires, "A block principal pivoting algorithm for large-scale strictly monotone
    linear complementarity problems", Computers & Operations Research 21 (1994) 587-596 (recalled).
    """
    side = np.zeros(len(right), dtype=np.int8)
    fewest, patience = len(right) + 1, PATIENCE
    allowed = _ALLOWANCE * max(1.0, float(np.abs(right).max(initial=0.0)))
    while True:
        x = np.where(side < 0, low, np.where(side > 0, high, 0.0))
        free = side == 0
        x[free] = np.linalg.solve(matrix[np.ix_(free, free)], right[free] - matrix[np.ix_(free, ~free)] @ x[~free])
        gradient = matrix @ x - right
        wanted = np.where(free, (x > high + allowed).astype(np.int8) - (x < low - allowed), side)
        wanted[(side != 0) & (side * gradient > allowed)] = 0
        misplaced = np.flatnonzero(wanted != side)
        if not len(misplaced):
            return np.clip(x, low, high)
        if len(misplaced) < fewest:
            fewest, patience = len(misplaced), PATIENCE
        else:
            patience -= 1
        changed = misplaced if patience >= 0 else misplaced[-1:]
        side[changed] = wanted[changed]
