"""A model to be fitted to bench records: the vector of all that is free, and the residuals it leaves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import NamedTuple

import numpy as np

from seatsim.identification.coordinates import Coordinates
from seatsim.identification.prediction import BenchModel, RecordInputs, predict_force
from seatsim.kernel.bench import TOLERANCE
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.arrays import Array

COIL_RATE = 130.0
"""1/s, the size of the coil's rates: those of Braz-Cesar and Barros 2012."""
COIL_RATE_SPAN = 30.0
"""Factor by which they may differ from it."""
PER_KELVIN = 0.01
"""1/K, the size of a temperature factor's component."""
MOST_PER_KELVIN = 0.03
"""1/K; that much takes nine tenths of a force over 80 K."""
OFFSET_PER_KELVIN = 1.0
"""N/K, the size of the component of the offset's growth."""
LEAST_SPREAD = 0.05
"""Least standard deviation of a record's force, over the largest one's, that its residuals are divided by."""
MOST_PARTS_IN_SEARCH = 32
"""Most parts of a step while a fit is looking: a stiffer model than that is a bad one, found quickly."""
NEAR_BOUND = 1e-3
"""Distance from a bound, in components of order one, that counts as on it."""
DIVERGED = 10.0
"""Scaled residual that stands for a force that is not finite, and that no other exceeds; over the mean force where that
is larger than the standard deviation."""
DIFFERENCE_STEP = 1e-3
"""Step of the differences, in components of order one: well above the simulation's error, well below their range."""


class IdentificationProblem(NamedTuple):
    """What is fitted: `coordinates` of the damper, then the coil's rates, then what temperature does.

    inputs, weights: of each record, and the factor of its residuals. fits_coil: whether the coil's rates are free.
    reference: temperature in degC at which the factors are 1, None where they are not fitted but `factors`.
    tolerance: that of the simulation.
    """

    coordinates: Coordinates
    inputs: list[RecordInputs]
    weights: list[float]
    fits_coil: bool
    reference: float | None
    tolerance: float = TOLERANCE
    factors: TemperatureFactors = TemperatureFactors()

    @property
    def labels(self) -> list[str]:
        """What the components are called; a law's is its value at a current."""
        return [component.label for component in self.coordinates.components] + self.bench_names

    @property
    def bench_names(self) -> list[str]:
        """Names of what is free in addition to the damper."""
        warm = [*(f"temperature_factors.{name}" for name in TemperatureFactors._fields[:3]), "bench.offset_per_kelvin"]
        coil = ["actuator.rate", "actuator.rate_fall"] if self.fits_coil else []
        return coil + (warm if self.reference is not None else [])

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Least and greatest value of every component, each of shape (P,)."""
        coil = [math.log(COIL_RATE_SPAN)] * 2 * self.fits_coil
        warm = [MOST_PER_KELVIN / PER_KELVIN] * 3 + [math.inf] if self.reference is not None else []
        beside = np.array(coil + warm)
        return np.append(self.coordinates.low, -beside), np.append(self.coordinates.high, beside)

    def labels_at_bounds(self, vector: Array) -> list[str]:
        """Return what stands at the least or the greatest value that it may have."""
        low, high = self.bounds
        near = (vector <= low + NEAR_BOUND) | (vector >= high - NEAR_BOUND)
        return [label for label, end in zip(self.labels, near, strict=True) if end]

    def to_vector(self, bench: BenchModel) -> Array:
        """Return the vector of a bench, shape (P,)."""
        coil = [math.log(rate / COIL_RATE) for rate in (bench.rise, bench.fall)] if self.fits_coil else []
        warm = [*(factor / PER_KELVIN for factor in bench.factors[:3]), bench.offset_per_kelvin / OFFSET_PER_KELVIN]
        beside = coil + (warm if self.reference is not None else [])
        return np.append(self.coordinates.to_vector(bench.damper), beside)

    def to_bench(self, vector: Array) -> BenchModel:
        """Return the bench of a vector of shape (P,)."""
        count = len(self.coordinates.components)
        damper, beside = self.coordinates.to_record(vector[:count]), [float(number) for number in vector[count:]]
        rise, fall = (COIL_RATE * math.exp(number) for number in (beside[:2] if self.fits_coil else (0.0, 0.0)))
        if self.reference is None:
            return BenchModel(damper, self.factors, rise, fall)
        viscous, stiffness, yielding = (PER_KELVIN * number for number in beside[-4:-1])
        factors = TemperatureFactors(viscous, stiffness, yielding, self.reference)
        return BenchModel(damper, factors, rise, fall, OFFSET_PER_KELVIN * beside[-1])

    def residuals(self, vector: Array) -> Array:
        """Return the residuals, each record's over the size of its force and the root of its length, shape (N,)."""
        bench = self.to_bench(vector)
        parts = []
        for inputs, weight in zip(self.inputs, self.weights, strict=True):
            force = predict_force(bench, inputs, MOST_PARTS_IN_SEARCH, self.tolerance)
            part = weight * (force - inputs.force)[inputs.counted :]
            # A mean of many standard deviations, as that of a gas force, is no divergence.
            offset = weight * len(part) ** 0.5 * abs(float(np.mean(inputs.force[inputs.counted :])))
            limit = max(1.0, offset) * DIVERGED / math.sqrt(len(part))
            parts.append(np.clip(np.where(np.isfinite(part), part, limit), -limit, limit))
        return np.concatenate(parts)

    def cost(self, vector: Array) -> float:
        """Return the mean square over records of the error over the size of the force."""
        return float(np.sum(self.residuals(vector) ** 2)) / len(self.inputs)


def weight_records(records: Sequence[BenchRecord], inputs: Sequence[RecordInputs]) -> list[float]:
    """Return the factors `1 / (std(y) sqrt(N))` that give every record the same weight."""
    spreads = np.array([np.std(record.force) for record in records])
    least = LEAST_SPREAD * float(np.max(spreads))
    counted = [len(each.force) - each.counted for each in inputs]
    return [1.0 / (max(s, least) * math.sqrt(n)) for s, n in zip(spreads, counted, strict=True)]


def compute_jacobian(
    problem: IdentificationProblem, vector: Array, residuals: Array, executor: Executor, step: float = DIFFERENCE_STEP
) -> Array:
    """Return the derivatives of the residuals, shape (N, P), by forward differences, a column a call of the executor.

    The difference goes backwards where the greatest value is near.
    """
    _, high = problem.bounds

    def column(k: int) -> Array:
        size = step if vector[k] + step <= high[k] else -step
        moved = vector.copy()
        moved[k] += size
        return (problem.residuals(moved) - residuals) / size

    return np.column_stack(list(executor.map(column, range(len(vector)))))
