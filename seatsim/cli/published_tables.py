"""Published figures of a scenario file next to those of its runs."""

from __future__ import annotations

from collections.abc import Sequence

from rich import box
from rich.markup import escape
from rich.table import Table

from seatsim.scenario.published import Published, published_figures
from seatsim.simulation.result import Run


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
