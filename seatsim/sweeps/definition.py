"""What a sweep file states: the scenario, the varied keys, the design that combines them, and limits of metrics.

scenario: quickstart.yaml
seed: 1
design: lhs
runs: 1000
vary: {plant.driver_mass: {normal: [80, 12], low: 50, high: 120}}
limits: {driver_acceleration_weighted: 0.5}

The values that one key takes are a list, a range, or a distribution that is drawn from.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from seatsim.metrics.table import METRICS
from seatsim.scenario.loading import find_file
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, permit, placed, read_each
from seatsim.schema.fields import read_packaged
from seatsim.schema.guarded import is_there
from seatsim.schema.json_schema import Schema, head_schema, mapping_schema
from seatsim.schema.tables import read_table
from seatsim.schema.validation import check_keys, is_finite_number, mapping, read_number, read_whole
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath, YamlError, parse_value

DISTRIBUTIONS = {
    "uniform": "[low, high]",
    "normal": "[mean, standard deviation]",
    "lognormal": "[mean, standard deviation of the log]",
    "choice": "{value: probability, ...}",
}
"""Names of distributions, and what each takes."""
_TAKEN = ", ".join(f"{name}: {takes}" for name, takes in DISTRIBUTIONS.items())
_FORMS = f"a list, {{from: A, to: B, steps: N}}, or a distribution: {_TAKEN}"
_MOST_STEPS = 1_000_000
"""Of a range; more would be a slip of the keyboard."""
_SLIGHTLY = 1e-9
"""By how much probabilities may miss the sum of 1, for the sake of rounding."""
_EDGE = 2.0**-53
"""Probability in either tail that no draw reaches: a quantile at 0 or 1 may be infinite."""


class Axis(NamedTuple):
    """A varied key: its values where these are listed, and in any case its quantile function.

    `values` are the stated ones in order, None of a distribution. `quantile` maps probabilities, shape (N,), to values;
    those of a list are equally likely.
    """

    key: str
    values: tuple[object, ...] | None
    quantile: Callable[[Array], list[object]]


def _read_axis(key: str, source: Source) -> Axis:
    """Return the values of a key, as they stand under `vary` in a sweep file.

    Raises:
        InputError: they are no list, range or distribution, or its numbers do not fit each other.
    """
    where: KeyPath = ("vary", key)
    stated = mapping(source.data["vary"], source, ("vary",))[key]
    if isinstance(stated, list):
        if not stated:
            raise source.error(where, "the list is empty; state at least one value")
        return _listed(key, stated)
    if not isinstance(stated, Mapping):
        raise source.error(where, f"{stated!r} is a single value; permitted: {_FORMS}")
    if {"from", "to", "steps"} & set(stated):
        return _listed(key, _read_range(stated, source, where))
    return Axis(key, None, _read_distribution(stated, source, where))


def _listed(key: str, values: Sequence[object]) -> Axis:
    return Axis(key, tuple(values), _choose(values, np.full(len(values), 1 / len(values))))


def _choose(values: Sequence[object], probabilities: Array) -> Callable[[Array], list[object]]:
    edges = np.cumsum(probabilities)[:-1]
    return lambda u: [values[index] for index in np.searchsorted(edges, u, side="right")]


def _read_range(stated: Mapping[str, object], source: Source, where: KeyPath) -> list[object]:
    check_keys(stated, ("from", "to", "steps"), source, where)
    for name in ("from", "to", "steps"):
        if not is_finite_number(stated.get(name)):
            problem = f"{stated.get(name)!r} is not a finite number; a range is {{from: A, to: B, steps: N}}"
            raise source.error((*where, name), problem)
    ends, steps = [stated["from"], stated["to"]], read_whole(stated["steps"], source, (*where, "steps"), 2, _MOST_STEPS)
    values = np.linspace(float(str(ends[0])), float(str(ends[1])), steps).tolist()
    whole = all(isinstance(end, int) for end in ends) and all(value.is_integer() for value in values)
    # Whole numbers stay what they are: keys such as `seed` take no others.
    return [int(value) for value in values] if whole else values


def _read_distribution(stated: Mapping[str, object], source: Source, where: KeyPath) -> Callable[[Array], list[object]]:
    check_keys(stated, (*DISTRIBUTIONS, "low", "high"), source, where)
    named = [name for name in DISTRIBUTIONS if name in stated]
    if len(named) != 1:
        raise source.error(where, f"states {' and '.join(named) or 'no values'}; permitted: {_FORMS}")
    kind = named[0]
    if kind in ("uniform", "choice") and {"low", "high"} & set(stated):
        raise source.error(where, f"low and high truncate normal and lognormal; {kind} takes {DISTRIBUTIONS[kind]}")
    if kind == "choice":
        return _read_choice(stated["choice"], source, (*where, kind))
    first, second = _read_pair(stated[kind], kind, source, (*where, kind))
    if kind == "uniform":
        return lambda u: (first + u * (second - first)).tolist()
    low, high = _read_truncation(stated, source, where)
    if kind == "normal":
        return lambda u: _truncated_normal(u, first, second, low, high).tolist()
    return lambda u: np.exp(_truncated_normal(u, first, second, _log(low), _log(high))).tolist()


def _read_pair(values: object, kind: str, source: Source, where: KeyPath) -> tuple[float, float]:
    if not (isinstance(values, list) and len(values) == 2 and all(map(is_finite_number, values))):
        raise source.error(where, f"{values!r} is not permitted; {kind} takes {DISTRIBUTIONS[kind]}")
    first, second = map(float, values)
    if kind == "uniform" and not first < second:
        raise source.error(where, f"{values!r} is not permitted; the second number must be greater than the first")
    if kind != "uniform" and not second > 0:
        raise source.error(where, f"{second:g} is not permitted; a standard deviation must be greater than 0")
    return first, second


def _read_truncation(stated: Mapping[str, object], source: Source, where: KeyPath) -> tuple[float, float]:
    stops = {"low": -math.inf, "high": math.inf}
    stops |= {name: read_number(stated[name], source, (*where, name)) for name in stops if name in stated}
    low, high = stops.values()
    if not low < high:
        raise source.error((*where, "high"), f"{high:g} is not permitted; it must be greater than low, {low:g}")
    return low, high


def _truncated_normal(u: Array, mean: float, deviation: float, low: float, high: float) -> Array:
    # scipy.stats takes as long to load as many runs take, and most sweeps and all commands do without.
    from scipy.stats import truncnorm

    ends, inside = ((low - mean) / deviation, (high - mean) / deviation), np.clip(u, _EDGE, 1 - _EDGE)
    drawn: Array = truncnorm.ppf(inside, *ends, loc=mean, scale=deviation)
    return drawn


def _read_choice(stated: object, source: Source, where: KeyPath) -> Callable[[Array], list[object]]:
    shares = mapping(stated, source, where)
    for value, share in shares.items():
        if not is_finite_number(share) or share < 0:
            raise source.error((*where, value), f"{share!r} is not permitted; a probability is at least 0")
    probabilities = np.array(list(shares.values()), dtype=float)
    if not shares or abs(probabilities.sum() - 1) > _SLIGHTLY:
        raise source.error(where, f"the probabilities sum to {probabilities.sum():g}; they must sum to 1")
    return _choose([parse_value(value) for value in shares], probabilities)


def _log(value: float) -> float:
    return math.log(value) if value > 0 else -math.inf


_SCHEMA = read_packaged(Path(__file__).with_name("schema.yaml"), dict[str, Any])
_DESIGNS: list[str] = _SCHEMA["properties"]["design"]["enum"]
MOST_RUNS = 10_000_000
"""Runs of a sweep: their numbers have this many digits, and more would be a slip of the keyboard."""


class _Table(NamedTuple):
    """A design that a CSV file states: values by key and row, and the file."""

    path: Path
    columns: Mapping[str, list[object]]


class SweepDefinition(NamedTuple):
    """A sweep file, read and checked as far as it goes without the scenario.

    `runs` is None where the design needs none; `source` is the file, `scenario` the content of the scenario.
    """

    source: Source
    scenario: Source
    seed: int
    design: str
    runs: int | None
    replicates: int
    axes: tuple[Axis, ...]
    table: _Table | None
    limits: Mapping[str, float]

    def place(self, key: str) -> str:
        """Return where the values of a varied key are stated."""
        return str(self.table.path) if self.table else self.source.nearest_place(("vary", key))


def read_definition(path: Path) -> SweepDefinition:
    """Return what a sweep file states.

    Raises:
        InputError: the file cannot be read, or a key is unknown, missing or has a value that is not permitted.
    """
    source = Source(path)
    if "scenario" not in source.data and {"plant", "damper"} & set(source.data):
        raise InputError(f"{path}: is a scenario; a sweep is a file that names one under scenario, and what varies")
    readers: Mapping[str, Callable[[], object]] = {
        "source": lambda: check_keys(source.data, _SCHEMA["properties"], source, ()),
        "scenario": lambda: _read_scenario(source),
        "seed": lambda: _read_whole(source, "seed", least=0) or 0,
        "design": lambda: _read_design(source),
        "runs": lambda: _read_whole(source, "runs", least=1),
        "replicates": lambda: _read_whole(source, "replicates", least=1) or 1,
        "axes": lambda: _read_axes(source),
        "table": lambda: _read_table(source),
        "limits": lambda: _read_limits(source),
    }
    return SweepDefinition(**read_each(readers) | {"source": source})


def _is_table(source: Source) -> bool:
    return source.data.get("design") == "table"


def _read_axes(source: Source) -> tuple[Axis, ...]:
    if _is_table(source):
        if "vary" in source.data:
            problem = "a design 'table' takes its keys from the columns of the file; leave 'vary' out"
            raise source.error(("vary",), problem)
        return ()
    stated = mapping(source.data.get("vary", {}), source, ("vary",))
    if not stated:
        raise source.error((), "key 'vary' is missing; it names the keys of the scenario that are varied")
    return tuple(read_each({key: partial(_read_axis, key, source) for key in stated}).values())


def is_sweep(data: Mapping[str, object]) -> bool:
    """Tell whether the content of a YAML file is a sweep and no scenario."""
    return "scenario" in data and bool({"vary", "table", "design"} & set(data))


def _read_design(source: Source) -> str:
    name = source.data.get("design", "cross")
    if name not in _DESIGNS:
        raise source.error(("design",), f"{name!r} is not permitted{permit(name, _DESIGNS)}")
    return str(name)


def _read_scenario(source: Source) -> Source:
    stated = source.data.get("scenario")
    if isinstance(stated, Mapping):
        return source.below("scenario")
    if not isinstance(stated, str):
        raise source.error(("scenario",), "state a scenario file, the name of an example, or a whole scenario")
    beside = source.path.parent / stated
    try:
        return Source(beside if is_there(beside) else find_file(Path(stated)))
    except InputError as error:
        raise source.error(("scenario",), str(error)) from error


def _read_whole(source: Source, key: str, least: int) -> int | None:
    return read_whole(source.data[key], source, (key,), least, MOST_RUNS) if key in source.data else None


def _read_limits(source: Source) -> Mapping[str, float]:
    stated = mapping(source.data.get("limits", {}), source, ("limits",))
    check_keys(stated, METRICS, source, ("limits",))
    return {name: read_number(each, source, ("limits", name), METRICS[name].unit) for name, each in stated.items()}


def _read_table(source: Source) -> _Table | None:
    stated = source.data.get("table")
    if not _is_table(source):
        if "table" in source.data:
            problem = f"design '{source.data.get('design', 'cross')}' takes no table; write design: table"
            raise source.error(("table",), problem)
        return None
    if not isinstance(stated, str):
        raise source.error(("table",), "design 'table' needs the path of a CSV file whose columns are keys")
    path = source.path.parent / stated
    with placed(source.place(("table",))):
        frame = read_table(path)
    if frame.empty:
        raise InputError(f"{path}: a design has a line of different keys, and below it a line for each point")
    return _Table(path, {str(key): [_read_cell(str(cell)) for cell in frame[key].tolist()] for key in frame})


def _read_cell(text: str) -> object:
    """Return a cell as YAML reads it: a number, a truth value, or text."""
    try:
        return parse_value(text)
    except YamlError:
        return text


def sweep_schema() -> Schema:
    """Return the JSON Schema of a sweep."""
    limits = mapping_schema({name: {"type": "number", "unit": metric.unit} for name, metric in METRICS.items()})
    return head_schema("seatsim sweep", _SCHEMA | {"properties": _SCHEMA["properties"] | {"limits": limits}})
