"""The reports of one simulated run and of a comparison of several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from seatsim.metrics.table import SHORT
from seatsim.plots.densities import METHOD as DENSITY
from seatsim.plots.labels import describe_channel, format_number, format_unit
from seatsim.plots.runs.naming import label_runs, show_runs
from seatsim.report.alternatives import SAME, find_best, read_metric
from seatsim.report.blocks import Report, Section, Table, list_notes, show_pictures
from seatsim.report.credibility.card import say_doubt, show_card
from seatsim.report.credibility.evidence import collect_runs
from seatsim.report.formatting import format_quantity, format_sentence, format_setting
from seatsim.report.headline import compare_runs, describe_run
from seatsim.report.method import describe_method
from seatsim.report.run_advice import advise_on_runs
from seatsim.report.run_pictures import show_signals
from seatsim.scenario.numbers import find_unit, list_numbers
from seatsim.schema.text import name_some
from seatsim.simulation.result import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

UNVERIFIED = "* unverified, and never the best: the notes say why."
METHOD = (
    "All figures are of the whole run. The driver's weighted RMS acceleration is weighted by Wk of ISO 2631-1; the SEAT"
    " factor is that over the floor's.",
    "Floor, seed, temperature, driver and start are conditions, under which a seat has to do well; all else is a"
    f" choice. Only runs under one condition are compared. Figures within {100 * SAME:g} % count as equal.",
    f"Spectra: {DENSITY}",
)


def report_runs(
    runs: Sequence[Run], figures: Mapping[str, Figure], command: str, title: str, failures: Sequence[str] = ()
) -> Report:
    """Return the report of runs: of a single one, or of a comparison.

    Args:
        runs: the runs, at least one.
        figures: of their result, by name.
        command: what makes the report again.
        title: what they are on.
        failures: why others were not carried to their end.
    """
    evidence = collect_runs(runs)
    signals = [*show_pictures(figures, "time_histories"), show_signals(show_runs(runs))]
    sections = [
        Section(
            "figures",
            "Comfort, travel and effort",
            [*show_pictures(figures, "pareto", "comparison"), _make_table(runs)],
        ),
        Section("signals", "Signals over time", signals),
        Section("spectra", "Driver and floor over frequency", show_pictures(figures, "transmissibility", "psd")),
        Section("loops", "Loops of the damper", show_pictures(figures, "damper_loops", "force_velocity")),
        Section("notes", "Notes", list_notes(_state_notes(runs))),
        show_card(evidence),
        describe_method(METHOD, command, [_list_settings(runs)]),
    ]
    single = len(runs) == 1
    about = f"Simulated run: {title}" if single else f"Comparison of {len(runs)} simulated runs: {title}"
    answer, *others = [describe_run(runs[0])] if single else compare_runs(runs)
    lead = [*others, *_list_gaps(runs, failures)]
    return Report(about, answer, lead, advise_on_runs(runs), sections, say_doubt(evidence))


def _list_gaps(runs: Sequence[Run], failures: Sequence[str]) -> list[str]:
    """Return what the answer leaves out: runs that failed, and those whose figures cannot be relied on."""
    doubtful = [f"“{name}”" for name, run in zip(label_runs(runs), runs, strict=True) if run.unverified]
    texts = [f"The figures of {name_some(doubtful)} cannot be relied on; the notes say why."] if doubtful else []
    if failures:
        others = f", and {len(failures) - 1} others" if len(failures) > 1 else ""
        texts.append(f"{len(failures)} of {len(runs) + len(failures)} runs failed: {failures[0]}{others}")
    return [format_sentence(text) for text in texts]


def _make_table(runs: Sequence[Run]) -> Table:
    if len(runs) == 1:
        return _list_metrics(runs[0])
    chosen = [name for name in SHORT if any(name in run.metrics for run in runs)]
    shown = {name: describe_channel(SHORT[name], _unit_of(runs, name)) for name in chosen}
    head = ["run", *(each.words if each.unit == "-" else each.axis for each in shown.values())]
    rows = [
        [
            f"{name} *" if run.unverified else name,
            *(_format_metric(metric, shown[metric].factor * read_metric(run, metric)) for metric in chosen),
        ]
        for name, run in zip(label_runs(runs), runs, strict=True)
    ]
    best = find_best(runs)
    bold = f" The most comfortable run{' of each condition' * (len(best) > 1)} is in bold." if best else ""
    mark = f" {UNVERIFIED}" if any(run.unverified for run in runs) else ""
    return Table(f"Figures of each run; summary.csv has more.{bold}{mark}", head, rows, 1, best)


def _format_metric(name: str, value: float) -> str:
    return f"{value:.0f}" if name == "end_stop_hits" and np.isfinite(value) else format_number(value)


def _list_metrics(run: Run) -> Table:
    """Return every figure of a run as a table."""
    rows = [
        [format_sentence(metric.meaning).rstrip("."), format_quantity(metric.value, metric.unit)]
        for metric in run.metrics.values()
    ]
    return Table("Every figure of the run", ["figure", "value"], rows)


def _unit_of(runs: Sequence[Run], name: str) -> str:
    return next(run.metrics[name].unit for run in runs if name in run.metrics)


def _state_notes(runs: Sequence[Run]) -> list[str]:
    texts = [f"{run.scenario.title} is unverified: {reason}" for run in runs for reason in run.unverified]
    texts += [sentence for run in runs for sentence in run.warnings]
    texts += [f"{run.scenario.title}: {sentence}" for run in runs for sentence in run.history.notes]
    return [format_sentence(text) for text in texts]


def _list_settings(runs: Sequence[Run]) -> Table:
    """Return the numbers of the first scenario by dotted key, with their units."""
    scenario = runs[0].scenario
    rows = [
        [key, format_unit(find_unit(scenario, key)) or "-", format_setting(value)]
        for key, value in list_numbers(scenario).items()
    ]
    return Table(f"Settings of {scenario.title}", ["key", "unit", "value"], rows, 2, folded=True)
