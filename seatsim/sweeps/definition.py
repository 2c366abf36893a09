"""What a sweep file states: the scenario, the varied keys, the design that combines them, and limits of metrics.

scenario: quickstart.yaml
seed: 1
design: lhs
runs: 1000
vary: {plant.driver_mass: {normal: [80, 12], low: 50, high: 120}}
limits: {driver_acceleration_weighted: 0.5}
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import NamedTuple

from seatsim.metrics.table import METRICS
from seatsim.scenario.loading import find_file
from seatsim.schema.errors import InputError, permit, read_each
from seatsim.schema.guarded import is_there, read_bytes
from seatsim.schema.json_schema import BY_KEY, TEXT, Schema, head_schema, mapping_schema
from seatsim.schema.validation import check_keys, mapping, read_number, read_whole
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import YamlError, parse_value
from seatsim.sweeps.axes import SPECIMENS, Axis, axis_schema, read_axis

_DESIGNS = ("cross", "zip", "lhs", "sobol", "table")
_KEYS = ("scenario", "seed", "design", "runs", "replicates", "vary", "table", "limits")
MOST_RUNS = 10_000_000
"""Runs of a sweep: their numbers have this many digits, and more would be a slip of the keyboard."""
_LARGEST_DESIGN = 2**30
"""Bytes of a table of runs."""


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
        "source": lambda: check_keys(source.data, _KEYS, source, ()),
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
    return tuple(read_each({key: partial(read_axis, key, source) for key in stated}).values())


def is_sweep(data: Mapping[str, object]) -> bool:
    """Tell whether the content of a YAML file is a sweep and no scenario."""
    return "scenario" in data and bool({"vary", "table", "design"} & set(data))


def _read_design(source: Source) -> str:
    name = source.data.get("design", "cross")
    if name not in _DESIGNS:
        problem = f"{name!r} is not permitted{permit(name, _DESIGNS)}"
        raise source.error(("design",), problem)
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
    try:
        text = read_bytes(path, _LARGEST_DESIGN, "a CSV file").decode("utf-8-sig")
        rows = list(csv.reader(text.splitlines()))
    except (UnicodeDecodeError, csv.Error, InputError) as error:
        raise source.error(("table",), f"{path} cannot be read: {error}") from error
    head, body = (rows[0], [row for row in rows[1:] if row]) if rows else ([], [])
    if not head or not body or len(set(head)) < len(head):
        raise InputError(f"{path}: a design has a line of different keys, and below it a line for each point")
    for number, row in enumerate(body, start=2):
        if len(row) != len(head):
            raise InputError(f"{path}, row {number}: has {len(row)} values; {len(head)} keys are named")
    return _Table(path, {key: [_read_cell(row[k]) for row in body] for k, key in enumerate(head)})


def _read_cell(text: str) -> object:
    """Return a cell as YAML reads it: a number, a truth value, or text."""
    try:
        return parse_value(text)
    except YamlError:
        return text


def sweep_schema() -> Schema:
    """Return the JSON Schema of a sweep."""
    whole: Schema = {"type": "integer", "minimum": 1}
    keys = {
        "scenario": {"anyOf": [TEXT, BY_KEY]},
        "seed": {"type": "integer", "minimum": 0, "description": "every draw of the design derives from it"},
        "design": {"enum": list(_DESIGNS)},
        "runs": {**whole, "description": "points of lhs and sobol; draws of cross and zip"},
        "replicates": {**whole, "description": "runs of each point with other seeds of the scenario"},
        "vary": {"type": "object", "properties": {SPECIMENS: TEXT}, "additionalProperties": axis_schema()},
        "table": {**TEXT, "description": "CSV file whose columns are keys, for design table"},
        "limits": mapping_schema({name: {"type": "number", "unit": m.unit} for name, m in METRICS.items()}),
    }
    return head_schema("seatsim sweep", mapping_schema(keys, ("scenario",)))
