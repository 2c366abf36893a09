"""The league: every damper model identified on the same records, the best prediction of held-out ones first."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

from seatsim.compilation.cached import digest
from seatsim.identification.coordinates import numbers_of
from seatsim.identification.identify import Identification, identify_records, predict_records
from seatsim.identification.judging import Further
from seatsim.identification.search import Tell
from seatsim.identification.split import Request, split
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.schema.errors import InputError, SeatsimError, nearest
from seatsim.schema.files import write_json
from seatsim.schema.registry import find, names


class Place(NamedTuple):
    """A line of the league: model, mean fit on training and held-out records, free parameters, cost of a step.

    bic: Bayesian information criterion; seconds: of the fit; failed: why there are no figures. Without held-out records
    `test_fit_percent` is NaN.
    """

    model: str
    train_fit_percent: float
    test_fit_percent: float
    parameters: int
    ns_per_step: float
    bic: float
    seconds: float
    failed: str = ""


def league(
    records: Sequence[BenchRecord],
    request: Request,
    more: Further,
    folder: Path,
    progress: Tell,
    keep: Callable[[Identification], object],
) -> list[Place]:
    """Identify every registered model; what stands in `folder` of the same data, request and models is not done again.

    more: records that every model predicts beside; keep: called with every new identification, before its place is
    written. A model that fails has a place that says why.

    Raises:
        InputError: the request does not fit the records, or names a parameter that no model has.
    """
    split(records, request)
    models = names("damper")
    _check_fixed(request.fix, models)
    places = []
    for model, key in zip(models, _keys(models, records, request, more), strict=True):
        path = folder / "league" / f"{model}-{key}.json"
        if path.exists():
            places.append(_read(path))
            continue
        own = request._replace(fix=_own(request.fix, find("damper", model)))
        try:
            found = identify_records(records, model, own, _of(model, progress))
        except SeatsimError as error:
            place = Place(model, math.nan, math.nan, 0, math.nan, math.nan, math.nan, str(error))
        else:
            keep(predict_records(found, more))
            place = place_of(found)
        write_json(path, place)
        places.append(place)
    return ranked(places)


def place_of(found: Identification) -> Place:
    """Return the line of an identification."""
    train, test = found.mean("train"), found.mean("test")
    return Place(
        found.model,
        train.fit_percent if train else math.nan,
        test.fit_percent if test else math.nan,
        len(found.information.estimates),
        found.ns_per_step,
        found.bic,
        found.seconds,
    )


def ranked(places: Sequence[Place]) -> list[Place]:
    """Return places, the best fit on held-out records first (on training ones where none is held out)."""
    held_out = any(math.isfinite(place.test_fit_percent) for place in places)

    def merit(place: Place) -> float:
        fit = place.test_fit_percent if held_out else place.train_fit_percent
        return fit if math.isfinite(fit) else -math.inf

    return sorted(places, key=merit, reverse=True)


def _of(model: str, progress: Tell) -> Tell:
    return lambda text: progress(f"{model}: {text}")


def _read(path: Path) -> Place:
    kept = json.loads(path.read_text(encoding="utf-8"))
    values: dict[str, Any] = {name: math.nan if value is None else value for name, value in kept.items()}
    return Place(**values)


def _own(fix: Mapping[str, float], cls: type) -> dict[str, float]:
    """Return what is fixed of a class's own numbers."""
    known = numbers_of(cls)
    return {name: value for name, value in fix.items() if name in known}


def _check_fixed(fix: Mapping[str, float], models: Sequence[str]) -> None:
    known = sorted({name for model in models for name in numbers_of(find("damper", model))})
    for name in fix:
        if name not in known:
            raise InputError(
                f"--fix {name}: no model has this number{nearest(name, known)}; see seatsim describe MODEL"
            )


def _keys(models: Sequence[str], records: Sequence[BenchRecord], request: Request, more: Further) -> list[str]:
    """Return what tells the places of these data, of this request and of these models, as they are now, from others."""
    state = sha256(repr((request, more.moving_average, more.centred, _code(__name__))).encode())
    for record in (*records, *more.records):
        state.update(record.name.encode())
        for part in (record.force, record.displacement, record.velocity, record.current, record.temperature):
            state.update(b"" if part is None else part.tobytes())
    keys = []
    for model in models:
        own = state.copy()
        own.update(_code(find("damper", model).__module__).encode())
        keys.append(own.hexdigest()[:12])
    return keys


@cache
def _code(module: str) -> str:
    """Return a hash of a module and of all that it reaches."""
    return digest([sys.modules[module]])
