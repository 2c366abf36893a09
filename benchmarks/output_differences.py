"""How the outputs of two versions differ: diagnoses to 1e-9, histories and summaries bit for bit."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple, TypeAlias

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from version_outputs import FAILURE

Json: TypeAlias = "bool | int | float | str | list[Json] | dict[str, Json] | None"
Leaves: TypeAlias = Mapping[str, "bool | int | float | str | None"]
"""The values of a JSON file, each by its dotted path."""

TOLERANCE = 1e-9
"""Relative difference of a figure of `diagnosis.json` that counts as none: the last digits depend on the processor."""
REQUIRED = ("verdict", "selected", "where", "gap")
"""Keys of `diagnosis.json` that must agree; others, such as standard deviations of parameters, are told only."""


class Difference(NamedTuple):
    """A value that differs: dotted path, both values in words, relative difference (infinite unless both are numbers).

    `required` is whether versions must agree in it.
    """

    path: str
    old: str
    new: str
    relative: float
    required: bool = True


def differences(old: Path, new: Path) -> list[Difference]:
    """Return how two folders of outputs differ, the largest relative difference first."""
    found = [*_texts(old / FAILURE, new / FAILURE), *_diagnoses(old, new), *_summaries(old, new), *_histories(old, new)]
    return sorted(found, key=lambda difference: -difference.relative)


def relative_difference(old: object, new: object) -> float:
    """Return |old - new| / max(|old|, |new|), 0 for equal values, infinity unless both are finite numbers.

    NaN equals NaN; a truth value is no number, so that `true` differs from 1.
    """
    if old == new and type(old) is type(new):
        return 0.0
    a, b = _number(old), _number(new)
    if a is None or b is None:
        return math.inf
    if a == b or (math.isnan(a) and math.isnan(b)):
        return 0.0
    return abs(a - b) / max(abs(a), abs(b)) if math.isfinite(a - b) else math.inf


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None


def leaves(value: Json, path: str = "") -> Iterator[tuple[str, bool | int | float | str | None]]:
    """Yield the values of a JSON file by dotted path; an empty list or mapping is a value of its own.

    Causes go by their effect: their order among equal probabilities says nothing.
    """
    if isinstance(value, dict) and value:
        for key, item in value.items():
            yield from leaves(item, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and value:
        for index, item in enumerate(value):
            name = item["effect"] if path == "causes" and isinstance(item, dict) else index
            yield from leaves(item, f"{path}[{name}]")
    else:
        yield path, str(value) if isinstance(value, dict | list) else value


def _diagnoses(old: Path, new: Path) -> Iterator[Difference]:
    """Yield the differences of `diagnosis.json`."""
    for difference in _documents(old / "diagnosis.json", new / "diagnosis.json", TOLERANCE):
        key = difference.path.replace("[", ".").split(".")[0]
        yield difference._replace(required=key in REQUIRED or difference.path == "diagnosis.json")


def _summaries(old: Path, new: Path) -> Iterator[Difference]:
    """Yield the differences of `summary.json`, whose figures must agree in every bit."""
    yield from _documents(old / "summary.json", new / "summary.json", 0.0)


def _documents(old: Path, new: Path, tolerance: float) -> Iterator[Difference]:
    """Yield the differences of two JSON files beyond a relative tolerance."""
    if not (old.exists() and new.exists()):
        yield from _presence(old, new)
        return
    before, after = (dict(leaves(json.loads(path.read_text()))) for path in (old, new))
    for path in before | after:
        relative = relative_difference(before[path], after[path]) if path in before and path in after else math.inf
        if relative > tolerance:
            yield Difference(path, _value(before, path), _value(after, path), relative)


def _histories(old: Path, new: Path) -> Iterator[Difference]:
    """Yield the columns of `history.parquet` that differ in a value; the bytes of the files may differ."""
    paths = old / "history.parquet", new / "history.parquet"
    if not all(path.exists() for path in paths):
        yield from _presence(*paths)
        return
    before, after = (pq.read_table(path) for path in paths)
    if before.schema.names != after.schema.names or before.num_rows != after.num_rows:
        yield Difference("history.parquet", _shape(before), _shape(after), math.inf)
        return
    for name in before.schema.names:
        yield from _columns(name, before[name], after[name])


def _columns(name: str, old: pa.ChunkedArray, new: pa.ChunkedArray) -> Iterator[Difference]:
    """Yield at most one difference: that of the row where two columns differ most."""
    if old.type != new.type:
        yield Difference(f"history.{name}", str(old.type), str(new.type), math.inf)
        return
    if _equal(old, new):
        return
    rows = zip(old.to_pylist(), new.to_pylist(), strict=True)
    largest, row = max((relative_difference(a, b), k) for k, (a, b) in enumerate(rows))
    yield Difference(f"history.{name}[{row}]", str(old[row]), str(new[row]), largest)


def _shape(table: pa.Table) -> str:
    return f"{table.num_rows} rows of {', '.join(table.schema.names)}"


def _equal(old: pa.ChunkedArray, new: pa.ChunkedArray) -> bool:
    """Whether two columns of one type have the same values; Arrow's own comparison takes NaN for unequal to NaN."""
    if not pa.types.is_floating(old.type):
        return bool(old.equals(new))
    return np.array_equal(old.to_numpy(), new.to_numpy(), equal_nan=True)


def _texts(old: Path, new: Path) -> Iterator[Difference]:
    """Yield the difference of two texts, each of which may be missing; the same failure on both sides is none."""
    before, after = (path.read_text() if path.exists() else "no failure" for path in (old, new))
    if before != after:
        yield Difference(old.name, before, after, math.inf)


def _presence(old: Path, new: Path) -> Iterator[Difference]:
    """Yield a difference where one of two files is missing."""
    if old.exists() != new.exists():
        before, after = ("written" if path.exists() else "missing" for path in (old, new))
        yield Difference(old.name, before, after, math.inf)


def _value(values: Leaves, path: str) -> str:
    return repr(values[path]) if path in values else "missing"
