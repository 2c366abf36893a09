"""Identification of a damper model: split, search, refine, judge on what took no part in the fit."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from seatsim.identification.coverage import coverage, remarks
from seatsim.identification.figures import Figures, averaged
from seatsim.identification.information import Information, information
from seatsim.identification.judging import Further, Judged, foretold, further, judge
from seatsim.identification.posing import origin_of, posed
from seatsim.identification.predict import Bench, Drive, predicted
from seatsim.identification.problem import Problem
from seatsim.identification.search import Tell, best, silent
from seatsim.identification.split import Request, split
from seatsim.recordings.bench_tables import BenchRecord, load_bench, unused_columns
from seatsim.schema.errors import RunError
from seatsim.schema.registry import find, specification_of

EVERYTHING = Request()


class Identification(NamedTuple):
    """The model found: its bench, the agreement on every record, and what the data say of its parameters.

    origin: displacement in m that counts as x = 0. bic: Bayesian information criterion, with the effective number of
    samples. seconds: duration of the identification; ns_per_step: of a step of the simulation. warm, commanded: whether
    the influence of temperature, and the rates of the coil, were fitted. coverage: ranges of the fitted data.
    """

    model: str
    bench: Bench
    origin: float
    judged: list[Judged]
    information: Information
    bic: float
    seconds: float
    ns_per_step: float
    warm: bool
    commanded: bool
    coverage: dict[str, Any]
    notes: list[str]

    def mean(self, part: str) -> Figures | None:
        """Return the mean figures over the records of a part (train, test, predicted), None where it has none."""
        each = [judged.figures for judged in self.judged if judged.part == part]
        return averaged(each) if each else None


def identify(data: str | Path, model: str, request: Request = EVERYTHING, progress: Tell = silent) -> Identification:
    """Fit a damper model to the bench records of a file or folder.

    Minimised is the mean over records of mean (y - s)^2 / std(y)^2, with the measured force y and the simulated one s:
    a global search on short stretches, then least squares on all training records. tell: called with what is being
    done.

    Raises:
        InputError: the data, the model or the request is not as it must be.
        RunError: no parameters were found with which the model's state stays finite.
    """
    return identify_records(load_bench(data), model, request, progress)


def identify_records(
    records: Sequence[BenchRecord], model: str, request: Request = EVERYTHING, progress: Tell = silent
) -> Identification:
    """Fit a damper model to bench records; see `identify`."""
    began = time.perf_counter()
    parts, cls = split(records, request), find("damper", model)
    origin = origin_of(parts.fitted)
    problem, short = posed(parts.fitted, cls, origin, request)
    try:
        vector = best(problem, short, request.seed, progress)
        progress("judging the parameters")
        known = information(problem, vector)
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        raise RunError(f"{model}: the fit failed: {error}; hold a parameter by --fix") from error
    bench = problem.bench(vector)
    judged = judge(bench, parts, origin)
    away = [each.record.name for each in judged if each.part == "train" and not each.complete]
    if away:
        raise RunError(f"{model}: no parameters were found with which its state stays finite on {', '.join(away)}")
    tests = [each.record for each in judged if each.part == "test"]
    notes = [*_notes(problem, vector, known), *remarks(specification_of(cls), parts.fitted, tests, origin)]
    notes += [*_of_predictions(judged), *unused_columns(records)]
    return Identification(
        model=model,
        bench=bench,
        origin=origin,
        judged=judged,
        information=known,
        bic=known.bic(problem.cost(vector)),
        seconds=time.perf_counter() - began,
        ns_per_step=_speed(bench, problem.drives),
        warm=problem.reference is not None,
        commanded=problem.coil,
        coverage=coverage(parts.fitted),
        notes=notes,
    )


def predict(
    found: Identification, data: str | Path, moving_average: float = 0.0, centred: bool = False
) -> Identification:
    """Return an identification with its predictions of the records of a file or folder, which took no part in the fit.

    moving_average: seconds over which their owner averaged motion and force; centred: the mean of each force was
    removed.

    Raises:
        InputError: the data or the moving average are not as they must be.
    """
    return predict_records(found, further([data], moving_average, centred))


def predict_records(found: Identification, more: Further) -> Identification:
    """Return an identification with its predictions of further records; see `predict`."""
    judged = foretold(found.bench, found.origin, more)
    return found._replace(judged=[*found.judged, *judged], notes=[*found.notes, *_of_predictions(judged)])


def _notes(problem: Problem, vector: Any, known: Information) -> Iterator[str]:
    """Yield what is to be known of the parameters."""
    unknown = [estimate.name for estimate in known.estimates if not estimate.identified]
    if unknown:
        yield f"the data do not identify {', '.join(unknown)}"
    ends = problem.at_ends(vector)
    if ends:
        yield f"at the end of its range: {', '.join(ends)}"


def _of_predictions(judged: Sequence[Judged]) -> Iterator[str]:
    """Yield what is to be known of predictions."""
    away = [f"{each.record.name} ({each.part})" for each in judged if not each.complete]
    if away:
        yield f"the state runs away on {', '.join(away)}: the force counts as 0 N from there"


def _speed(bench: Bench, drives: Sequence[Drive]) -> float:
    """Return the nanoseconds of a step, the least of three runs."""
    times = []
    for _ in range(3):
        began = time.perf_counter()
        for each in drives:
            predicted(bench, each)
        times.append(time.perf_counter() - began)
    return 1e9 * min(times) / sum(len(each.force) for each in drives)
