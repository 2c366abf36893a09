"""The league: every damper model identified on the same records, the best prediction of held-out ones first."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Sequence
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

from seatsim.bench_tables import BenchRecord
from seatsim.errors import SeatsimError
from seatsim.files import write_json
from seatsim.identification.identify import Identification, Request, identify_records
from seatsim.registry import names

Tell = Callable[[str], None]


class Place(NamedTuple):
    """A line of the league: model, mean fit on training and held-out records, free parameters, cost of a step."""

    model: str
    train_fit_percent: float
    test_fit_percent: float
    parameters: int
    ns_per_step: float
    bic: float
    seconds: float
    failed: str = ""


def league(
    records: list[BenchRecord], request: Request, folder: Path, tell: Tell, keep: Callable[[Identification], object]
) -> list[Place]:
    """Identify every registered model; what stands in `folder` for the same records and request is not done again.

    keep: called with every new identification, before its place is written.
    """
    places = []
    for model, path in _files(records, request, folder):
        if path.exists():
            places.append(Place(**json.loads(path.read_text(encoding="utf-8"))))
            continue
        try:
            found = identify_records(records, model, request, _named(tell, model))
        except SeatsimError as error:
            place = Place(model, math.nan, math.nan, 0, math.nan, math.nan, math.nan, str(error))
        else:
            keep(found)
            place = place_of(found)
        write_json(path, place)
        places.append(place)
    return ranked(places)


def _named(tell: Tell, model: str) -> Tell:
    return lambda text: tell(f"{model}: {text}")


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

    def merit(place: Place) -> float:
        fits = (place.test_fit_percent, place.train_fit_percent)
        return next((fit for fit in fits if fit is not None and math.isfinite(fit)), -math.inf)

    return sorted(places, key=merit, reverse=True)


def _files(records: Sequence[BenchRecord], request: Request, folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield every model and the file that keeps its place, named after the data and the request."""
    state = sha256(repr((request, [record.name for record in records])).encode())
    for record in records:
        state.update(record.force.tobytes() + record.displacement.tobytes())
    key = state.hexdigest()[:12]
    for model in names("damper"):
        yield model, folder / "league" / f"{model}-{key}.json"
