"""Several identifications: of models on the same records, the best prediction first, and of specimens of a damper."""

import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.compilation.cached import digest
from seatsim.dampers.base import find_confidence
from seatsim.identification.assessment import PredictionData
from seatsim.identification.damper_record import find_model, numeric_fields
from seatsim.identification.identify import Identification, identify_records, predict_records
from seatsim.identification.search import Progress
from seatsim.identification.settings import IdentificationSettings, split_records
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.schema.content import Unwritten
from seatsim.schema.errors import InputError, SeatsimError, nearest
from seatsim.schema.files import write_json
from seatsim.schema.guarded import expect, read_json
from seatsim.schema.registry import names
from seatsim.schema.yaml_source import Source

_ALL = "all"
"""Stands for every registered model."""


class BenchmarkEntry(NamedTuple):
    """A line of the benchmark: model, mean fit on training and held-out records, free parameters, cost of a step.

    bic: Bayesian information criterion; seconds: of the fit; failed: why there are no figures; confidence: a word of
    `seatsim.dampers.base.CONFIDENCE`. Without held-out records `test_fit_percent` is NaN.
    """

    model: str
    train_fit_percent: float
    test_fit_percent: float
    parameters: int
    ns_per_step: float
    bic: float
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
    data: PredictionData,
    folder: Path,
    progress: Progress,
    keep: Callable[[Identification], object],
) -> list[BenchmarkEntry]:
    """Identify several models and return their entries, the best first.

    models: their names, or `all` for every registered one. data: records that every model predicts besides. folder:
    what stands in it of the same data, settings and models is not done again. keep: called with every new
    identification, before its entry is written. A model that fails has an entry that says why.

    Raises:
        InputError: the settings do not fit the records, or name a parameter that no model has.
    """
    models = names("damper") if _ALL in models else models
    split_records(records, settings)  # what cannot be held out is refused before the first fit
    _check_fixed(settings.fix, models)
    entries = []
    for model, key in zip(models, _entry_keys(models, records, settings, data), strict=True):
        path = folder / "league" / f"{model.rpartition(':')[2]}-{key}.json"
        if path.exists():
            entries.append(_read_entry(path))
        else:
            entries.append(_benchmark_model(records, model, settings, data, progress, keep))
            write_json(path, entries[-1])
    return rank_entries(entries)


def _benchmark_model(
    records: Sequence[BenchRecord],
    model: str,
    settings: IdentificationSettings,
    data: PredictionData,
    progress: Progress,
    keep: Callable[[Identification], object],
) -> BenchmarkEntry:
    """Identify one model, hand the result on and return its entry."""
    known = numeric_fields(find_model(model))
    own = settings._replace(fix={name: value for name, value in settings.fix.items() if name in known})
    try:
        found = identify_records(records, model, own, lambda text: progress(f"{model}: {text}"))
    except SeatsimError as error:
        nothing = (math.nan, math.nan, 0, math.nan, math.nan, math.nan)
        return BenchmarkEntry(model, *nothing, str(error), find_confidence(find_model(model)))
    keep(predict_records(found, data))
    train, test = (mean.fit_percent if mean else math.nan for mean in (found.train, found.test))
    figures = len(found.information.estimates), found.ns_per_step, found.bic, found.seconds
    return BenchmarkEntry(found.model, train, test, *figures, confidence=found.confidence)


def rank_entries(entries: Sequence[BenchmarkEntry]) -> list[BenchmarkEntry]:
    """Return entries, the best fit on held-out records first (on training ones where none is held out)."""
    held_out = any(math.isfinite(entry.test_fit_percent) for entry in entries)

    def merit(entry: BenchmarkEntry) -> float:
        fit = entry.test_fit_percent if held_out else entry.train_fit_percent
        return fit if math.isfinite(fit) else -math.inf

    return sorted(entries, key=merit, reverse=True)


def _read_entry(path: Path) -> BenchmarkEntry:
    """Return an entry from its file, where a figure that does not exist is null."""
    with expect(path, "entry of a league; remove it, and its model is identified again"):
        kept: Mapping[str, object] = read_json(path, "entry of a league")
        values = (kept[name] for name in BenchmarkEntry._fields)
        return BenchmarkEntry._make(math.nan if value is None else value for value in values)


def _check_fixed(fix: Mapping[str, float], models: Sequence[str]) -> None:
    """Refuse a fixed parameter that no model has; those that have it not leave it out."""
    known = sorted({name for model in models for name in numeric_fields(find_model(model))})
    for name in fix:
        if name not in known:
            problem = f"--fix {name}: no model has this number{nearest(name, known)}; see seatsim describe MODEL"
            raise InputError(problem)


def _entry_keys(
    models: Sequence[str], records: Sequence[BenchRecord], settings: IdentificationSettings, data: PredictionData
) -> list[str]:
    """Return what tells the entries of these data, settings and models, as they are now, from others."""
    state = sha256(repr((settings, data.moving_average, data.centred, _hash_code(__name__))).encode())
    for record in (*records, *data.records):
        state.update(record.name.encode())
        for part in (record.force, record.displacement, record.velocity, record.current, record.temperature):
            state.update(b"" if part is None else part.tobytes())
    keys = []
    for model in models:
        own = state.copy()
        own.update(_hash_code(find_model(model).__module__).encode())
        keys.append(own.hexdigest()[:12])
    return keys


@cache
def _hash_code(module: str) -> str:
    """Return a hash of a module and of all that it reaches."""
    return digest([sys.modules[module]])


class Specimens(NamedTuple):
    """The content of `specimens.yaml`: the values of each specimen by keys of a scenario, which a sweep takes together.

    Keys are those in which the specimens differ, such as `damper.parameters.c_a`; `standard_deviation` is that of a
    sample. damper: the damper with the mean values and its coil, as a scenario has them.
    """

    model: str
    specimens: dict[str, dict[str, float]]
    mean: dict[str, float]
    standard_deviation: dict[str, float]
    damper: Unwritten[dict[str, object]]


def gather_specimens(found: Mapping[str, Identification]) -> Specimens:
    """Return what the identifications of two specimens or more, by their names, have in common and how they differ.

    Raises:
        InputError: the influence of temperature was fitted to some of them only, or all are the same.
    """
    contents = {name: {**each.to_scenario()} for name, each in found.items()}
    for content in contents.values():
        del content["bench"]
    values = {name: dict(_list_numbers(content)) for name, content in contents.items()}
    first, *others = values
    for name in others:
        if set(values[name]) != set(values[first]):
            problem = "the temperature matters in the records of only one of them: add --ignore-temperature"
            raise InputError(f"{first} and {name} have other parameters; {problem}")
    keys = [key for key in values[first] if len({each[key] for each in values.values()}) > 1]
    if not keys:
        raise InputError(f"{first} and {', '.join(others)} do not differ; name folders of different specimens")
    table = np.array([[each[key] for key in keys] for each in values.values()])
    mean, deviation = (dict(zip(keys, map(float, y), strict=True)) for y in (table.mean(0), table.std(0, ddof=1)))
    middle = Source.of(contents[first])
    for key, value in mean.items():
        middle.put(key, value, first)
    each = {name: {key: own[key] for key in keys} for name, own in values.items()}
    return Specimens(found[first].model, each, mean, deviation, middle.data)


def _list_numbers(content: object, key: str = "") -> Iterator[tuple[str, float]]:
    """Yield the numbers of nested mappings and lists by their dotted keys."""
    if isinstance(content, Mapping | list):
        for name, value in content.items() if isinstance(content, Mapping) else enumerate(content):
            yield from _list_numbers(value, f"{key}.{name}" if key else str(name))
    elif isinstance(content, int | float):
        yield key, float(content)
