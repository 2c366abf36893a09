"""Identifications of several models on the same records, the best prediction first."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from seatsim.dampers.base import find_confidence
from seatsim.identification.damper_record import find_model, numeric_fields
from seatsim.identification.identify import Identification, identify
from seatsim.identification.search import Progress
from seatsim.identification.settings import IdentificationSettings, split_records
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.schema.errors import InputError, SeatsimError, nearest
from seatsim.schema.registry import names

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
    return _rank_entries([_benchmark_model(records, model, settings, progress, keep) for model in models])


def _benchmark_model(
    records: Sequence[BenchRecord],
    model: str,
    settings: IdentificationSettings,
    progress: Progress,
    keep: Callable[[Identification], object],
) -> BenchmarkEntry:
    """Identify one model, hand the result on and return its entry."""
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
