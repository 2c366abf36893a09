"""A model to be fitted to bench records: all that is free as a vector, the residuals it leaves, how it is posed."""

import math
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import NamedTuple

import numpy as np

from seatsim.compilation.cached import compiled
from seatsim.dampers.base import DAMPERS
from seatsim.identification.damper_record import Component, Coordinates, DamperRecord, Scales, start_record
from seatsim.identification.settings import IdentificationSettings
from seatsim.kernel.augmented import classes_of
from seatsim.kernel.bench import MOST_PARTS, TOLERANCE, run_bench, simulate_current
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError

_FAST_ENOUGH = 400.0
"""Hz; at this rate and above every second row is the middle of a step."""
_ROOM_TEMPERATURE = 20.0
"""degC, where no temperature was recorded."""


class BenchModel(NamedTuple):
    """What the force on a bench depends on: the damper, its temperature factors, the coil's rates in 1/s.

        F = F_damper(x, v, i, T) + g (T - T0),   di/dt = r (u - i),  r = rise where u > i, else fall

    offset_per_kelvin: g in N/K, by which the offset grows as the gas warms up from the factors' reference temperature
    T0.
    """

    damper: DamperRecord
    factors: TemperatureFactors
    rise: float = 130.0
    fall: float = 130.0
    offset_per_kelvin: float = 0.0

    def predict(self, record: BenchRecord, origin: float) -> Array:
        """Return the force in N at the rows of a record, shape (N,); `origin` is what counts as x = 0, in m."""
        return predict_force(self, prepare_inputs(record, origin, True))


class RecordInputs(NamedTuple):
    """A record as it drives the bench: samples every half step, shape (2 n + 1,), and the measured force at steps.

    x [m] from the origin, v [m/s], current [A] (a command for the coil where `commanded`), temperature [degC], step
    [s]; force [N] has shape (n + 1,). Steps before the one `counted` only bring the damper into its state.
    """

    x: Array
    v: Array
    current: Array
    commanded: bool
    temperature: Array
    step: float
    force: Array
    counted: int = 0


def prepare_inputs(record: BenchRecord, origin: float, every: bool) -> RecordInputs:
    """Return a record as inputs: every row a step, or, unless `every`, each second one where the rows are close.

    origin: displacement in m that counts as x = 0.
    """
    x, v = record.displacement - origin, record.velocity
    warm = np.full(len(x), _ROOM_TEMPERATURE) if record.temperature is None else record.temperature
    rate = record.rate
    if not every and rate >= _FAST_ENOUGH:
        odd = slice(0, len(x) - 1 + len(x) % 2)
        x, v, current, warm = (np.ascontiguousarray(y[odd]) for y in (x, v, record.current, warm))
        return RecordInputs(x, v, current, record.commanded, warm, 2.0 / rate, record.force[odd][::2].copy())
    # A command holds until its next row; a current that was measured goes straight on to it.
    current = np.repeat(record.current, 2)[:-1] if record.commanded else _halve_linearly(record.current)
    x, v, warm = _halve_cubically(x), _halve_cubically(v), _halve_linearly(warm)
    return RecordInputs(x, v, current, record.commanded, warm, 1.0 / rate, record.force.copy())


def _halve_cubically(y: Array) -> Array:
    """Return samples and the values between them, of the cubic through the four nearest."""
    out = _halve_linearly(y)
    out[3:-3:2] = (9.0 * (y[1:-2] + y[2:-1]) - y[:-3] - y[3:]) / 16.0
    return out


def _halve_linearly(y: Array) -> Array:
    """Return samples and the means between them."""
    out = np.empty(2 * len(y) - 1)
    out[::2] = y
    out[1::2] = 0.5 * (y[1:] + y[:-1])
    return out


def predict_force(
    bench: BenchModel, inputs: RecordInputs, most: int = MOST_PARTS, tolerance: float = TOLERANCE
) -> Array:
    """Return the force in N at the inputs' steps, shape (n + 1,); NaN from where the state ran away.

    A step is divided into at most `most` parts until its error, over the force, is below `tolerance`.
    """
    current = inputs.current
    if inputs.commanded:
        current = simulate_current(Coil(bench.rise, rate_fall=bench.fall), current, 0.5 * inputs.step, current[0])
    out = np.full(len(inputs.force), math.nan)
    run = compiled(run_bench, classes_of(bench.damper))
    state = DAMPERS.specification_of(type(bench.damper)).initial
    given = (inputs.x, inputs.v, current, inputs.temperature, state, inputs.step, most, tolerance, out)
    run(bench.damper, bench.factors, *given)
    return out + bench.offset_per_kelvin * (inputs.temperature[::2] - bench.factors.reference)


_COIL, _OFFSET = ("actuator.rate", "actuator.rate_fall"), "bench.offset_per_kelvin"
_FACTORS = tuple(f"temperature_factors.{name}" for name in TemperatureFactors._fields[:3])
"""Keys of `parameters.yaml` for what may be free beside the damper."""
COIL_RATE = 130.0
"""1/s, the size of the coil's rates: those of Braz-Cesar and Barros 2012."""
_COIL_RATE_SPAN = 30.0
"""Factor by which they may differ from it."""
_PER_KELVIN = 0.01
"""1/K, the size of a temperature factor's component."""
_MOST_PER_KELVIN = 0.03
"""1/K; that much takes nine tenths of a force over 80 K."""
_OFFSET_PER_KELVIN = 1.0
"""N/K, the size of the component of the offset's growth."""
_LEAST_SPREAD = 0.05
"""Least standard deviation of a record's force, over the largest one's, that its residuals are divided by."""
MOST_PARTS_IN_SEARCH = 32
"""Most parts of a step while a fit is looking: a stiffer model than that is a bad one, found quickly."""
_NEAR_BOUND = 1e-3
"""Distance from a bound, in components of order one, that counts as on it."""
_DIVERGED = 10.0
"""Scaled residual that stands for a force that is not finite, and that no other exceeds; over the mean force where that
is larger than the standard deviation."""
_DIFFERENCE_STEP = 1e-3
"""Step of the differences, in components of order one: well above the simulation's error, well below their range."""


class IdentificationProblem(NamedTuple):
    """What is fitted: `coordinates` of the damper, then what is free `beside` it (see `_list_beside`).

    inputs, weights: of each record, and the factor of its residuals. reference: temperature in degC at which the
    factors are 1, None where they are not fitted but `factors`. tolerance: that of the simulation.
    """

    coordinates: Coordinates
    inputs: list[RecordInputs]
    weights: list[float]
    beside: list[Component]
    reference: float | None
    tolerance: float = TOLERANCE
    factors: TemperatureFactors = TemperatureFactors()

    @property
    def start(self) -> BenchModel:
        """The bench that the coordinates start from."""
        return BenchModel(self.coordinates.start, TemperatureFactors(), COIL_RATE, COIL_RATE)

    @property
    def components(self) -> list[Component]:
        """All that is free, in the order of the vector."""
        return [*self.coordinates.components, *self.beside]

    @property
    def labels(self) -> list[str]:
        """What the components are called; a law's is its value at a current."""
        return [component.label for component in self.components]

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Least and greatest value of every component, each of shape (P,)."""
        return np.array([c.low for c in self.components]), np.array([c.high for c in self.components])

    def labels_at_bounds(self, vector: Array) -> list[str]:
        """Return what stands at the least or the greatest value that it may have."""
        low, high = self.bounds
        near = (vector <= low + _NEAR_BOUND) | (vector >= high - _NEAR_BOUND)
        return [label for label, end in zip(self.labels, near, strict=True) if end]

    def to_vector(self, bench: BenchModel) -> Array:
        """Return the vector of a bench, shape (P,)."""
        values = read_bench(bench)
        return np.append(self.coordinates.to_vector(bench.damper), [c.to_number(values[c.field]) for c in self.beside])

    def to_bench(self, vector: Array) -> BenchModel:
        """Return the bench of a vector of shape (P,)."""
        count = len(self.coordinates.components)
        damper = self.coordinates.to_record(vector[:count])
        found = {c.field: c.to_value(number) for c, number in zip(self.beside, vector[count:], strict=True)}
        rise, fall = (found.get(name, COIL_RATE) for name in _COIL)
        if self.reference is None:
            return BenchModel(damper, self.factors, rise, fall)
        viscous, stiffness, yielding = (found[name] for name in _FACTORS)
        factors = TemperatureFactors(viscous, stiffness, yielding, self.reference)
        return BenchModel(damper, factors, rise, fall, found[_OFFSET])

    def residuals(self, vector: Array) -> Array:
        """Return the residuals, each record's over the size of its force and the root of its length, shape (N,)."""
        bench = self.to_bench(vector)
        parts = []
        for inputs, weight in zip(self.inputs, self.weights, strict=True):
            force = predict_force(bench, inputs, MOST_PARTS_IN_SEARCH, self.tolerance)
            part = weight * (force - inputs.force)[inputs.counted :]
            # A mean of many standard deviations, as that of a gas force, is no divergence.
            offset = weight * len(part) ** 0.5 * abs(float(np.mean(inputs.force[inputs.counted :])))
            limit = max(1.0, offset) * _DIVERGED / math.sqrt(len(part))
            parts.append(np.clip(np.where(np.isfinite(part), part, limit), -limit, limit))
        return np.concatenate(parts)

    def cost(self, vector: Array) -> float:
        """Return the mean square over records of the error over the size of the force."""
        return float(np.sum(self.residuals(vector) ** 2)) / len(self.inputs)


def read_bench(bench: BenchModel) -> dict[str, float]:
    """Return what may be free of a bench beside its damper, by the key that it has in `parameters.yaml`."""
    numbers = (bench.rise, bench.fall, *bench.factors[:3], bench.offset_per_kelvin)
    return dict(zip((*_COIL, *_FACTORS, _OFFSET), numbers, strict=True))


def _list_beside(fits_coil: bool, fits_temperature: bool) -> list[Component]:
    """Return what is free beside the damper: rates of the coil, temperature factors and the growth of the offset."""
    span, most = math.log(_COIL_RATE_SPAN), _MOST_PER_KELVIN / _PER_KELVIN
    coil = [Component(name, None, "1/s", COIL_RATE, COIL_RATE, True, -span, span) for name in _COIL]
    warm = [Component(name, None, "1/K", _PER_KELVIN, _PER_KELVIN, False, -most, most) for name in _FACTORS]
    offset = Component(_OFFSET, None, "N/K", _OFFSET_PER_KELVIN, _OFFSET_PER_KELVIN, False, -math.inf, math.inf)
    return coil * fits_coil + [*warm, offset] * fits_temperature


def _weight_records(records: Sequence[BenchRecord], inputs: Sequence[RecordInputs]) -> list[float]:
    """Return the factors `1 / (std(y) sqrt(N))` that give every record the same weight."""
    spreads = np.array([np.std(record.force) for record in records])
    least = _LEAST_SPREAD * float(np.max(spreads))
    counted = [len(each.force) - each.counted for each in inputs]
    return [1.0 / (max(s, least) * math.sqrt(n)) for s, n in zip(spreads, counted, strict=True)]


def compute_jacobian(problem: IdentificationProblem, vector: Array, residuals: Array, executor: Executor) -> Array:
    """Return the derivatives of the residuals, shape (N, P), by forward differences, a column a call of the executor.

    The difference goes backwards where the greatest value is near.
    """
    _, high = problem.bounds

    def column(k: int) -> Array:
        size = _DIFFERENCE_STEP if vector[k] + _DIFFERENCE_STEP <= high[k] else -_DIFFERENCE_STEP
        moved = vector.copy()
        moved[k] += size
        return (problem.residuals(moved) - residuals) / size

    return np.column_stack(list(executor.map(column, range(len(vector)))))


_SEARCH_ROWS = 10000
"""Rows of all records together that count in the global search."""
_LEAST_SEARCH_ROWS = 300
"""Rows of a record that it takes at least."""
_LEAST_WARMING = 5.0
"""K that the temperature must vary by for its influence to be fitted."""
_LEAST_CURRENT = 1e-3
"""A; records that hold less hold none: a law stretched to the rounding of a current has no meaning."""
_OFF_CENTRE = 0.25
"""Middle of all motion, over half its range, from which on it counts as the origin of the displacement."""


def find_origin(records: Sequence[BenchRecord]) -> float:
    """Return the displacement in m that counts as x = 0: 0, or the middle of all motion where that is far from it."""
    low = min(float(np.min(record.displacement)) for record in records)
    high = max(float(np.max(record.displacement)) for record in records)
    middle = 0.5 * (low + high)
    return round(middle, 4) if abs(middle) > _OFF_CENTRE * 0.5 * (high - low) else 0.0


def state_problem(
    records: Sequence[BenchRecord],
    cls: type[DamperRecord],
    origin: float,
    settings: IdentificationSettings,
    known: DamperRecord | None = None,
) -> tuple[IdentificationProblem, IdentificationProblem]:
    """Return the problem of fitting a class to whole records, and to the liveliest stretch of each.

    The fit starts from `known`, a record of the class, or from the defaults of the class where there is none.

    Raises:
        InputError: nothing moves, the class has a number without default, or what is fixed is none of its numbers or
            all of them.
    """
    coordinates = _choose_coordinates(records, cls, settings, known)
    reference = None if settings.ignore_temperature else _reference_temperature(records)
    beside = _list_beside(any(record.commanded for record in records), reference is not None)
    inputs = [prepare_inputs(record, origin, False) for record in records]
    rows = max(_LEAST_SEARCH_ROWS, _SEARCH_ROWS // len(records))
    stretches = [record.liveliest(rows) for record in records]
    short = [_with_run_up(record, stretch, origin) for record, stretch in zip(records, stretches, strict=True)]
    parts = [record.part(*stretch) for record, stretch in zip(records, stretches, strict=True)]
    whole = IdentificationProblem(coordinates, inputs, _weight_records(records, inputs), beside, reference)
    return whole, whole._replace(inputs=short, weights=_weight_records(parts, short))


def _choose_coordinates(
    records: Sequence[BenchRecord],
    cls: type[DamperRecord],
    settings: IdentificationSettings,
    known: DamperRecord | None,
) -> Coordinates:
    """Return the free parameters, from defaults with their laws stretched to the largest current of the data."""
    scales = _measure_scales(records)
    start = start_record(cls, known, scales.current or 1.0, settings.fix)
    fixed = (*DAMPERS.specification_of(cls).fixed, *settings.fix)
    coordinates = Coordinates(start, scales, fixed, _count_levels(records))
    if not coordinates.components:
        problem = f"--fix {', '.join(settings.fix)} leaves no parameter of {cls.__name__} to fit; leave one free"
        raise InputError(problem)
    return coordinates


def _measure_scales(records: Sequence[BenchRecord]) -> Scales:
    force = float(np.sqrt(np.mean(np.concatenate([record.force for record in records]) ** 2)))
    stroke = max(float(np.std(record.displacement)) for record in records)
    speed = max(float(np.std(record.velocity)) for record in records)
    if min(force, stroke, speed) == 0.0:
        raise InputError("the records hold no motion or no force; identify a damper from records in which it moves")
    current = max(float(np.max(record.current)) for record in records)
    return Scales(force, stroke, speed, current if current >= _LEAST_CURRENT else 0.0)


def _count_levels(records: Sequence[BenchRecord]) -> int | None:
    """Return the number of constant currents, None where the current varies within a record."""
    if any(np.ptp(record.current) > 0.0 for record in records):
        return None
    return len({round(record.mean_current, 3) for record in records})


def _reference_temperature(records: Sequence[BenchRecord]) -> float | None:
    """Return the mean temperature in degC, None where it was not recorded or hardly varies."""
    warmth = [record.temperature for record in records if record.temperature is not None]
    if len(warmth) < len(records) or max(map(np.max, warmth)) - min(map(np.min, warmth)) <= _LEAST_WARMING:
        return None
    return float(np.mean(np.concatenate(warmth)))


def _with_run_up(record: BenchRecord, stretch: tuple[int, int], origin: float) -> RecordInputs:
    """Return the inputs of a stretch and of as many rows before it, in which the state forgets its start at rest."""
    first, last = stretch
    begin = max(0, 2 * first - last)
    found = prepare_inputs(record.part(begin, last), origin, False)
    return found._replace(counted=round((first - begin) / record.rate / found.step))
