"""What a fit is worth: how well its predictions agree with records, and how sure its parameters are.

What the data say of each parameter is its Fisher information, which respects that residuals are not independent.
"""

from collections.abc import Sequence
from concurrent.futures import Executor
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.dampers.base import DamperSpecification
from seatsim.identification.damper_record import Component
from seatsim.identification.problem import BenchModel, IdentificationProblem, compute_jacobian, read_bench
from seatsim.identification.settings import Split
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.schema.arrays import Array
from seatsim.schema.content import Form, Joined, Unwritten, written
from seatsim.simulation.damper_bench import centring

_GUARD = 0.05
"""Share of a record's peak force below which a measured force does not count in the mean deviation."""


class Agreement(NamedTuple):
    """Agreement of a predicted force s with a measured one y.

    r2            1 - sum (y - s)^2 / sum (y - mean y)^2
    md            mean of |y - s| / |y|, over the samples where |y| is more than 5 % of its peak
    rmse          sqrt(mean (y - s)^2), N
    fit_percent   100 (1 - ||y - s|| / ||y - mean y||)

    Source: Yu et al. 2019 eqs 6-8 for the first three. Its eq 7 diverges where the measured force crosses zero; the
    guard is ours.
    """

    r2: float
    md: float
    rmse: float
    fit_percent: float


def assess_agreement(measured: Array, predicted: Array) -> Agreement:
    """Return the agreement on one record, arrays of shape (N,) in N; minus infinity for a force that never varies."""
    error = measured - predicted
    spread = float(np.sum((measured - np.mean(measured)) ** 2))
    share = float(np.sum(error**2)) / spread if spread > 0.0 else np.inf
    counted = np.abs(measured) > _GUARD * np.max(np.abs(measured))
    deviation = float(np.mean(np.abs(error[counted] / measured[counted]))) if counted.any() else np.inf
    rmse = float(np.sqrt(np.mean(error**2)))
    return Agreement(1.0 - share, deviation, rmse, 100.0 * (1.0 - share**0.5))


def mean_agreement(each: Sequence[Agreement]) -> Agreement | None:
    """Return the mean of every figure over records, each of which has the same weight; None of none."""
    return Agreement(*(float(np.mean(values)) for values in zip(*each, strict=True))) if each else None


class Assessment(NamedTuple):
    """A record or a part of one, what it was for (train, test), its predicted force in N, the agreement.

    The force is NaN from where the state ran away; there it counts as zero in the agreement.
    """

    record: Unwritten[BenchRecord]
    part: str
    predicted: Unwritten[Array]
    agreement: Joined[Agreement]

    @property
    @written()
    def current(self) -> float:
        """Mean current in A."""
        return self.record.mean_current

    @property
    def complete(self) -> bool:
        """Whether the state stayed finite."""
        return bool(np.all(np.isfinite(self.predicted)))


def assess_fit(bench: BenchModel, parts: Split, origin: float) -> list[Assessment]:
    """Return the agreement on what was fitted, then on what was held out; every record is simulated from its start.

    origin: displacement in m that counts as x = 0.
    """
    train, rest = [], []
    for record, fitted in zip(parts.train, parts.fitted, strict=True):
        force = bench.predict(record, origin)
        rows = len(fitted.force)
        train.append(_assess(fitted, "train", force[:rows]))
        if rows < len(force):
            rest.append(_assess(record.part(rows, len(force)), "test", force[rows:]))
    return train + rest + [_assess(record, "test", bench.predict(record, origin)) for record in parts.held_out]


def _assess(record: BenchRecord, part: str, force: Array) -> Assessment:
    return Assessment(record, part, force, assess_agreement(record.force, np.where(np.isfinite(force), force, 0.0)))


_BEYOND = 1.05
"""Factor from which a held-out record counts as beyond what was fitted."""


def note_limits(
    specification: DamperSpecification, train: Sequence[BenchRecord], test: Sequence[BenchRecord], origin: float
) -> list[str]:
    """Return what the user should know of the data: motion off centre, tests outside what was fitted."""
    notes = []
    if specification.centred:
        off = next((text for r in train if (text := centring(r.displacement - origin, r.velocity))), "")
        notes += [off] if off else []
    for name, unit in (("velocity", "m/s"), ("current", "A"), ("displacement", "m")):
        fitted = max(_largest(record, name) for record in train)
        tested = max((_largest(record, name) for record in test), default=0.0)
        if tested > _BEYOND * fitted:
            beyond = f"held-out records reach {tested:.3g} {unit} of {name}"
            notes.append(f"{beyond}, the fitted ones {fitted:.3g} {unit} only")
    return notes


def _largest(record: BenchRecord, name: str) -> float:
    """Return the largest magnitude of one of a record's quantities."""
    return float(np.max(np.abs(record._asdict()[name])))


_IDENTIFIED = 0.1
"""Standard deviation, over the parameter's size, above which the data are said not to identify it."""
_LEAST = 1e-13
"""Sensitivity and eigenvalue of the information, over the largest, below which there is none."""
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
    """Estimates of the parameters, and the effective number of samples."""

    estimates: Annotated[list[ParameterEstimate], Form(key="parameters")]
    samples: Annotated[float, Form(key="effective_samples")]

    @property
    @written()
    def not_identified(self) -> list[str]:
        """Names of the parameters that the data do not identify."""
        return [estimate.name for estimate in self.estimates if not estimate.identified]


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
    return Information(_estimates(problem, vector, covariance), samples)


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
    values, steps = _values(problem, vector), _DIFFERENCE_STEP * np.eye(len(vector))
    return np.column_stack([(_values(problem, vector + step) - values) / _DIFFERENCE_STEP for step in steps])


def _sizes(problem: IdentificationProblem, values: Array) -> list[float]:
    """Return the size that each parameter's deviation is compared with."""
    pairs, end = list(zip(problem.components, map(float, values), strict=True)), problem.coordinates.end
    laws: dict[str, float] = {}
    for c, value in pairs:
        if c.at is not None:
            laws[c.field] = max(laws.get(c.field, c.natural), abs(value) * end ** (c.position or 0))
    return [
        laws[c.field] / end ** (c.position or 0)
        if c.at is not None
        else max(abs(value), 0.0 if c.logarithmic else c.natural)
        for c, value in pairs
    ]
