"""What the data say of each parameter: its Fisher information, which respects that residuals are not independent."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.fields import describe
from seatsim.identification.problem import Problem, jacobian

Array = NDArray[np.float64]

IDENTIFIED = 0.1
"""Standard deviation, over the parameter's size, above which the data are said not to identify it."""
CORRELATED = 0.95
LEAST = 1e-13
"""Eigenvalue of the information, over the largest, below which a direction is without any."""


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


def information(problem: Problem, vector: Array) -> Information:
    """Return what the records say of the parameters at `vector`.

        C = s^2 (J' J)^-1 t,   t = 1 + 2 sum_k rho_k

    with J the derivatives of the scaled residuals, s^2 their mean square, and t the length over which the residuals'
    autocorrelation rho is positive (summed to its first zero): N / t samples count. Parameters are taken as their
    files have them; a law's coefficients share the covariance of its values.
    """
    residuals = problem.residuals(vector)
    slopes = jacobian(problem, vector, residuals)
    lengths = [len(drive.force) for drive in problem.drives]
    pieces = np.split(residuals, np.cumsum(lengths)[:-1])
    memory = float(np.mean([correlation_length(piece) for piece in pieces]))
    variance = float(np.sum(residuals**2)) / max(1.0, len(residuals) / memory - len(vector)) / memory
    scale = np.sqrt(np.sum(slopes**2, axis=0))
    scale[scale == 0.0] = 1e-300
    value, basis = np.linalg.eigh((slopes / scale).T @ (slopes / scale))
    known = np.maximum(value, LEAST * value[-1])
    covariance = memory * variance * ((basis / known) @ basis.T) / np.outer(scale, scale)
    names, natural, units, turn = _natural(problem, vector)
    spread = turn @ covariance @ turn.T
    std = np.sqrt(np.maximum(np.diag(spread), 0.0))
    sizes = _sizes(problem, natural)
    estimates = [
        Estimate(n, float(x), float(s), u, bool(s <= IDENTIFIED * size))
        for n, x, s, u, size in zip(names, natural, std, units, sizes, strict=True)
    ]
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))
    pairs = [
        (problem.names[a], problem.names[b], float(correlation[a, b]))
        for a, b in zip(*np.triu_indices(len(vector), 1), strict=True)
        if abs(correlation[a, b]) > CORRELATED
    ]
    return Information(estimates, sorted(pairs, key=lambda p: -abs(p[2])), len(residuals) / memory)


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


def _natural(problem: Problem, vector: Array) -> tuple[list[str], Array, list[str], Array]:
    """Return names, values and units of the parameters, and their derivatives by the vector."""
    names, values, units = _values(problem, vector)
    step = 1e-6
    turn = np.column_stack([
        (_values(problem, vector + step * unit)[1] - values) / step for unit in np.eye(len(vector))
    ])  # fmt: skip
    return names, values, units, turn


def _values(problem: Problem, vector: Array) -> tuple[list[str], Array, list[str]]:
    bench = problem.bench(vector)
    unit_of = {card.name: card.unit for card in describe(type(bench.damper))}
    names, values, units = [], [], []
    for component in problem.coordinates.components:
        value: Any = getattr(bench.damper, component.field)
        power = f"/A^{component.place}" if component.at is not None and component.place else ""
        names.append(component.name)
        values.append(value if component.place is None else value[component.place])
        units.append(unit_of[component.field] + power)
    rest = problem.names[len(names) :]
    beside = {f"temperature_factors.{name}": (value, "1/K") for name, value in bench.factors._asdict().items()}
    beside |= {"actuator.rate": (bench.rise, "1/s"), "actuator.rate_fall": (bench.fall, "1/s")}
    beside["bench.offset_per_kelvin"] = (bench.warming, "N/K")
    values += [beside[name][0] for name in rest]
    return names + rest, np.array(values, dtype=float), units + [beside[name][1] for name in rest]


def _sizes(problem: Problem, natural: Array) -> list[float]:
    """Return the size that a parameter's deviation is compared with: its own, or that of its law."""
    components = problem.coordinates.components
    sizes = [abs(float(x)) or math.inf for x in natural]
    for k, component in enumerate(components):
        if component.at is not None:
            end = problem.coordinates.end
            own = [j for j, other in enumerate(components) if other.field == component.field]
            sizes[k] = max(abs(float(natural[j])) * end ** (components[j].place or 0) for j in own)
            sizes[k] /= end ** (component.place or 0)
    return sizes
