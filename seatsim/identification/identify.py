"""Identification of a damper model: split, search, refine, assess on what took no part in the fit.

Identifications of several models on the same records are ranked, the best prediction first.
"""

import math
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.dampers.base import DAMPERS, find_confidence
from seatsim.identification import assessment
from seatsim.identification.damper_record import find_model, numeric_fields
from seatsim.identification.problem import BenchModel, IdentificationProblem, find_origin, predict_force, state_problem
from seatsim.identification.search import Progress, ignore_progress, search_parameters
from seatsim.identification.settings import IdentificationSettings, split_records
from seatsim.recordings.bench_tables import BenchRecord, load_bench, note_unused
from seatsim.schema.arrays import Array
from seatsim.schema.content import Joined, Unwritten, plain, show_record, written
from seatsim.schema.errors import InputError, RunError, SeatsimError, nearest
from seatsim.schema.registry import names

_DEFAULTS = IdentificationSettings()
_NO_BETTER_THAN_MEAN = 1.01
"""Mean square error over the variance of the force from which on a fit is none: the mean of each record leaves 1."""
_TIMED_RUNS = 3
"""Runs of which the fastest counts: others only add what else the processor did."""


class Identification(NamedTuple):
    """The model found: its bench, the agreement on every record, and what the data say of its parameters.

    It is the content of `fit.json`.

    origin: displacement in m that counts as x = 0. seconds: duration of the identification; ns_per_step: of a step of
    the simulation. warm, commanded: whether the influence of temperature, and the rates of the coil, were fitted.
    """

    model: str
    bench: Unwritten[BenchModel]
    origin: Unwritten[float]
    assessments: Unwritten[list[assessment.Assessment]]
    information: Joined[assessment.Information]
    seconds: float
    ns_per_step: float
    warm: Unwritten[bool]
    commanded: Unwritten[bool]
    notes: list[str]
    confidence: str
    """How far the model is proven, a word of `seatsim.dampers.base.CONFIDENCE`."""
    train: assessment.Agreement | None
    """Mean agreement over the fitted records."""
    test: assessment.Agreement | None
    """Mean agreement over the records that were held out, None where none were."""

    def mean(self, part: str) -> assessment.Agreement | None:
        """Return the mean agreement over the records of a part (train, test), None where it has none."""
        return self.train if part == "train" else self.test

    @property
    def assessed(self) -> assessment.Agreement | None:
        """Mean agreement on the records that were held out, on the fitted ones where none were."""
        return self.test or self.train

    @property
    @written()
    def records(self) -> dict[str, assessment.Assessment]:
        """The agreement on each record by its name, with its part, or a number, where names alone are ambiguous."""
        names = Counter(each.record.name for each in self.assessments)
        found: dict[str, assessment.Assessment] = {}
        for each in self.assessments:
            name = each.record.name if names[each.record.name] == 1 else f"{each.record.name} ({each.part})"
            again = sum(other.record.name == each.record.name and other.part == each.part for other in found.values())
            found[f"{name} {again + 1}" if again else name] = each
        return found

    def to_scenario(self) -> dict[str, object]:
        """Return the damper and its coil as a scenario has them, with what else the bench needs under `bench`.

        That is the displacement in m that counts as zero, and the growth of the offset in N/K.
        """
        bench = self.bench
        damper: dict[str, object] = {"model": self.model, "parameters": plain(bench.damper)}
        if self.warm:
            damper["temperature_factors"] = plain(bench.factors)
        end = max(float(each.record.current.max()) for each in self.assessments)
        return {
            "damper": damper,
            "actuator": {"rate": float(bench.rise), "rate_fall": float(bench.fall), "max_current": end or 1.0},
            "bench": {"displacement_origin": self.origin, "offset_per_kelvin": float(bench.offset_per_kelvin)},
        }

    def __repr__(self) -> str:
        """Name the model and its parameters."""
        values = ", ".join(f"{each.name} {each.value:.4g} {each.unit}" for each in self.information.estimates)
        return f"<Identification of {self.model}: {values}>"

    def _repr_html_(self) -> str:
        return show_record(self, "model", "train", "test", "parameters", "notes")


def identify(
    data: str | Path | Sequence[BenchRecord],
    model: str,
    settings: IdentificationSettings = _DEFAULTS,
    progress: Progress = ignore_progress,
) -> Identification:
    """Fit a damper model to bench records, or to those of a file or folder.

    Minimised is the mean over records of mean (y - s)^2 / std(y)^2, with the measured force y and the simulated one s:
    a global search on short stretches, then least squares on all training records. progress: called with what is being
    done.

    Raises:
        InputError: the data, the model or the settings are not as they must be.
        RunError: no parameters were found with which the model's state stays finite.
    """
    began = time.perf_counter()
    records = load_bench(data) if isinstance(data, str | Path) else data
    parts, cls = split_records(records, settings), find_model(model)
    origin = find_origin(parts.fitted)
    problem, short = state_problem(parts.fitted, cls, origin, settings)
    vector, known = _solve(model, problem, short, settings.seed, progress)
    bench = problem.to_bench(vector)
    assessments = assessment.assess_fit(bench, parts, origin)
    diverged = [each.record.name for each in assessments if each.part == "train" and not each.complete]
    if diverged:
        raise RunError(f"{model}: no parameters were found with which its state stays finite on {', '.join(diverged)}")
    cost = problem.cost(vector)
    if cost > _NO_BETTER_THAN_MEAN:
        left = f"the best parameters found leave {100.0 * cost**0.5:.0f} % of the force's standard deviation"
        raise RunError(f"{model}: {left}, so that its mean alone fits better; choose another model")
    tests = [each.record for each in assessments if each.part == "test"]
    notes = [
        *_note_parameters(problem, vector, known),
        *assessment.note_limits(DAMPERS.specification_of(cls), parts.fitted, tests, origin),
    ]
    train, test = ([one.agreement for one in assessments if one.part == part] for part in ("train", "test"))
    return Identification(
        model=model, bench=bench, origin=origin, assessments=assessments, information=known,
        seconds=time.perf_counter() - began, ns_per_step=_time_step(bench, problem),
        warm=problem.reference is not None, commanded=any(record.commanded for record in parts.fitted),
        notes=[*notes, *_note_divergence(assessments), *note_unused(n for each in records for n in each.unused)],
        confidence=find_confidence(cls), train=assessment.mean_agreement(train), test=assessment.mean_agreement(test),
    )  # fmt: skip


def _solve(
    model: str, problem: IdentificationProblem, short: IdentificationProblem, seed: int, progress: Progress
) -> tuple[Array, assessment.Information]:
    """Return the best vector, shape (P,), and what the data say of it.

    Raises:
        RunError: the numbers left all bounds, or no step exists.
    """
    try:
        # Threads suffice: the compiled simulation does not hold Python's lock.
        with ThreadPoolExecutor() as executor:
            vector = search_parameters(problem, short, seed, executor, progress)
            progress("assessing the parameters")
            return vector, assessment.compute_information(problem, vector, executor)
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        raise RunError(f"{model}: the fit failed: {error}; hold a parameter by --fix") from error


def _note_parameters(problem: IdentificationProblem, vector: Array, known: assessment.Information) -> Iterator[str]:
    """Yield what is to be known of the parameters."""
    if known.not_identified:
        yield f"the data do not identify {', '.join(known.not_identified)}"
    ends = problem.labels_at_bounds(vector)
    if ends:
        yield f"at the end of its range: {', '.join(ends)}"


def _note_divergence(assessments: Sequence[assessment.Assessment]) -> Iterator[str]:
    """Yield on which records the state ran away."""
    diverged = [f"{each.record.name} ({each.part})" for each in assessments if not each.complete]
    if diverged:
        yield f"the state runs away on {', '.join(diverged)}: the force counts as 0 N from there"


def _time_step(bench: BenchModel, problem: IdentificationProblem) -> float:
    """Return the nanoseconds of a step of the simulation."""
    times = []
    for _ in range(_TIMED_RUNS):
        began = time.perf_counter()
        for each in problem.inputs:
            predict_force(bench, each)
        times.append(time.perf_counter() - began)
    return 1e9 * min(times) / sum(len(each.force) for each in problem.inputs)


_ALL = "all"
"""Stands for every registered model."""


class BenchmarkEntry(NamedTuple):
    """A line of the benchmark: model, mean fit on training and held-out records, free parameters, cost of a step.

    seconds: of the fit; failed: why there are no figures; confidence: a word of `seatsim.dampers.base.CONFIDENCE`.
    Without held-out records `test_fit_percent` is NaN.
    """

    model: str
    train_fit_percent: float
    test_fit_percent: float
    parameters: int
    ns_per_step: float
    seconds: float
    failed: str = ""
    confidence: str = ""


class League(NamedTuple):
    """Several models, the best first."""

    league: list[BenchmarkEntry]


def benchmark_models(
    records: Sequence[BenchRecord],
    models: Sequence[str],
    settings: IdentificationSettings,
    progress: Progress,
    keep: Callable[[Identification], object],
) -> list[BenchmarkEntry]:
    """Identify several models and return their entries, the best first.

    models: their names, or `all` for every registered one. keep: called with every identification. A model that fails
    has an entry that says why.

    Raises:
        InputError: the settings do not fit the records, or name a parameter that no model has.
    """
    models = names("damper") if _ALL in models else models
    split_records(records, settings)  # what cannot be held out is refused before the first fit
    _check_fixed(settings.fix, models)

    def enter(model: str) -> BenchmarkEntry:
        cls = find_model(model)
        known = numeric_fields(cls)
        own = settings._replace(fix={name: value for name, value in settings.fix.items() if name in known})
        try:
            found = identify(records, model, own, lambda text: progress(f"{model}: {text}"))
        except SeatsimError as error:
            return BenchmarkEntry(model, math.nan, math.nan, 0, math.nan, math.nan, str(error), find_confidence(cls))
        keep(found)
        train, test = (mean.fit_percent if mean else math.nan for mean in (found.train, found.test))
        figures = len(found.information.estimates), found.ns_per_step, found.seconds
        return BenchmarkEntry(found.model, train, test, *figures, confidence=found.confidence)

    return _rank_entries([enter(model) for model in models])


def _rank_entries(entries: Sequence[BenchmarkEntry]) -> list[BenchmarkEntry]:
    """Return entries, the best fit on held-out records first (on training ones where none is held out)."""
    held_out = any(math.isfinite(entry.test_fit_percent) for entry in entries)

    def merit(entry: BenchmarkEntry) -> float:
        fit = entry.test_fit_percent if held_out else entry.train_fit_percent
        return fit if math.isfinite(fit) else -math.inf

    return sorted(entries, key=merit, reverse=True)


def _check_fixed(fix: Mapping[str, float], models: Sequence[str]) -> None:
    """Refuse a fixed parameter that no model has; those that have it not leave it out."""
    known = sorted({name for model in models for name in numeric_fields(find_model(model))})
    for name in fix:
        if name not in known:
            problem = f"--fix {name}: no model has this number{nearest(name, known)}; see seatsim describe MODEL"
            raise InputError(problem)
