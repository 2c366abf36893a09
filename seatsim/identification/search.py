"""Search: a global start by CMA-ES on short stretches of the records, then least squares on all of them."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from seatsim.identification.coordinates import scaled
from seatsim.identification.predict import Bench, predicted
from seatsim.identification.problem import PARTS, RATE, Problem, jacobian
from seatsim.rig.temperature import TemperatureFactors

Array = NDArray[np.float64]
Tell = Callable[[str], None]

SPREAD = 0.3
"""Standard deviation of the first generation, in components of order one."""
PER_PARAMETER = 60
"""Simulations of the global search for every parameter."""
SHORTLY, FULLY = 15, 60
"""Most evaluations of least squares on short stretches and on whole records."""


def silent(text: str) -> None:
    """Tell nothing."""


def best(problem: Problem, short: Problem, seed: int, progress: Tell = silent) -> Array:
    """Return the best vector of a problem, shape (P,), found from `short` stretches of its records.

    Least squares from the defaults, from the defaults with their forces scaled to the measured ones, and from the end
    of a global search; what comes out best on the stretches is refined on the records. A parameter without any
    influence keeps its default.
    """
    plain = problem.vector(Bench(problem.coordinates.start, TemperatureFactors(), RATE, RATE))
    first = min((refined(short, start, progress, SHORTLY) for start in (plain, _forced(short, plain))), key=_cost)
    near = refined(short, started(short, first[0], seed, PER_PARAMETER * len(plain), progress), progress, SHORTLY)
    found = refined(problem, min((first, near), key=_cost)[0], progress, FULLY)[0]
    slopes = jacobian(short, found, short.residuals(found))
    return np.where(np.any(slopes != 0.0, axis=0), found, plain)


def _cost(end: tuple[Array, float]) -> float:
    return end[1]


def _forced(problem: Problem, vector: Array) -> Array:
    """Return the vector with the forces of its damper scaled to the measured ones."""
    bench = problem.bench(vector)
    ours = np.concatenate([predicted(bench, drive, PARTS) for drive in problem.drives])
    theirs = np.concatenate([drive.force for drive in problem.drives])
    ratio = float(np.std(theirs) / np.std(ours)) if np.all(np.isfinite(ours)) and np.std(ours) > 0.0 else 1.0
    return problem.vector(bench._replace(damper=scaled(bench.damper, ratio, problem.coordinates.end)))


def started(problem: Problem, start: Array, seed: int, evaluations: int, progress: Tell = silent) -> Array:
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
            progress(f"searching, error {100.0 * strategy.best.f**0.5:.1f} %")
    return np.asarray(strategy.best.x, dtype=float)


def refined(problem: Problem, start: Array, progress: Tell = silent, most: int = FULLY) -> tuple[Array, float]:
    """Return the vector of least squares near `start` and its cost (trust region, Branch et al. 1999)."""
    from scipy.optimize import least_squares

    last: dict[bytes, Array] = {}

    def value(vector: Array) -> Array:
        last.clear()
        residuals = last[vector.tobytes()] = problem.residuals(vector)
        progress(f"fitting, error {100.0 * (np.sum(residuals**2) / len(problem.drives)) ** 0.5:.2f} %")
        return residuals

    def slopes(vector: Array) -> Array:
        key = vector.tobytes()
        return jacobian(problem, vector, last[key] if key in last else problem.residuals(vector))

    low, high = problem.bounds
    inside = np.clip(start, low + 1e-9, high - 1e-9)
    found = least_squares(value, inside, slopes, bounds=(low, high), x_scale="jac", ftol=1e-6, xtol=1e-6, max_nfev=most)
    return np.asarray(found.x), 2.0 * float(found.cost) / len(problem.drives)
