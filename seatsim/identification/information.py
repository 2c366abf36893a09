"""What the data say of each parameter: its Fisher information, which respects that residuals are not independent."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.identification.coordinates import Component
from seatsim.identification.problem import PER_KELVIN, WARMING, Problem, jacobian
from seatsim.schema.fields import describe

Array = NDArray[np.float64]

IDENTIFIED = 0.1
"""Standard deviation, over the parameter's size, above which the data are said not to identify it."""
CORRELATED = 0.95
"""Size of a correlation from which on a pair is told."""
LEAST = 1e-13
"""Sensitivity and eigenvalue of the information, over the largest, below which there is none."""
LEAST_COST = 1e-30
"""Mean square of the scaled error that stands for a perfect fit."""
STEP = 1e-6
FINE = 1e-6
"""Tolerance of the simulation: at a fit's own, steps that divide otherwise would pass for an influence."""


class Estimate(NamedTuple):
    """A parameter: its value, standard deviation, unit, and whether the data identify it."""

    name: str
    value: float
    std: float
    unit: str
    identified: bool


class Information(NamedTuple):
    """Estimates, pairs of parameters whose correlation is above 0.95 in size, and the effective number of samples."""

    estimates: list[Estimate]
    correlated: list[tuple[str, str, float]]
    samples: float

    def bic(self, cost: float) -> float:
        """Return the Bayesian information criterion, `n ln(cost) + P ln(n)` with the effective samples n."""
        return self.samples * math.log(max(cost, LEAST_COST)) + len(self.estimates) * math.log(self.samples)


def information(problem: Problem, vector: Array) -> Information:
    """Return what the records say of the parameters at `vector`, shape (P,).

        C = s^2 (J' J)^-1 t,   t = 1 + 2 sum_k rho_k

    with J the derivatives of the scaled residuals, s^2 their mean square, and t the length over which the residuals'
    autocorrelation rho is positive (summed to its first zero): N / t samples count. Parameters are taken as their
    files have them; a law's coefficients share the covariance of its values. The data identify a parameter whose
    standard deviation is at most a tenth of its size, or of a tenth of what its unit is worth in the data (a force of
    their RMS force) where it may be zero.
    """
    problem = problem._replace(tolerance=FINE)
    residuals = problem.residuals(vector)
    pieces = np.split(residuals, np.cumsum([len(drive.force) for drive in problem.drives])[:-1])
    memory = float(np.mean([correlation_length(piece) for piece in pieces]))
    samples = len(residuals) / memory
    square = float(np.sum(residuals**2)) / max(1.0, samples - len(vector))
    covariance = square * _inverse(jacobian(problem, vector, residuals))
    values, turn = _values(problem, vector), _turn(problem, vector)
    std = np.sqrt(np.maximum(np.diag(turn @ covariance @ turn.T), 0.0))
    parts = zip(_names(problem), values, std, _sizes(problem, values), strict=True)
    estimates = [Estimate(name, float(x), float(s), unit, bool(s <= IDENTIFIED * b)) for (name, unit), x, s, b in parts]
    return Information(estimates, _correlated(problem.labels, covariance), samples)


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


def _inverse(slopes: Array) -> Array:
    """Return (J' J)^-1, large but finite in directions that the data say nothing of."""
    scale = np.sqrt(np.sum(slopes**2, axis=0))
    scale = np.maximum(scale, LEAST * (float(np.max(scale)) or 1.0))
    value, basis = np.linalg.eigh((slopes / scale).T @ (slopes / scale))
    known = np.maximum(value, LEAST * (float(value[-1]) or 1.0))
    return np.asarray(((basis / known) @ basis.T) / np.outer(scale, scale))


def _correlated(labels: list[str], covariance: Array) -> list[tuple[str, str, float]]:
    """Return the pairs with a high correlation, the highest first."""
    spread = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(spread, spread)
    above = zip(*np.triu_indices(len(labels), 1), strict=True)
    pairs = [(labels[a], labels[b], float(correlation[a, b])) for a, b in above]
    return sorted((pair for pair in pairs if abs(pair[2]) > CORRELATED), key=lambda pair: -abs(pair[2]))


def _names(problem: Problem) -> list[tuple[str, str]]:
    """Return the name and the unit of every parameter."""
    components = problem.coordinates.components
    unit_of = {specification.name: specification.unit for specification in describe(problem.coordinates.cls)}
    own = [(c.name, unit_of[c.field] + _per_current(c)) for c in components]
    units = {"temperature_factors": "1/K", "actuator": "1/s", "bench": "N/K"}
    return own + [(name, units[name.partition(".")[0]]) for name in problem.beside]


def _per_current(c: Component) -> str:
    """Return what a law's coefficient has behind the law's unit."""
    if c.at is None or not c.place:
        return ""
    return "/A" if c.place == 1 else f"/A^{c.place}"


def _values(problem: Problem, vector: Array) -> Array:
    """Return the parameters as their files have them, shape (P,)."""
    bench = problem.bench(vector)
    fields = [(getattr(bench.damper, c.field), c.place) for c in problem.coordinates.components]
    own = [value if place is None else value[place] for value, place in fields]
    beside = {f"temperature_factors.{name}": value for name, value in bench.factors._asdict().items()}
    beside |= {"actuator.rate": bench.rise, "actuator.rate_fall": bench.fall, "bench.offset_per_kelvin": bench.warming}
    return np.array([*own, *(beside[name] for name in problem.beside)], dtype=float)


def _turn(problem: Problem, vector: Array) -> Array:
    """Return the derivatives of the parameters by the vector, shape (P, P)."""
    values = _values(problem, vector)
    moved = [(_values(problem, vector + STEP * unit) - values) / STEP for unit in np.eye(len(vector))]
    return np.column_stack(moved)


def _sizes(problem: Problem, values: Array) -> list[float]:
    """Return the size that each parameter's deviation is compared with."""
    components, end = problem.coordinates.components, problem.coordinates.end
    laws: dict[str, float] = {}
    for c, value in zip(components, values[: len(components)], strict=True):
        if c.at is not None:
            laws[c.field] = max(laws.get(c.field, c.natural), abs(float(value)) * end ** (c.place or 0))
    sizes = [_size(c, float(value), laws, end) for c, value in zip(components, values, strict=False)]
    least = {"temperature_factors": PER_KELVIN, "actuator": 0.0, "bench": WARMING}
    beside = zip(problem.beside, values[len(components) :], strict=True)
    return sizes + [max(abs(float(value)), least[name.partition(".")[0]]) for name, value in beside]


def _size(c: Component, value: float, laws: dict[str, float], end: float) -> float:
    if c.at is not None:
        return laws[c.field] / end ** (c.place or 0)
    return abs(value) if c.logarithmic else max(abs(value), c.natural)
