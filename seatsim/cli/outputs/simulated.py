"""What was simulated as tables on the terminal and as files: runs, a design, the report of a sweep."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from statistics import fmean
from typing import TYPE_CHECKING, Literal, NamedTuple

from rich.markup import escape
from rich.table import Table

from seatsim.cli.outputs.printing import print_reports
from seatsim.cli.outputs.writing import name_pictures, write_each, write_outputs
from seatsim.cli.show_table import format_number, make_table
from seatsim.metrics.table import SHORT
from seatsim.provenance.statement import write_documented
from seatsim.report.blocks import Table as ReportTable
from seatsim.report.blocks import tabulate
from seatsim.report.runs import report_runs
from seatsim.rig.designs import Clipping, SynthesisedLaw, unit_of_gain
from seatsim.scenario.scenario import Scenario, condition_of, group_by_condition, is_condition
from seatsim.schema.content import Unwritten
from seatsim.schema.fields import read_packaged
from seatsim.schema.files import write_together
from seatsim.simulation.checks import describe_sampled_loop
from seatsim.simulation.naming import make_title
from seatsim.simulation.result import Result, Run
from seatsim.simulation.runs import write_histories
from seatsim.sweeps.parts import Exceedance
from seatsim.sweeps.sensitivity import Sensitivity

if TYPE_CHECKING:
    from controllers.synthesis import Design, GlobalProof


def _average(values: Sequence[float]) -> float:
    """Return the geometric mean, in which the same saving counts alike on a rough and on a smooth floor."""
    return math.exp(fmean(map(math.log, values))) if min(values) > 0 else fmean(values)


_SUMMARIES: Mapping[str, Callable[[Sequence[float]], float]] = {"average": _average, "peak": max, "sum": sum}


class _Column(NamedTuple):
    """A metric in the table: the unit shown, the factor to it, its decimals, and what sums it up over conditions."""

    metric: str
    unit: str
    scale: float
    decimals: int
    over: Literal["average", "peak", "sum"]

    @property
    def heading(self) -> str:
        """What the metric is called, on two lines, and the unit."""
        return SHORT[self.metric].replace(" ", "\n", 1) + f"\n[{self.unit}]"


_COLUMNS = read_packaged(Path(__file__).with_name("columns.yaml"), tuple[_Column, ...])
_COMPARED = _COLUMNS[:-1]
"""Columns of which the smallest value is the best."""
_UNVERIFIED_MARK = " *"
_UNVERIFIED_NOTE = "* not verified, and never the best: a warning says why"


def make_comparison_table(runs: Sequence[Run], title: str) -> Table:
    """Return the table of runs: what sets them apart, then comfort, travel and effort.

    Of several runs under one condition the best comfort and travel are bold. Runs whose figures are unverified are
    marked, and never the best. End-stop hits have a column where there are any.
    """
    keys, columns = _label_keys(runs), _list_shown(runs)
    groups = group_by_condition((run.scenario, run) for run in runs if not run.unverified)
    rivals = {id(run): group for group in groups for run in group if len(group) > 1}
    rows = []
    for run in runs:
        first, *others = _labels(run, keys)
        cells = [_cell(run, column, rivals.get(id(run), []) if column in _COMPARED else []) for column in columns]
        rows.append([first + _UNVERIFIED_MARK * bool(run.unverified), *others, *cells])
    headings = [*map(_head_label, keys), *(column.heading for column in columns)]
    caption = _UNVERIFIED_NOTE if any(run.unverified for run in runs) else None
    return make_table(title, headings, rows, range(len(keys)), caption)


def make_overall_table(runs: Sequence[Run]) -> list[Table]:
    """Return the table of choices over all conditions; none unless each of several was run under each of several.

    A choice is what is labelled and no condition, such as a variant. The smallest mean, peak and sum are bold.
    """
    conditions = {condition_of(run.scenario) for run in runs}
    choices: dict[tuple[str, ...], list[Run]] = {}
    keys = [key for key in _label_keys(runs) if not is_condition(key)]
    for run in runs:
        choices.setdefault(tuple(_labels(run, keys)), []).append(run)
    complete = all(
        len({condition_of(run.scenario) for run in of}) == len(of) == len(conditions) for of in choices.values()
    )
    if len(conditions) < 2 or len(choices) < 2 or not complete or any(run.unverified for run in runs):
        return []
    columns = _list_shown(runs)
    totals = {labels: [_summarise(of, each) for each in columns] for labels, of in choices.items()}
    least = [min(filter(math.isfinite, column), default=math.nan) for column in zip(*totals.values(), strict=True)]
    rows = []
    for labels, values in totals.items():
        judged = zip(columns, values, least, strict=True)
        marked = [_write(value, each, each in _COMPARED and value == low) for each, value, low in judged]
        rows.append([*labels, *marked])
    title = f"Over all {len(conditions)} conditions: geometric means, the largest peak, all hits"
    headings = [*map(_head_label, keys), *(each.heading for each in columns)]
    return [make_table(title, headings, rows, range(len(keys)))]


def _values(runs: Sequence[Run], column: _Column) -> list[float]:
    return [run.metrics[column.metric].value for run in runs if column.metric in run.metrics]


def _summarise(runs: Sequence[Run], column: _Column) -> float:
    values = _values(runs, column)
    return _SUMMARIES[column.over](values) if values else math.nan


def _list_shown(runs: Sequence[Run]) -> list[_Column]:
    return [column for column in _COLUMNS if column.metric != "end_stop_hits" or any(_values(runs, column))]


def _cell(run: Run, column: _Column, rivals: Sequence[Run]) -> str:
    """Return a figure of a run, bold where none of its rivals has a smaller one."""
    least = min(filter(math.isfinite, _values(rivals, column)), default=math.nan)
    return next((_write(value, column, value == least) for value in _values([run], column)), "-")


def _write(value: float, column: _Column, is_best: bool) -> str:
    text = format_number(value * column.scale, f".{column.decimals}f")
    return f"[bold green]{text}[/]" if is_best else text


def _label_keys(runs: Sequence[Run]) -> list[str]:
    keys = {"scenario": None} if len({run.scenario.name for run in runs}) > 1 else {}
    for run in runs:
        keys |= dict.fromkeys(run.scenario.label)
    return list(keys) or ["scenario"]


def _head_label(key: str) -> str:
    return "damper\n[°C]" if key == "temperature" else key.rpartition(".")[2].replace("_", "\n")


def _labels(run: Run, keys: Sequence[str]) -> list[str]:
    """Return what sets a run apart, as cells of a table."""
    label = {"scenario": run.scenario.name, **run.scenario.label}
    values = (label.get(key, "") for key in keys)
    return [escape(f"{value:g}" if isinstance(value, int | float) else str(value)) for value in values]


def tabulate_design(design: Design, scenario: Scenario) -> list[ReportTable]:
    """Return a design as a table: gain, norm and what no controller can go below, certificate, margins, poles.

    The margins in the same row as the disk's are those of the scenario's own plant, coil and controller.
    """
    proof = design.certificate
    rows = {
        f"gain on {', '.join(design.measures)}": ", ".join(f"{value:.6g}" for value in design.gain.ravel())
        + f"  [{', '.join(unit_of_gain(measure) for measure in design.measures)}]",
        "gamma": f"{design.gamma:.6g} (largest gain permitted {design.max_gain:g})",
        "lower bound": f"{design.lower_bound:.6g}, of any linear controller of any order",
        "certificate": f"bounded-real lemma at gamma {proof.gamma:.6g}" if proof else "none in double precision",
        "disk margin": _describe_disk_margin(min(loop.disk_margin for loop in design.loops)),
        "peak": f"{design.worst.peak_frequency / (2 * math.pi):.3g} Hz",
        "poles": ", ".join(f"{pole:.3g}" for pole in design.worst.poles) + "  [rad/s]",
    }
    if design.clipping is not None:
        rows["clipping"] = _describe_clipping(design.clipping)
    if design.proof is not None:
        rows["best gain"] = _describe_proof(design.proof)
    if len(design.loops) > 1:
        norms = [loop.gamma for loop in design.loops]
        proven = sum(loop.certificate is not None for loop in design.loops)
        span = f"gamma {min(norms):.6g} to {max(norms):.6g}, the worst is shown"
        rows["plants"] = f"{len(norms)}, of which {proven} certified; {span}"
    if not all(loop.norms_agree for loop in design.loops):
        rows["norms"] = "bisection and frequency grid differ by more than 1e-6: gamma may be too small"
    rows |= _check_loop(design, scenario)
    return tabulate("H-infinity static output feedback", "figure, value", rows.items(), 2)


def _describe_disk_margin(margin: float) -> str:
    # A margin of 2 stands for any gain; its factor (2 + a) / (2 - a) would divide by zero.
    most = "any" if margin > 2 - 1e-6 else f"{(2 + margin) / (2 - margin):.3g}"
    least, turn = (2 - margin) / (2 + margin), 2 * math.degrees(math.atan(margin / 2))
    return f"gain times {max(least, 0.0):.2g} to {most}, phase {turn:.3g} degrees"


def _describe_proof(proof: GlobalProof) -> str:
    if proof.better is not None:
        return f"no: {', '.join(f'{value:.6g}' for value in proof.better.ravel())} is better"
    if proof.is_proven:
        return f"proven: no permitted gain is better by more than 0.1 % ({proof.boxes} boxes)"
    return f"not decided in the time permitted ({proof.boxes} boxes)"


def _describe_clipping(clipping: Clipping) -> str:
    return (
        f"driver Wk RMS {clipping.delivered:.3g} m/s², {clipping.promised:.3g} if the damper gave all that is wanted;"
        f" its force misses that by {100 * clipping.force_error:.0f} % RMS"
    )


def _check_loop(design: Design, scenario: Scenario) -> Mapping[str, str]:
    """Return what the scenario's own law says of its loop with the design's gain, by heading."""
    control, plant = scenario.control, scenario.plant
    if control is None or plant is None or not isinstance(control.law, SynthesisedLaw):
        return {}
    designed = replace(scenario, control=replace(control, law=control.law.with_gain(design.gain)))
    margins = control.law.margins(plant, scenario.coil, design.gain)
    return {"margins": margins, "sampled loop": describe_sampled_loop(designed)}


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
    contents = {**_list_summaries(result), "report.html": report, **name_pictures(figures)}
    return print_reports(write_documented(folder, partial(_write_run_files, result, contents), seed))


def write_interrupted(result: Result, folder: Path) -> list[Path]:
    """Write `summary.csv`, `summary.json` and, where it is short, `history.parquet`: who interrupts does not wait."""
    is_short = sum(len(run.history["time"]) for run in result.runs) <= _MOST_KEPT

    def write(part: Path) -> list[Path]:
        histories = [write_histories(result.runs, part / "history.parquet")] if is_short else []
        return [*write_each(_list_summaries(result), part), *histories]

    return write_together(folder, write)


def _list_summaries(result: Result) -> dict[str, object]:
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
    limits: Unwritten[Sequence[ReportTable]]
    paths: Unwritten[Sequence[Path]]


def write_sweep_report(folder: str | Path, out: str | Path | None = None) -> SweepReport:
    """Write the report of a sweep to the folder `out`, or to that of the sweep, and return what it says.

    Its files are `report.html`, `table.csv` and `sensitivity.csv`.

    Raises:
        InputError: the folder holds no sweep, or none of its runs has ended.
    """
    from seatsim.report.sweep import report_sweep, state_importance, tabulate_limits
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
    sentence, limits = " ".join(state_importance(found, rows)), tabulate_limits(exceeded, rows)
    return SweepReport(sentence, exceeded, found.rows, limits, paths)


sweep_report = write_sweep_report
"""Its public name in `seatsim`."""
