"""Search: a global start by CMA-ES on short stretches of the records, then least squares on all of them."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from seatsim.identification.problem import Problem, jacobian

Array = NDArray[np.float64]
Tell = Callable[[str], None]

SPREAD = 0.3
"""Standard deviation of the first generation, in components of order one."""


def started(problem: Problem, start: Array, seed: int, evaluations: int, tell: Tell) -> Array:
    """Return the best vector of a CMA-ES from `start` (Hansen 2016, arXiv:1604.00772)."""
    import cma

    problem.cost(start)  # compiles, which threads must not do at once

    low, high = problem.bounds
    options = {
        "seed": seed + 1,
        "verbose": -9,
        "bounds": [list(low), list(high)],
        "maxfevals": evaluations,
        "tolfun": 1e-7,
    }
    strategy = cma.CMAEvolutionStrategy(list(start), SPREAD, options)
    with ThreadPoolExecutor() as pool:
        while not strategy.stop():
            found = strategy.ask()
            strategy.tell(found, list(pool.map(problem.cost, map(np.asarray, found))))
            tell(f"searching, error {100.0 * strategy.best.f**0.5:.1f} %")
    return np.asarray(strategy.best.x, dtype=float)


def refined(problem: Problem, start: Array, tell: Tell, most: int = 60) -> tuple[Array, float]:
    """Return the vector of least squares near `start` and its cost (trust region, Branch et al. 1999)."""
    from scipy.optimize import least_squares

    last: dict[bytes, Array] = {}

    def value(vector: Array) -> Array:
        last.clear()
        last[vector.tobytes()] = problem.residuals(vector)
        tell(f"fitting, error {100.0 * (np.sum(last[vector.tobytes()] ** 2) / len(problem.drives)) ** 0.5:.2f} %")
        return last[vector.tobytes()]

    def slopes(vector: Array) -> Array:
        key = vector.tobytes()
        return jacobian(problem, vector, last[key] if key in last else problem.residuals(vector))

    low, high = problem.bounds
    inside = np.clip(start, low + 1e-9, high - 1e-9)
    found = least_squares(value, inside, slopes, bounds=(low, high), x_scale="jac", ftol=1e-4, xtol=1e-4, max_nfev=most)
    return np.asarray(found.x), 2.0 * float(found.cost) / len(problem.drives)
