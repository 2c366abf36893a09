"""Identification of a damper model: split, search, refine, judge on what took no part in the fit."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.bench_tables import BenchRecord, load_bench, matching
from seatsim.errors import InputError
from seatsim.identification.coordinates import Coordinates, Scales, fixed, scaled
from seatsim.identification.coverage import coverage, remarks
from seatsim.identification.figures import Figures, averaged, figures
from seatsim.identification.information import Information, information
from seatsim.identification.predict import Bench, Drive, drive, predicted
from seatsim.identification.problem import RATE, Problem, weights
from seatsim.identification.search import refined, started
from seatsim.identification.smoothing import sharpened, smoothed
from seatsim.registry import card_of, find
from seatsim.temperature import TemperatureFactors

Array = NDArray[np.float64]
Tell = Callable[[str], None]

SHORT = 10000
"""Rows of all records together on which the global search simulates."""
LEAST_SHORT = 300
"""Rows of a record that it takes at least."""
WARMTH = 5.0
"""K that the temperature must vary by for its influence to be fitted."""
OFF_CENTRE = 0.25
"""Middle of all motion, over half its range, from which on it counts as the origin of the displacement."""
PER_PARAMETER = 60
"""Simulations of the global search for every parameter."""


class Request(NamedTuple):
    """What is asked for: see `seatsim identify --help`; `start` is a damper record to start from, None the default."""

    test: Sequence[str] = ()
    test_fraction: float = 0.0
    fix: Mapping[str, float] = {}
    ignore_temperature: bool = False
    seed: int = 0


EVERYTHING = Request()


class Judged(NamedTuple):
    """A record, the part it had (train, test, predicted), its measured and predicted force, and their agreement."""

    record: BenchRecord
    part: str
    measured: Array
    predicted: Array
    figures: Figures


class Identification(NamedTuple):
    """The model found: its bench, the agreement on every record, and what the data say of its parameters."""

    model: str
    bench: Bench
    origin: float
    judged: list[Judged]
    information: Information
    bic: float
    seconds: float
    ns_per_step: float
    warm: bool
    coverage: dict[str, Any]
    notes: list[str]

    def mean(self, part: str) -> Figures | None:
        """Return the mean figures over the records of a part, None where it has none."""
        each = [judged.figures for judged in self.judged if judged.part == part]
        return averaged(each) if each else None


def identify(
    data: str | Path, model: str, request: Request = EVERYTHING, tell: Tell = lambda text: None
) -> Identification:
    """Fit a damper model to the bench records of a file or folder.

    The sum over records of (rms error / standard deviation of the force)^2 is minimised: a global search by CMA-ES on
    short stretches, then least squares on all training records.

    Raises:
        InputError: the data, the model or a pattern is not as it must be.
    """
    return identify_records(load_bench(data), model, request, tell)


def identify_records(records: list[BenchRecord], model: str, request: Request, tell: Tell) -> Identification:
    """Fit a damper model to bench records; see `identify`."""
    began = time.perf_counter()
    held_out = matching(records, list(request.test))
    train = [record for record in records if not any(record is other for other in held_out)]
    if not train:
        raise InputError(f"--test {' '.join(request.test)}: holds out every record; leave some to fit to")
    share = request.test_fraction
    if not 0.0 <= share < 1.0:
        raise InputError(f"--test-fraction {share:g}: is not permitted; it must lie from 0 to below 1")
    fitted = [record.part(0, round((1.0 - share) * len(record.force))) for record in train]
    origin = _origin(fitted)
    problem, short = _problems(fitted, find("damper", model), origin, request)
    vector = _found(problem, short, request.seed, tell)
    bench = problem.bench(vector)
    judged = [
        _judged(bench, record, "train", origin, 0, len(part.force)) for record, part in zip(train, fitted, strict=True)
    ]
    if share > 0.0:
        judged += [_judged(bench, r, "test", origin, len(p.force), None) for r, p in zip(train, fitted, strict=True)]
    judged += [_judged(bench, record, "test", origin) for record in held_out]
    tell("judging the parameters")
    known = information(problem, vector)
    bic = known.samples * math.log(problem.cost(vector)) + len(vector) * math.log(known.samples)
    notes = remarks(card_of(type(bench.damper)), fitted, [j.record for j in judged if j.part == "test"], origin)
    unknown = [estimate.name for estimate in known.estimates if not estimate.identified]
    notes += [f"the data do not identify {', '.join(unknown)}"] if unknown else []
    speed, seconds = _speed(bench, problem.drives), time.perf_counter() - began
    warm = problem.reference is not None
    return Identification(model, bench, origin, judged, known, bic, seconds, speed, warm, coverage(fitted), notes)


def predict(
    found: Identification, data: str | Path, moving_average: float = 0.0, centred: bool = False
) -> Identification:
    """Return an identification with its predictions of further records, which took no part in the fit.

    moving_average: seconds over which their owner averaged motion and force; centred: the mean of each force was
    removed.
    """
    more = []
    for record in load_bench(data):
        rows = round(moving_average * record.rate)
        judged = _judged(found.bench, sharpened(record, rows), "predicted", found.origin)
        force = smoothed(judged.predicted, rows)
        force = force - np.mean(force) if centred else force
        more.append(judged._replace(record=record, predicted=force, figures=figures(record.force, force)))
    return found._replace(judged=[*found.judged, *more])


def _origin(records: Sequence[BenchRecord]) -> float:
    """Return the displacement in m that counts as x = 0: 0, or the middle of all motion where that is far from it."""
    low = min(float(np.min(record.displacement)) for record in records)
    high = max(float(np.max(record.displacement)) for record in records)
    middle = 0.5 * (low + high)
    return round(middle, 4) if abs(middle) > OFF_CENTRE * 0.5 * (high - low) else 0.0


def _problems(records: list[BenchRecord], cls: Any, origin: float, request: Request) -> tuple[Problem, Problem]:
    """Return the whole problem and the one of short stretches."""
    end = max(float(np.max(record.current)) for record in records)
    steady = {round(record.mean_current, 3) for record in records}
    levels = 99 if any(np.ptp(record.current) > 0.0 for record in records) else len(steady)
    warmth = [record.temperature for record in records if record.temperature is not None]
    moved = len(warmth) == len(records) and max(map(np.max, warmth)) - min(map(np.min, warmth)) > WARMTH
    reference = float(np.mean(np.concatenate(warmth))) if moved and not request.ignore_temperature else None
    scales = Scales(
        float(np.sqrt(np.mean(np.concatenate([record.force for record in records]) ** 2))),
        max(float(np.std(record.displacement)) for record in records),
        max(float(np.std(record.velocity)) for record in records),
        end,
    )
    if min(scales[:3]) == 0.0:
        raise InputError("the records hold no motion or no force; identify a damper from records in which it moves")
    start = fixed(scaled(cls(), 1.0, end or 1.0), request.fix)
    coil = any(record.commanded for record in records)
    coordinates = Coordinates(start, scales, (*card_of(cls).held, *request.fix), levels)
    whole = _problem(records, coordinates, coil, reference, origin)
    rows = max(LEAST_SHORT, SHORT // len(records))
    return whole, _problem([_liveliest(r, rows) for r in records], coordinates, coil, reference, origin)


def _problem(
    records: list[BenchRecord], coordinates: Coordinates, coil: bool, reference: float | None, origin: float
) -> Problem:
    drives = [drive(record, origin, False) for record in records]
    return Problem(coordinates, drives, weights(records, drives), coil, reference)


def _liveliest(record: BenchRecord, rows: int) -> BenchRecord:
    """Return the stretch of so many rows with the highest mean speed."""
    if len(record.force) <= rows:
        return record
    travel = np.concatenate([[0.0], np.cumsum(np.abs(record.velocity))])
    first = int(np.argmax(travel[rows:] - travel[:-rows]))
    return record.part(first, first + rows)


def _found(problem: Problem, short: Problem, seed: int, tell: Tell) -> Array:
    """Return the best vector: least squares from the default and from the end of a global search."""
    plain = problem.vector(Bench(problem.coordinates.start, TemperatureFactors(), RATE, RATE))
    starts = [plain, _forced(short, plain)]
    first = min((refined(short, start, tell, 15) for start in starts), key=lambda pair: pair[1])
    near = refined(short, started(short, first[0], seed, PER_PARAMETER * len(plain), tell), tell, 15)
    candidates = sorted((first, near), key=lambda pair: pair[1])
    best = [refined(problem, vector, tell) for vector, cost in candidates if cost < 1.05 * candidates[0][1]]
    return min(best, key=lambda pair: pair[1])[0]


def _forced(problem: Problem, vector: Array) -> Array:
    """Return the vector with the forces of its damper scaled to the measured ones."""
    bench = problem.bench(vector)
    ours = np.concatenate([predicted(bench, drive) for drive in problem.drives])
    theirs = np.concatenate([drive.force for drive in problem.drives])
    ratio = float(np.std(theirs) / np.std(ours)) if np.all(np.isfinite(ours)) and np.std(ours) > 0.0 else 1.0
    return problem.vector(bench._replace(damper=scaled(bench.damper, ratio, problem.coordinates.end)))


def _judged(
    bench: Bench, record: BenchRecord, part: str, origin: float, first: int = 0, last: int | None = None
) -> Judged:
    """Return the agreement on rows `first` to `last` of a record that is simulated from its start."""
    force = predicted(bench, drive(record, origin, True))[first:last]
    measured = record.force[first:last]
    return Judged(record, part, measured, force, figures(measured, np.nan_to_num(force, nan=0.0)))


def _speed(bench: Bench, drives: Sequence[Drive]) -> float:
    """Return the nanoseconds of a step, the least of three runs."""
    times = []
    for _ in range(3):
        began = time.perf_counter()
        for each in drives:
            predicted(bench, each)
        times.append(time.perf_counter() - began)
    return 1e9 * min(times) / sum(len(each.force) for each in drives)
