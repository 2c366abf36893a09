"""Files of what was simulated: of runs, and of the report of a sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import NamedTuple

from seatsim.cli.outputs.printing import print_reports
from seatsim.cli.outputs.writing import name_pictures, write_each, write_outputs
from seatsim.provenance.statement import write_documented
from seatsim.report.runs import report_runs
from seatsim.schema.content import Unwritten
from seatsim.schema.files import write_together
from seatsim.simulation.naming import make_title
from seatsim.simulation.result import Result
from seatsim.simulation.runs import write_histories
from seatsim.sweeps.parts import Exceedance
from seatsim.sweeps.sensitivity import Sensitivity

_MOST_KEPT = 400_000
"""Rows of the histories that are written after an interrupt, which takes about half a second."""


class RunAnswer(NamedTuple):
    """Results, one for each file (`run`) or one of all files (`compare`); `failed` says which runs failed, and why."""

    results: Sequence[Result]
    failed: Sequence[str]


def write_result(result: Result, folder: Path) -> list[Path]:
    """Write `summary.csv`, `summary.json`, `history.parquet`, `report.html` and the pictures; return their paths."""
    from seatsim.plots.runs.draw import plot_result

    figures = plot_result(result)
    report = report_runs(result.runs, figures, "seatsim run SCENARIO", make_title(result.runs), result.failures)
    seeds = {run.scenario.seed for run in result.runs}
    seed = seeds.pop() if len(seeds) == 1 else None
    contents = {**_summarise(result), "report.html": report, **name_pictures(figures)}
    return print_reports(write_documented(folder, partial(_write_run_files, result, contents), seed))


def write_interrupted(result: Result, folder: Path) -> list[Path]:
    """Write `summary.csv`, `summary.json` and, where it is short, `history.parquet`: who interrupts does not wait."""
    is_short = sum(len(run.history["time"]) for run in result.runs) <= _MOST_KEPT

    def write(part: Path) -> list[Path]:
        histories = [write_histories(result.runs, part / "history.parquet")] if is_short else []
        return [*write_each(_summarise(result), part), *histories]

    return write_together(folder, write)


def _summarise(result: Result) -> dict[str, object]:
    return {"summary.csv": result.rows, "summary.json": result}


def _write_run_files(result: Result, contents: Mapping[str, object], folder: Path) -> list[Path]:
    with ThreadPoolExecutor(max_workers=1) as pool:
        # Compressing the histories, in a thread of its own, releases Python's lock to the drawing of the pictures.
        history = pool.submit(write_histories, result.runs, folder / "history.parquet")
        return [*write_each(contents, folder), history.result()]


class SweepReport(NamedTuple):
    """What the report of a sweep says; the sensitivities of each metric are those of `sensitivity.csv`."""

    sentence: str
    exceeded: Sequence[Exceedance]
    sensitivities: Sequence[Sensitivity]
    paths: Unwritten[Sequence[Path]]


def write_sweep_report(folder: str | Path, out: str | Path | None = None) -> SweepReport:
    """Write the report of a sweep to the folder `out`, or to that of the sweep, and return what it says.

    Its files are `report.html`, `table.csv` and `sensitivity.csv`.

    Raises:
        InputError: the folder holds no sweep, or none of its runs has ended.
    """
    from seatsim.report.sweep import report_sweep, state_importance
    from seatsim.sweeps.parts import count_exceedances, read_rows, tabulate_quantiles
    from seatsim.sweeps.sensitivity import analyse_sensitivity, tabulate_sensitivities

    folder = Path(folder)
    out = Path(out or folder)
    rows = read_rows(folder)
    quantiles, found, exceeded = tabulate_quantiles(rows), analyse_sensitivity(rows), count_exceedances(rows)
    contents = {
        "table.csv": quantiles,
        "sensitivity.csv": tabulate_sensitivities(found),
        "report.html": report_sweep(rows, found, exceeded),
    }
    # In the folder of the sweep the manifest is that of the sweep.
    is_own = out.resolve() == folder.resolve()
    write = partial(write_each, contents)
    paths = print_reports(write_together(out, write)) if is_own else write_outputs(out, contents)
    return SweepReport(" ".join(state_importance(found, rows)), exceeded, found.rows, paths)


sweep_report = write_sweep_report
"""Its public name in `seatsim`."""
