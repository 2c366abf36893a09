"""Search: a global start by CMA-ES on short stretches of the records, then least squares on all of them."""

from collections.abc import Callable
from concurrent.futures import Executor
from typing import NamedTuple

import numpy as np

from seatsim.identification.damper_record import rescale_damper
from seatsim.identification.problem import MOST_PARTS_IN_SEARCH, IdentificationProblem, compute_jacobian, predict_force
from seatsim.schema.arrays import Array

Progress = Callable[[str], None]
"""Called with what is being done."""

_INITIAL_DEVIATION = 0.3
"""Standard deviation of the first generation, in components of order one."""
_PER_PARAMETER = 60
"""Simulations of the global search for every parameter."""
_EVALUATIONS_ON_STRETCHES, _EVALUATIONS_ON_RECORDS = 15, 60
"""Most evaluations of least squares on short stretches, which only choose a start, and on whole records."""
_INSIDE = 1e-9
"""Distance from the bounds, in components of order one, at which a descent starts: on them it could not leave."""


class _Minimum(NamedTuple):
    """Where least squares ended: the vector, shape (P,), and its cost."""

    vector: Array
    cost: float


def ignore_progress(text: str) -> None:
    """Tell nobody what is being done."""


def search_parameters(
    problem: IdentificationProblem, short: IdentificationProblem, seed: int, executor: Executor, progress: Progress
) -> Array:
    """Return the best vector of a problem, shape (P,), found from `short` stretches of its records.

    Least squares from the defaults, from the defaults with their forces scaled to the measured ones, and from the end
    of a global search; what comes out best on the stretches is refined on the records. A parameter without any
    influence keeps its default.
    """
    default = default_vector(problem)
    first = descend_from_defaults(short, executor, progress)
    reached = _search_globally(short, first.vector, seed, _PER_PARAMETER * len(default), executor, progress)
    near = refine(short, reached, executor, progress, _EVALUATIONS_ON_STRETCHES)
    start = min((first, near), key=_cost).vector
    found = refine(problem, start, executor, progress, _EVALUATIONS_ON_RECORDS).vector
    jacobian = compute_jacobian(short, found, short.residuals(found), executor)
    return np.where(np.any(jacobian != 0.0, axis=0), found, default)


def default_vector(problem: IdentificationProblem) -> Array:
    """Return the vector of the record that the coordinates start from, shape (P,)."""
    return problem.to_vector(problem.start)


def descend_from_defaults(
    problem: IdentificationProblem,
    executor: Executor,
    progress: Progress = ignore_progress,
    most: int = _EVALUATIONS_ON_STRETCHES,
) -> _Minimum:
    """Return the better end of least squares from the defaults, as they are and with forces scaled to the data."""
    default = default_vector(problem)
    starts = default, _match_force(problem, default)
    return min((refine(problem, start, executor, progress, most) for start in starts), key=_cost)


def _cost(end: _Minimum) -> float:
    return end.cost


def _match_force(problem: IdentificationProblem, vector: Array) -> Array:
    """Return the vector with the forces of its damper scaled to the measured ones."""
    bench = problem.to_bench(vector)
    ours = np.concatenate([predict_force(bench, inputs, MOST_PARTS_IN_SEARCH) for inputs in problem.inputs])
    theirs = np.concatenate([inputs.force for inputs in problem.inputs])
    ratio = float(np.std(theirs) / np.std(ours)) if np.all(np.isfinite(ours)) and np.std(ours) > 0.0 else 1.0
    return problem.to_vector(bench._replace(damper=rescale_damper(bench.damper, ratio, problem.coordinates.end)))


def _search_globally(
    problem: IdentificationProblem, start: Array, seed: int, evaluations: int, executor: Executor, progress: Progress
) -> Array:
    """Return the best vector, shape (P,), of a CMA-ES from `start` (Hansen 2016, arXiv:1604.00772)."""
    import cma

    problem.cost(start)  # compiles, which threads must not do at once
    low, high = problem.bounds
    # A seed of 0 would draw from the clock.
    options = {"seed": seed + 1, "verbose": -9, "bounds": [list(low), list(high)], "maxfevals": evaluations}
    options["tolfun"] = 1e-7
    strategy = cma.CMAEvolutionStrategy(list(start), _INITIAL_DEVIATION, options)
    while not strategy.stop():
        candidates = strategy.ask()
        strategy.tell(candidates, list(executor.map(problem.cost, map(np.asarray, candidates))))
        progress(f"searching, error {100.0 * strategy.best.f**0.5:.1f} %")
    return np.asarray(strategy.best.x, dtype=float)


def refine(
    problem: IdentificationProblem,
    start: Array,
    executor: Executor,
    progress: Progress = ignore_progress,
    most: int = _EVALUATIONS_ON_RECORDS,
) -> _Minimum:
    """Return where least squares from `start` end after at most so many evaluations (Branch et al. 1999)."""
    from scipy.optimize import least_squares

    # The solver asks for the Jacobian where it has just evaluated: the residuals there are kept.
    last: dict[bytes, Array] = {}

    def evaluate(vector: Array) -> Array:
        last.clear()
        residuals = last[vector.tobytes()] = problem.residuals(vector)
        progress(f"fitting, error {100.0 * (np.sum(residuals**2) / len(problem.inputs)) ** 0.5:.2f} %")
        return residuals

    def differentiate(vector: Array) -> Array:
        residuals = last.get(vector.tobytes())
        return compute_jacobian(
            problem, vector, problem.residuals(vector) if residuals is None else residuals, executor
        )

    low, high = problem.bounds
    found = least_squares(
        evaluate, np.clip(start, low + _INSIDE, high - _INSIDE), differentiate, bounds=(low, high), x_scale="jac",
        ftol=1e-6, xtol=1e-6, max_nfev=most,
    )  # fmt: skip
    # The solver's cost is half the sum of squares.
    return _Minimum(np.asarray(found.x), 2.0 * float(found.cost) / len(problem.inputs))
