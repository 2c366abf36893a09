"""Files of a result: table, histories, pictures."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from seatsim.provenance.manifest import write_documented
from seatsim.report.blocks import Report
from seatsim.report.rendering import write_html
from seatsim.report.runs import report_runs
from seatsim.schema.files import write_json, write_together, write_whole
from seatsim.schema.text import disarm
from seatsim.simulation.performance_bounds import measure_distance
from seatsim.simulation.result import Result, Run
from seatsim.simulation.runs import write_histories

if TYPE_CHECKING:
    from matplotlib.figure import Figure


MOST_KEPT = 400_000
"""Rows of the histories that are written after an interrupt, which takes about half a second."""


def write_result(result: Result, folder: Path) -> list[Path]:
    """Write `summary.csv`, `summary.json`, `history.parquet`, `report.html` and the pictures; return their paths."""
    title = os.path.basename(os.path.abspath(folder))
    report = report_runs(result.runs, "seatsim run SCENARIO", title, result.failures)
    seeds = {run.scenario.seed for run in result.runs}
    seed = seeds.pop() if len(seeds) == 1 else None
    return write_documented(folder, partial(_write_files, result, report), seed)


def write_interrupted(result: Result, folder: Path) -> list[Path]:
    """Write `summary.csv`, `summary.json` and, where it is short, `history.parquet`: who interrupts does not wait."""
    is_short = sum(len(run.history["time"]) for run in result.runs) <= MOST_KEPT

    def write(part: Path) -> list[Path]:
        histories = [write_histories(result.runs, part / "history.parquet")] if is_short else []
        return [*_write_summaries(result, part), *histories]

    return write_together(folder, write)


def _write_summaries(result: Result, folder: Path) -> list[Path]:
    return [
        write_whole(folder / "summary.csv", partial(_write_table, result.rows)),
        write_json(folder / "summary.json", _encode_runs(result)),
    ]


def _write_files(result: Result, report: Report, folder: Path) -> list[Path]:
    with ThreadPoolExecutor(max_workers=1) as pool:
        # Compressing the histories, in a thread of its own, releases Python's lock to the drawing of the pictures.
        history = pool.submit(write_histories, result.runs, folder / "history.parquet")
        from seatsim.plots.runs.draw import plot_result

        paths = [*_write_summaries(result, folder), write_html(report, folder / "report.html")]
        pictures = write_pictures(plot_result(result), folder)
        if result.brackets:
            paths.append(write_json(folder / "brackets.json", {"rigs": _encode_brackets(result)}))
        return [*paths, history.result(), *pictures]


def encode_result(result: Result) -> dict[str, object]:
    """Return what `summary.json` holds of a result, with what `brackets.json` holds where there are bounds."""
    return _encode_runs(result) | ({"rigs": _encode_brackets(result)} if result.brackets else {})


def _encode_runs(result: Result) -> dict[str, object]:
    return {"runs": [_encode_summary(run) for run in result.runs]}


def write_pictures(figures: Mapping[str, Figure], folder: Path) -> list[Path]:
    """Write figures as `NAME.png` and return their paths; the same figure gives the same bytes."""
    from seatsim.plots.saving import save_figure

    return [write_whole(folder / f"{name}.png", partial(save_figure, figure)) for name, figure in figures.items()]


def _encode_brackets(result: Result) -> list[dict[str, object]]:
    """Return for each rig its performance bounds, and for each of its runs how far from them it is."""
    found = []
    for rig, bracket in result.brackets.items():
        runs = [run for run in result.runs if run.scenario.rig == rig]
        standing = [_encode_name(run) | measure_distance(run, bracket)._asdict() for run in runs]
        found.append({**bracket.as_dict(), "runs": standing})
    return found


def _encode_name(run: Run) -> dict[str, object]:
    """Return the name of a run's scenario, and what sets the run apart from the others."""
    return {"scenario": run.scenario.name, "label": dict(run.scenario.label)}


def _encode_summary(run: Run) -> dict[str, object]:
    metrics = {name: {"value": m.value, "unit": m.unit, "meaning": m.meaning} for name, m in run.metrics.items()}
    return _encode_name(run) | {
        "metrics": metrics,
        "warnings": list(run.warnings),
        "unverified": list(run.unverified),
        "notes": list(run.history.notes),
    }


def _write_table(rows: Sequence[Mapping[str, object]], path: Path) -> None:
    """Write rows below each other, with a column for every name; what is absent or NaN stays empty."""
    names = dict.fromkeys(name for row in rows for name in row)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(map(disarm, names))
        writer.writerows([_cell(row.get(name, "")) for name in names] for row in rows)


def _cell(value: object) -> object:
    """Return a value as a table writes it; NaN is an empty cell."""
    return "" if isinstance(value, float) and math.isnan(value) else disarm(value)
