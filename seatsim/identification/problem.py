"""A model to be fitted to bench records: the vector of all that is free, and the residuals it leaves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.identification.coordinates import Coordinates
from seatsim.identification.predict import Bench, Drive, predicted
from seatsim.kernel.bench import TOLERANCE
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.rig.temperature import TemperatureFactors

Array = NDArray[np.float64]

RATE = 130.0
"""1/s, the size of the coil's rates: those of Braz-Cesar and Barros 2012."""
RATE_SPAN = 30.0
"""Factor by which they may differ from it."""
PER_KELVIN = 0.01
"""1/K, the size of a temperature factor's component."""
MOST_PER_KELVIN = 0.03
WARMING = 1.0
"""N/K, the size of the component of the offset's growth."""
QUIET = 0.05
"""Least standard deviation of a record's force, over the largest one's, that its residuals are divided by."""
PARTS = 32
"""Most parts of a step while a fit is looking: a stiffer model than that is a bad one, found quickly."""
AT_END = 1e-3
"""Distance from a bound, in components of order one, that counts as on it."""
AWAY = 10.0
"""Scaled residual that stands for a force that is not finite."""


class Problem(NamedTuple):
    """What is fitted: `coordinates` of the damper, then the coil's rates, then what temperature does.

    reference: temperature in degC at which the factors are 1, None where it is no input; tolerance: that of the
    simulation.
    """

    coordinates: Coordinates
    drives: list[Drive]
    weights: list[float]
    coil: bool
    reference: float | None
    tolerance: float = TOLERANCE

    @property
    def labels(self) -> list[str]:
        """What the components are called; a law's is its value at a current."""
        return [component.label for component in self.coordinates.components] + self.beside

    @property
    def beside(self) -> list[str]:
        """Names of what is free beside the damper."""
        warm = [*(f"temperature_factors.{name}" for name in TemperatureFactors._fields[:3]), "bench.offset_per_kelvin"]
        coil = ["actuator.rate", "actuator.rate_fall"] if self.coil else []
        return coil + (warm if self.reference is not None else [])

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Least and greatest value of every component."""
        coil = [math.log(RATE_SPAN)] * 2 * self.coil
        warm = [MOST_PER_KELVIN / PER_KELVIN] * 3 + [math.inf] if self.reference is not None else []
        beside = np.array(coil + warm)
        return np.append(self.coordinates.low, -beside), np.append(self.coordinates.high, beside)

    def at_ends(self, vector: Array) -> list[str]:
        """Return what stands at the least or the greatest value that it may have."""
        low, high = self.bounds
        near = (vector <= low + AT_END) | (vector >= high - AT_END)
        return [label for label, end in zip(self.labels, near, strict=True) if end]

    def vector(self, bench: Bench) -> Array:
        """Return the vector of a bench."""
        coil = [math.log(rate / RATE) for rate in (bench.rise, bench.fall)] if self.coil else []
        warm = [*(factor / PER_KELVIN for factor in bench.factors[:3]), bench.warming / WARMING]
        beside = coil + (warm if self.reference is not None else [])
        return np.append(self.coordinates.vector(bench.damper), beside)

    def bench(self, vector: Array) -> Bench:
        """Return the bench of a vector."""
        count = len(self.coordinates.components)
        damper, rest = self.coordinates.record(vector[:count]), [float(number) for number in vector[count:]]
        rise, fall = (RATE * math.exp(number) for number in (rest[:2] if self.coil else (0.0, 0.0)))
        if self.reference is None:
            return Bench(damper, TemperatureFactors(), rise, fall)
        viscous, stiffness, yielding = (PER_KELVIN * number for number in rest[-4:-1])
        factors = TemperatureFactors(viscous, stiffness, yielding, self.reference)
        return Bench(damper, factors, rise, fall, WARMING * rest[-1])

    def residuals(self, vector: Array) -> Array:
        """Return the residuals, each record's over the size of its force and the root of its length."""
        bench = self.bench(vector)
        parts = []
        for drive, weight in zip(self.drives, self.weights, strict=True):
            part = weight * (predicted(bench, drive, PARTS, self.tolerance) - drive.force)[drive.counted :]
            limit = AWAY / math.sqrt(len(part))
            parts.append(np.clip(np.where(np.isfinite(part), part, limit), -limit, limit))
        return np.concatenate(parts)

    def cost(self, vector: Array) -> float:
        """Return the mean square over records of the error over the size of the force."""
        return float(np.sum(self.residuals(vector) ** 2)) / len(self.drives)


def weights(records: Sequence[BenchRecord], drives: Sequence[Drive]) -> list[float]:
    """Return the factors that make every record count alike."""
    spreads = np.array([np.std(record.force) for record in records])
    least = QUIET * float(np.max(spreads))
    counted = [len(drive.force) - drive.counted for drive in drives]
    return [1.0 / (max(s, least) * math.sqrt(n)) for s, n in zip(spreads, counted, strict=True)]


def jacobian(problem: Problem, vector: Array, residuals: Array, step: float = 1e-3) -> Array:
    """Return the derivatives of the residuals, shape (N, P), by differences, on all processors."""
    _, high = problem.bounds

    def column(k: int) -> Any:
        size = step if vector[k] + step <= high[k] else -step
        moved = vector.copy()
        moved[k] += size
        return (problem.residuals(moved) - residuals) / size

    with ThreadPoolExecutor() as pool:
        return np.column_stack(list(pool.map(column, range(len(vector)))))
