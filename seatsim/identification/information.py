"""What the data say of each parameter: its Fisher information, which respects that residuals are not independent."""

from __future__ import annotations

import math
from concurrent.futures import Executor
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.identification.damper_record import Component
from seatsim.identification.problem import IdentificationProblem, compute_jacobian, read_bench
from seatsim.schema.arrays import Array
from seatsim.schema.content import Form, written

_IDENTIFIED = 0.1
"""Standard deviation, over the parameter's size, above which the data are said not to identify it."""
_CORRELATED = 0.95
"""Size of a correlation above which a pair is reported."""
_LEAST = 1e-13
"""Sensitivity and eigenvalue of the information, over the largest, below which there is none."""
_LEAST_COST = 1e-30
"""Mean square of the scaled error that stands for a perfect fit."""
_DIFFERENCE_STEP = 1e-6
"""Step of the differences by which parameters are taken from the vector, a smooth function without a simulation."""
_FINE_TOLERANCE = 1e-6
"""Tolerance of the simulation: at a fit's own, steps that divide otherwise would pass for an influence."""


class ParameterEstimate(NamedTuple):
    """A parameter: its value, standard deviation, unit, and whether the data identify it."""

    name: str
    value: float
    std: float
    unit: str
    identified: bool


class Information(NamedTuple):
    """Estimates, pairs of parameters whose correlation is above 0.95 in size, and the effective number of samples."""

    estimates: Annotated[list[ParameterEstimate], Form(key="parameters")]
    correlated: list[tuple[str, str, float]]
    samples: Annotated[float, Form(key="effective_samples")]

    @property
    @written()
    def not_identified(self) -> list[str]:
        """Names of the parameters that the data do not identify."""
        return [estimate.name for estimate in self.estimates if not estimate.identified]

    def bic(self, cost: float) -> float:
        """Return the Bayesian information criterion, `n ln(cost) + P ln(n)` with the effective samples n."""
        return self.samples * math.log(max(cost, _LEAST_COST)) + len(self.estimates) * math.log(self.samples)


def compute_information(problem: IdentificationProblem, vector: Array, executor: Executor) -> Information:
    """Return what the records say of the parameters at `vector`, shape (P,).

        C = s^2 (J' J)^-1 t,   t = 1 + 2 sum_k rho_k

    with J the derivatives of the scaled residuals, s^2 their mean square, and t the length over which the residuals'
    autocorrelation rho is positive (summed to its first zero): N / t samples count. Parameters are taken as their
    files have them; a law's coefficients share the covariance of its values. The data identify a parameter whose
    standard deviation is at most a tenth of its size, or of a tenth of what its unit is worth in the data (a force of
    their RMS force) where it may be zero.
    """
    problem = problem._replace(tolerance=_FINE_TOLERANCE)
    residuals = problem.residuals(vector)
    pieces = np.split(residuals, np.cumsum([len(inputs.force) for inputs in problem.inputs])[:-1])
    memory = float(np.mean([correlation_length(piece) for piece in pieces]))
    samples = len(residuals) / memory
    square = float(np.sum(residuals**2)) / max(1.0, samples - len(vector))
    covariance = square * _invert_normal_matrix(compute_jacobian(problem, vector, residuals, executor))
    return Information(_estimates(problem, vector, covariance), _correlated(problem.labels, covariance), samples)


def _estimates(problem: IdentificationProblem, vector: Array, covariance: Array) -> list[ParameterEstimate]:
    """Return the parameters with the standard deviations that follow from the covariance of the vector, (P, P)."""
    values, derivatives = _values(problem, vector), _parameter_derivatives(problem, vector)
    std = np.sqrt(np.maximum(np.diag(derivatives @ covariance @ derivatives.T), 0.0))
    parts = zip(problem.components, values, std, _sizes(problem, values), strict=True)
    return [
        ParameterEstimate(c.name, float(value), float(std), c.unit + _per_current(c), bool(std <= _IDENTIFIED * size))
        for c, value, std, size in parts
    ]


def correlation_length(residuals: Array) -> float:
    """Return `1 + 2 sum rho_k` up to the first negative autocorrelation, at least 1."""
    centred = residuals - np.mean(residuals)
    count = 1 << (2 * len(centred) - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(centred, count)) ** 2
    rho = np.fft.irfft(spectrum, count)[: len(centred)]
    if rho[0] <= 0.0:
        return 1.0
    rho = rho / rho[0]
    below = np.flatnonzero(rho < 0.0)
    return max(1.0, 1.0 + 2.0 * float(np.sum(rho[1 : below[0] if below.size else len(rho)])))


def _invert_normal_matrix(jacobian: Array) -> Array:
    """Return (J' J)^-1, large but finite in directions that the data say nothing of."""
    # Columns of equal length: the eigenvalues then show how collinear columns are, and not how their units differ.
    scale = np.sqrt(np.sum(jacobian**2, axis=0))
    scale = np.maximum(scale, _LEAST * (float(np.max(scale)) or 1.0))
    value, basis = np.linalg.eigh((jacobian / scale).T @ (jacobian / scale))
    known = np.maximum(value, _LEAST * (float(value[-1]) or 1.0))
    return np.asarray(((basis / known) @ basis.T) / np.outer(scale, scale))


def _correlated(labels: list[str], covariance: Array) -> list[tuple[str, str, float]]:
    """Return the pairs with a high correlation, the highest first."""
    spread = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(spread, spread)
    above = zip(*np.triu_indices(len(labels), 1), strict=True)
    pairs = [(labels[a], labels[b], float(correlation[a, b])) for a, b in above]
    return sorted((pair for pair in pairs if abs(pair[2]) > _CORRELATED), key=lambda pair: -abs(pair[2]))


def _per_current(c: Component) -> str:
    """Return what a law's coefficient has behind the law's unit."""
    if c.at is None or not c.position:
        return ""
    return "/A" if c.position == 1 else f"/A^{c.position}"


def _values(problem: IdentificationProblem, vector: Array) -> Array:
    """Return the parameters as their files have them, shape (P,); coefficients of a law in place of its values."""
    bench = problem.to_bench(vector)
    fields = {**bench.damper._asdict(), **read_bench(bench)}
    return np.array([c.read(fields[c.field]) for c in problem.components], dtype=float)


def _parameter_derivatives(problem: IdentificationProblem, vector: Array) -> Array:
    """Return the derivatives of the parameters by the vector, shape (P, P)."""
    values = _values(problem, vector)
    moved = [
        (_values(problem, vector + _DIFFERENCE_STEP * unit) - values) / _DIFFERENCE_STEP for unit in np.eye(len(vector))
    ]
    return np.column_stack(moved)


def _sizes(problem: IdentificationProblem, values: Array) -> list[float]:
    """Return the size that each parameter's deviation is compared with."""
    pairs, end = list(zip(problem.components, map(float, values), strict=True)), problem.coordinates.end
    laws: dict[str, float] = {}
    for c, value in pairs:
        if c.at is not None:
            laws[c.field] = max(laws.get(c.field, c.natural), abs(value) * end ** (c.position or 0))
    return [_size(c, value, laws, end) for c, value in pairs]


def _size(c: Component, value: float, laws: dict[str, float], end: float) -> float:
    if c.at is not None:
        return laws[c.field] / end ** (c.position or 0)
    return abs(value) if c.logarithmic else max(abs(value), c.natural)
