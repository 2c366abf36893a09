"""The comparison table of runs on the terminal, and published figures of a scenario file next to those of its runs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from rich import box
from rich.markup import escape
from rich.table import Table

from seatsim.metrics.motion import ratio
from seatsim.metrics.table import SHORT
from seatsim.scenario.checks import Published, published_figures
from seatsim.scenario.scenario import group_by_condition
from seatsim.simulation.performance_bounds import measure_distance
from seatsim.simulation.result import Run


class Column(NamedTuple):
    """A metric in the table: the unit shown, the factor to it, its decimals."""

    metric: str
    unit: str
    scale: float
    decimals: int

    @property
    def heading(self) -> str:
        """What the metric is called, on two lines, and the unit."""
        return SHORT[self.metric].replace(" ", "\n", 1) + f"\n\\[{self.unit}]"


COLUMNS = (
    Column("driver_acceleration_rms", "m/s²", 1.0, 3),
    Column("driver_acceleration_weighted", "m/s²", 1.0, 3),
    Column("driver_vdv", "m/s¹·⁷⁵", 1.0, 2),
    Column("seat_factor", "-", 1.0, 2),
    Column("suspension_displacement_rms", "mm", 1e3, 2),
    Column("suspension_displacement_peak", "mm", 1e3, 1),
    Column("end_stop_hits", "-", 1.0, 0),
    Column("driver_jerk_rms", "m/s³", 1.0, 1),
    Column("current_rms", "A", 1.0, 2),
)
COMPARED = COLUMNS[:-1]
"""Columns of which the smallest value is the best."""
_UNVERIFIED_MARK = " *"
_UNVERIFIED_NOTE = "* not verified, and never the best: a warning says why"


def comparison(runs: Sequence[Run], title: str) -> Table:
    """Return the table of runs: what sets them apart, then comfort, travel and effort.

    Of several runs under one condition the best comfort and travel are bold. Runs whose figures are unverified are
    marked, and never the best. End-stop hits have a column where there are any.
    """
    labels, columns = _label_keys(runs), [column for column in COLUMNS if _is_shown(runs, column)]
    table = _headed(title, labels)
    for column in columns:
        table.add_column(column.heading, justify="right", vertical="bottom", no_wrap=True)
    if any(run.unverified for run in runs):
        table.caption, table.caption_justify = _UNVERIFIED_NOTE, "left"
    groups = group_by_condition((run.scenario, run) for run in runs if not run.unverified)
    best = {id(run): group for group in groups for run in group if len(group) > 1}
    for run in runs:
        cells = [escape(_label(run, key)) for key in labels]
        cells[0] += _UNVERIFIED_MARK if run.unverified else ""
        rivals = best.get(id(run), [])
        cells += [
            _cell(run, column, _best(rivals, column.metric) if column in COMPARED else None) for column in columns
        ]
        table.add_row(*cells)
    return table


def _is_shown(runs: Sequence[Run], column: Column) -> bool:
    hits = (run.metrics[column.metric].value for run in runs if column.metric in run.metrics)
    return column.metric != "end_stop_hits" or any(value > 0 for value in hits)


def distances(runs: Sequence[Run], brackets: Mapping[str, Any]) -> Table:
    """Return the table of how far each run with performance bounds is from both of them, at the run's travel."""
    chosen = [run for run in runs if run.scenario.rig in brackets]
    keys = _label_keys(chosen)
    table = _headed("Distance from the clairvoyant bracket, at each run's travel", keys)
    for heading in ("Wk RMS", "bound", "best"):
        table.add_column(f"{heading}\n\\[m/s²]", justify="right", vertical="bottom", no_wrap=True)
    for heading in ("above\nbound", "above\nbest", "bracket's\nwidth"):
        table.add_column(f"{heading}\n\\[%]", justify="right", vertical="bottom", no_wrap=True)
    for run in chosen:
        d = measure_distance(run, brackets[run.scenario.rig])
        cells = [_number(value, 3) for value in (d.acceleration, d.bound, d.best)]
        cells += [_number(1e2 * value, 1) for value in (d.above_bound, d.above_best, ratio(d.best, d.bound) - 1)]
        table.add_row(*(escape(_label(run, key)) for key in keys), *cells)
    return table


def _headed(title: str, keys: Sequence[str]) -> Table:
    """Return a table without rows, whose first columns are the labels of the runs."""
    table = Table(title=escape(title), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for key in keys:
        heading = "damper\n\\[°C]" if key == "temperature" else key.rpartition(".")[2].replace("_", "\n")
        table.add_column(heading, vertical="bottom", no_wrap="." in key or key == "temperature")
    return table


def _number(value: float, decimals: int) -> str:
    return f"{value:.{decimals}f}" if math.isfinite(value) else "-"


def _label_keys(runs: Sequence[Run]) -> list[str]:
    keys: dict[str, None] = {}
    if len({run.scenario.name for run in runs}) > 1:
        keys["scenario"] = None
    for run in runs:
        keys |= dict.fromkeys(run.scenario.label)
    return list(keys) or ["scenario"]


def _label(run: Run, key: str) -> str:
    value: object = run.scenario.name if key == "scenario" else run.scenario.label.get(key, "")
    return f"{value:g}" if isinstance(value, int | float) else str(value)


def _best(runs: Sequence[Run], metric: str) -> float:
    values = [run.metrics[metric].value for run in runs if metric in run.metrics]
    return min((value for value in values if math.isfinite(value)), default=math.nan)


def _cell(run: Run, column: Column, best: float | None) -> str:
    if column.metric not in run.metrics:
        return "-"
    value = run.metrics[column.metric].value
    if not math.isfinite(value):
        return "-"
    text = f"{value * column.scale:.{column.decimals}f}"
    return f"[bold green]{text}[/]" if best is not None and value == best else text


def published_tables(runs: Sequence[Run]) -> list[Table]:
    """Return one table for each file with published figures: ours, published, and the difference, metric by metric."""
    sources = {id(run.scenario.source): run.scenario.source for run in runs if run.scenario.source}
    files = {str(source.path): published_figures(source) for source in sources.values()}
    return [_table(found, [run for run in runs if _path(run) == path]) for path, found in files.items() if found]


def _path(run: Run) -> str:
    return str(run.scenario.source.path) if run.scenario.source else ""


def _table(published: Published, runs: Sequence[Run]) -> Table:
    table = Table(
        title=escape(f"beside {published.source}"),
        title_justify="left",
        box=box.SIMPLE_HEAD,
    )
    for heading in ("run", "metric", "ours", "published", "difference"):
        table.add_column(heading, justify="left" if heading in ("run", "metric") else "right", no_wrap=heading != "run")
    for index, row in enumerate(published.rows):
        for run in runs:
            label = run.scenario.label
            if any(label.get(key) != value for key, value in row.items() if key in label):
                continue
            for name in [key for key in row if key in run.metrics]:
                ours, theirs = run.metrics[name].value, published.figure(index, name)
                shown = f"{name} \\[{run.metrics[name].unit}]"
                difference = f"{100 * (ours / theirs - 1):+.1f} %" if theirs else "-"
                title = ", ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in label.values())
                table.add_row(escape(title), shown, f"{ours:.4g}", f"{theirs:.4g}", difference)
    return table
