"""The rows of a sweep on disk: partitioned Parquet with one schema, a row for each run that has ended.

Part k holds the runs k * RUNS_OF_PART to (k + 1) * RUNS_OF_PART - 1 in order, whoever simulated them and in whatever
order they ended. It is replaced as a whole while runs are added to it, so that a run that has a row is done for good,
and one without is pending. Statistics take them as `SweepRows`: quantiles of every metric, and how often
it exceeds a limit, stand apart for each combination of the varied keys that are texts, such as variants and models.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from seatsim.metrics.exposure import ACTION
from seatsim.metrics.table import COMFORT, METRICS
from seatsim.scenario.scenario import is_condition
from seatsim.schema.arrays import open_parquet, store_numbers, store_texts
from seatsim.schema.errors import InputError
from seatsim.schema.files import write_whole
from seatsim.sweeps.definition import DISTRIBUTIONS
from seatsim.sweeps.engines import DONE, Outcome
from seatsim.sweeps.folder import read_manifest
from seatsim.sweeps.plan import Plan

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

RUNS_OF_PART = 200
"""A part of runs of 10 s takes about a second, which is what a task of a cluster should take at least."""
_LEADING = ("run", "state", "reason", "seed")


def part_of(run: int) -> int:
    """Return the number of the part that holds a run."""
    return run // RUNS_OF_PART


def runs_of(part: int, runs: int) -> range:
    """Return the runs that a part holds, of a sweep of so many runs."""
    return range(part * RUNS_OF_PART, min((part + 1) * RUNS_OF_PART, runs))


def _part_path(folder: Path, part: int) -> Path:
    """Return the file of a part."""
    return folder / "runs" / f"part-{part:06d}.parquet"


def read_outcomes(folder: Path, part: int) -> list[Outcome]:
    """Return the outcomes that a part holds so far, in order.

    Raises:
        InputError: the file is no part of a sweep.
    """
    columns = _read_columns(folder, part, [*_LEADING, *METRICS])
    figures = zip(*(columns[name] for name in METRICS), strict=True)
    leading = zip(*(columns[name] for name in _LEADING), strict=True)
    return [Outcome._make((*first, metrics)) for first, metrics in zip(leading, figures, strict=True)]


def read_states(folder: Path, runs: int) -> Iterator[tuple[int, str, str]]:
    """Yield number, state and reason of every run that has a row.

    Raises:
        InputError: a file is no part of a sweep.
    """
    names = ["run", "state", "reason"]
    for part in range(part_of(runs - 1) + 1):
        columns = _read_columns(folder, part, names)
        yield from zip(*(columns[name] for name in names), strict=True)


def _read_columns(folder: Path, part: int, names: Sequence[str]) -> Mapping[str, list[Any]]:
    path = _part_path(folder, part)
    if not path.exists():
        return {name: [] for name in names}
    table = _read_part(path, names)
    return {name: table.column(name).to_pylist() for name in names}


def _read_part(path: Path, names: Sequence[str] | None = None) -> pa.Table:
    """Return the rows of a part, with these columns or with all.

    Raises:
        InputError: the file is no part of a sweep.
    """
    import pyarrow as pa

    try:
        table = open_parquet(path.read_bytes()).read(columns=names if names is None else list(names))
        table.select(names or [*_LEADING, *METRICS])
        table.validate(full=True)
    except (pa.ArrowException, OSError, KeyError, ValueError) as error:
        raise InputError(f"{path}: is no part of a sweep: {error}; remove it, and its runs run again") from error
    return table


def write_outcomes(folder: Path, part: int, plan: Plan, schema: pa.Schema, outcomes: Iterable[Outcome]) -> Path:
    """Write the outcomes of a part, which takes the place of what it held; `schema` is that of `make_schema`."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    outcomes = sorted(outcomes, key=lambda outcome: outcome.run)
    values = [plan.values(outcome.run) for outcome in outcomes]
    columns: list[Sequence[object]] = [[getattr(outcome, name) for outcome in outcomes] for name in _LEADING]
    columns += [[each[key] for each in values] for key in varied_keys(plan)]
    columns += map(list, zip(*(outcome.metrics for outcome in outcomes), strict=True))
    arrays = [_store(column, field.type) for column, field in zip(columns, schema, strict=True)]
    table = pa.Table.from_arrays(arrays, schema=schema)
    write = partial(pq.write_table, table, compression="zstd", compression_level=1)
    return write_whole(_part_path(folder, part), write, lasting=True)


def make_schema(plan: Plan, units: Mapping[str, str]) -> pa.Schema:
    """Return the one schema of all parts, with units in the metadata; `units` are those of the varied keys.

    A key whose values are numbers is a column of numbers; where some are none, all are texts.
    """
    import pyarrow as pa

    kinds = {"run": pa.int64(), "state": pa.string(), "reason": pa.string(), "seed": pa.int64()}
    fields = [pa.field(name, kinds[name]) for name in _LEADING]
    fields += [pa.field(key, _type_of(plan, key), metadata={"unit": units[key]}) for key in varied_keys(plan)]
    fields += [pa.field(name, pa.float64(), metadata={"unit": metric.unit}) for name, metric in METRICS.items()]
    return pa.schema(fields)


def varied_keys(plan: Plan) -> list[str]:
    """Return the keys that have columns of their own: `seed` is a column of every sweep."""
    return [key for key in plan.keys if key != "seed"]


def _type_of(plan: Plan, key: str) -> pa.DataType:
    import pyarrow as pa

    kinds = set(map(type, plan.every_value(key)))
    if kinds <= {int, float}:
        return pa.float64()
    return pa.bool_() if kinds == {bool} else pa.string()


def _store(values: Sequence[object], kind: pa.DataType) -> pa.Array:
    """Return the values of a column: in one of texts, JSON of what is none."""
    if str(kind) == "string":
        return store_texts([value if isinstance(value, str) else json.dumps(value, default=str) for value in values])
    present = np.array([value is not None for value in values])
    return store_numbers(np.array([value if value is not None else 0 for value in values]), kind, present)


def read_sweep(folder: str | Path) -> pd.DataFrame:
    """Return the rows of a sweep so far, one for each run that has ended, by number.

    Columns are `run`, `state` (done, failed, unverified), `reason`, `seed`, every varied key and every metric in SI
    units; a figure that does not exist is NaN, as are all of a failed run. `frame.attrs["units"]` holds units.

    Raises:
        InputError: the folder holds no sweep, or none of its runs has ended.
    """
    import pyarrow as pa

    folder = Path(folder)
    read_manifest(folder)
    parts = sorted(folder.glob("runs/part-*.parquet"))
    if not parts:
        raise InputError(f"{folder}: no run of this sweep has ended; go on with it with --resume")
    tables = [_read_part(part) for part in parts]
    try:
        table = pa.concat_tables(tables)
    except pa.ArrowInvalid as error:
        raise InputError(f"{folder}: holds parts of different sweeps: {error}; choose another folder") from error
    frame: pd.DataFrame = table.to_pandas()
    stated = {field.name: (field.metadata or {}).get(b"unit", b"").decode() for field in table.schema}
    frame.attrs["units"] = {name: unit for name, unit in stated.items() if unit}
    return frame


class SweepRows(NamedTuple):
    """The rows of a sweep: `usable` without those of failed and unverified runs; `keys` that have more than one value.

    `drawn` are the keys whose values come from a distribution. `metrics` are those that some run has.
    """

    folder: Path
    manifest: Mapping[str, Any]
    every: pd.DataFrame
    usable: pd.DataFrame
    keys: list[str]
    drawn: list[str]
    metrics: list[str]
    units: Mapping[str, str]

    @property
    def texts(self) -> list[str]:
        """The varied keys whose values are no numbers."""
        return [key for key in self.keys if not is_number(self.usable[key])]

    @property
    def is_random(self) -> bool:
        """Whether points are drawn, so that shares of runs estimate probabilities."""
        return bool(self.drawn)


def read_rows(folder: Path) -> SweepRows:
    """Return the rows of a sweep.

    Raises:
        InputError: the folder holds no sweep, or none of its runs has ended.
    """
    manifest, frame = read_manifest(folder), read_sweep(folder)
    usable = frame[frame.state == DONE]
    named = [name for name in frame.columns if name not in (*_LEADING, *METRICS)]
    vary = manifest["configuration"].get("vary", {})
    return SweepRows(
        folder=folder,
        manifest=manifest,
        every=frame,
        usable=usable,
        keys=[key for key in named if frame[key].nunique() > 1],
        drawn=[key for key, stated in vary.items() if isinstance(stated, dict) and set(DISTRIBUTIONS) & set(stated)],
        metrics=[name for name in METRICS if usable[name].notna().any()],
        units=frame.attrs["units"],
    )


def find_best_choices(rows: SweepRows) -> tuple[list[str], pd.DataFrame | None]:
    """Return the keys, conditions first, and the most comfortable choice under each condition, the worst one first.

    Comfort is the mean over seeds. Only a design with every choice under every condition can be compared so: else there
    is no frame.
    """
    conditions = [key for key in rows.keys if is_condition(key)]
    keys = [*conditions, *(key for key in rows.keys if key not in conditions)]
    if not 0 < len(conditions) < len(keys) or rows.is_random or COMFORT not in rows.metrics:
        return keys, None
    means = rows.usable.groupby(keys, as_index=False)[COMFORT].mean()
    groups = means.groupby(conditions)[COMFORT]
    return keys, means.loc[groups.idxmin()].sort_values(COMFORT, ascending=False) if groups.size().min() > 1 else None


def is_number(column: pd.Series) -> bool:
    """Tell whether a column holds numbers, truth values not among them."""
    return column.dtype.kind in "if"


_MOST_GROUPS = 60
"""Combinations of texts up to which each has rows of its own; of more, all runs are taken together."""
_SHARES = (0.05, 0.25, 0.5, 0.75, 0.95)
NAMES = ("p05", "p25", "median", "p75", "p95")


def _group_values(rows: SweepRows, metrics: Iterable[str]) -> Iterator[tuple[dict[str, object], str, pd.Series]]:
    """Yield each combination of the texts that were varied with each metric that it has, and its values in the runs.

    All runs are one where no texts were varied, or too many.
    """
    texts = rows.texts
    groups: Iterable[tuple[dict[str, object], pd.DataFrame]] = [(dict.fromkeys(texts, "all"), rows.usable)]
    if texts and len(rows.usable.groupby(texts)) <= _MOST_GROUPS:
        named = rows.usable.groupby(texts, sort=False)
        groups = ((dict(zip(texts, values, strict=True)), runs) for values, runs in named)
    for group, runs in groups:
        for metric in metrics:
            values = runs[metric].dropna()
            if not values.empty:
                yield group, metric, values


def tabulate_quantiles(rows: SweepRows) -> pd.DataFrame:
    """Return a row for each group and metric: how many runs, mean, standard deviation, least, quantiles, greatest.

    Quantiles are interpolated linearly between the runs. A metric that a group lacks has no row.
    """
    import pandas as pd

    found = []
    for group, metric, values in _group_values(rows, rows.metrics):
        quantiles = dict(zip(NAMES, values.quantile(list(_SHARES)), strict=True))
        figures = {"mean": values.mean(), "std": values.std(), "min": values.min(), **quantiles, "max": values.max()}
        found.append({**group, "metric": metric, "unit": rows.units[metric], "runs": len(values), **figures})
    return pd.DataFrame(found)


_DEFAULT_LIMITS: Mapping[str, float] = {"driver_acceleration_weighted": ACTION.a8, "end_stop_hits": 0.0}
"""Where a sweep states none: the action value of 2002/44/EC for a day of eight hours of this vibration, and any hit."""


class Exceedance(NamedTuple):
    """How many of some runs exceed a limit: the share with its Wilson interval of 95 %."""

    group: Mapping[str, object]
    metric: str
    unit: str
    limit: float
    exceeding: int
    runs: int
    share: float
    low: float
    high: float


def count_exceedances(rows: SweepRows) -> list[Exceedance]:
    """Return how often each limit of the sweep is exceeded, by group; a run without the metric does not count."""
    from scipy.stats import binomtest

    limits = rows.manifest["limits"] or _DEFAULT_LIMITS
    found = []
    for group, metric, values in _group_values(rows, limits):
        limit, count = limits[metric], len(values)
        exceeding = int((values > limit).sum())
        interval = binomtest(exceeding, count).proportion_ci(0.95, method="wilson")
        unit, share = rows.units[metric], exceeding / count
        found.append(Exceedance(group, metric, unit, limit, exceeding, count, share, *interval))
    return found
