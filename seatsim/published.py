"""Published figures in a scenario file, beside which the table puts its own.

    published:
      source: where the figures stand
      rows:
        - {variant: I, temperature: 80.0, driver_acceleration_rms: 0.908}

A row names a run by what sets it apart, and gives metrics of it in SI units.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from rich import box
from rich.markup import escape
from rich.table import Table

from seatsim.metrics import METRICS
from seatsim.result import Run
from seatsim.validation import check_keys, mapping
from seatsim.yaml_source import Source


def check_published(source: Source, labels: Sequence[str]) -> None:
    """Raise InputError where the file's published figures are not of the form above; `labels` set its runs apart."""
    published = mapping(source.data["published"], source, ("published",))
    check_keys(published, ("source", "rows"), source, ("published",))
    rows = published.get("rows")
    if not isinstance(rows, list) or not rows:
        raise source.error(
            ("published", "rows"), "a list of at least one row, such as '- {variant: I, seat_factor: 0.8}'"
        )
    for index, row in enumerate(rows):
        keys = ("published", "rows", index)
        naming = [key for key in mapping(row, source, keys) if key in labels or "." in key]
        check_keys(row, [*naming, "variant", "temperature", *METRICS], source, keys)
        for name in [name for name in row if name in METRICS]:
            value = row[name]
            if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
                raise source.error((*keys, name), f"{value!r} is not permitted; it must be a finite number")


def published_tables(runs: Sequence[Run]) -> list[Table]:
    """Return one table for each file with published figures: ours, published, and the difference, metric by metric."""
    sources = {id(run.scenario.source): run.scenario.source for run in runs if run.scenario.source}
    files = {str(source.path): source.data["published"] for source in sources.values() if "published" in source.data}
    return [_table(published, [run for run in runs if _path(run) == path]) for path, published in files.items()]


def _path(run: Run) -> str:
    return str(run.scenario.source.path) if run.scenario.source else ""


def _table(published: Mapping[str, Any], runs: Sequence[Run]) -> Table:
    table = Table(
        title=escape(f"beside {published.get('source', 'published figures')}"),
        title_justify="left",
        box=box.SIMPLE_HEAD,
    )
    for heading in ("run", "metric", "ours", "published", "difference"):
        table.add_column(heading, justify="left" if heading in ("run", "metric") else "right", no_wrap=heading != "run")
    for row in published["rows"]:
        for run in runs:
            label = run.scenario.label
            if any(label.get(key) != value for key, value in row.items() if key in label):
                continue
            for name in [key for key in row if key in run.metrics]:
                ours, theirs = run.metrics[name].value, float(row[name])
                shown = f"{name} \\[{run.metrics[name].unit}]"
                difference = f"{100 * (ours / theirs - 1):+.1f} %" if theirs else "-"
                title = ", ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in label.values())
                table.add_row(escape(title), shown, f"{ours:.4g}", f"{theirs:.4g}", difference)
    return table
