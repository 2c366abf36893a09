"""A model to be fitted to bench records: the vector of all that is free, and the residuals it leaves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.bench_tables import BenchRecord
from seatsim.identification.coordinates import Coordinates
from seatsim.identification.predict import Bench, Drive, predicted
from seatsim.temperature import TemperatureFactors

Array = NDArray[np.float64]

WARMTH = 5.0
"""K that a temperature must vary by for its factors to be fitted."""
PER_KELVIN = 0.01
"""1/K, the size of a temperature factor's component."""
QUIET = 0.05
"""Least standard deviation of a record's force, over the largest one's, that its residuals are divided by."""
AWAY = 10.0
"""Scaled residual that stands for a force that is not finite."""


class Problem(NamedTuple):
    """What is fitted: `coordinates` of the damper, then the coil's rates, then the temperature factors."""

    coordinates: Coordinates
    drives: list[Drive]
    weights: list[float]
    coil: bool
    warm: bool
    reference: float

    @property
    def names(self) -> list[str]:
        """Names of the components."""
        coil = ["actuator.rate", "actuator.rate_fall"] if self.coil else []
        warm = [f"temperature_factors.{name}" for name in TemperatureFactors._fields[:3]] if self.warm else []
        return [component.name for component in self.coordinates.components] + coil + warm

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Least and greatest value of every component."""
        size = math.log(30.0)
        low = [self.coordinates.low, [-size] * 2 * self.coil, [-3.0] * 3 * self.warm]
        high = [self.coordinates.high, [size] * 2 * self.coil, [3.0] * 3 * self.warm]
        return np.concatenate(low), np.concatenate(high)

    def vector(self, bench: Bench) -> Array:
        """Return the vector of a bench."""
        coil = np.log(np.array([bench.rise, bench.fall]) / RATE) if self.coil else np.zeros(0)
        warm = np.array(bench.factors[:3]) / PER_KELVIN if self.warm else np.zeros(0)
        return np.concatenate([self.coordinates.vector(bench.damper), coil, warm])

    def bench(self, vector: Array) -> Bench:
        """Return the bench of a vector."""
        count = len(self.coordinates.components)
        rest = [float(number) for number in vector[count:]]
        rise, fall = (RATE * math.exp(rest.pop(0)), RATE * math.exp(rest.pop(0))) if self.coil else (RATE, RATE)
        factors = TemperatureFactors(*(PER_KELVIN * number for number in rest), reference=self.reference)
        return Bench(self.coordinates.record(vector[:count]), factors, rise, fall)

    def residuals(self, vector: Array) -> Array:
        """Return the residuals, each record's over the size of its force and the root of its length."""
        bench = self.bench(vector)
        parts = []
        for drive, weight in zip(self.drives, self.weights, strict=True):
            part = weight * (predicted(bench, drive) - drive.force)
            limit = AWAY / math.sqrt(len(part))
            parts.append(np.clip(np.where(np.isfinite(part), part, limit), -limit, limit))
        return np.concatenate(parts)

    def cost(self, vector: Array) -> float:
        """Return the mean square over records of the error over the size of the force."""
        return float(np.sum(self.residuals(vector) ** 2)) / len(self.drives)


RATE = 130.0
"""1/s, the size of the coil's rates: those of Braz-Cesar and Barros 2012."""


def weights(records: Sequence[BenchRecord], drives: Sequence[Drive]) -> list[float]:
    """Return the factors that make every record count alike."""
    spreads = np.array([np.std(record.force) for record in records])
    least = QUIET * float(np.max(spreads))
    return [1.0 / (max(s, least) * math.sqrt(len(d.force))) for s, d in zip(spreads, drives, strict=True)]


def jacobian(problem: Problem, vector: Array, residuals: Array, step: float = 1e-3) -> Array:
    """Return the derivatives of the residuals, shape (N, P), by differences, on all processors."""
    low, high = problem.bounds

    def column(k: int) -> Any:
        size = step if vector[k] + step <= high[k] else -step
        moved = vector.copy()
        moved[k] += size
        return (problem.residuals(moved) - residuals) / size

    with ThreadPoolExecutor() as pool:
        return np.column_stack(list(pool.map(column, range(len(vector)))))
