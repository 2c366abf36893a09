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
from seatsim.report.blocks import Block, Report, Section, show_pictures, tabulate
from seatsim.report.closing import close_report
from seatsim.report.credibility import Factor, count_variations, say_doubt, trace_inputs, verify
from seatsim.report.formatting import format_quantity, format_sentence, format_setting
from seatsim.report.headline import compare_runs, describe_run
from seatsim.report.run_advice import advise_on_runs
from seatsim.report.run_pictures import show_signals
from seatsim.scenario.numbers import find_unit, list_numbers
from seatsim.scenario.scenario import Scenario
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
    factors = judge_runs(runs)
    bars, signals = show_pictures(figures, "pareto", "comparison"), show_pictures(figures, "time_histories")
    sections = [
        Section("figures", "Comfort, travel and effort", [*bars, *_tabulate_figures(runs)]),
        Section("signals", "Signals over time", [*signals, show_signals(show_runs(runs))]),
        Section("spectra", "Driver and floor over frequency", show_pictures(figures, "transmissibility", "psd")),
        Section("loops", "Loops of the damper", show_pictures(figures, "damper_loops", "force_velocity")),
        *close_report(_state_notes(runs), factors, METHOD, command, _list_settings(runs[0].scenario)),
    ]
    single = len(runs) == 1
    about = f"Simulated run: {title}" if single else f"Comparison of {len(runs)} simulated runs: {title}"
    answer, *others = [describe_run(runs[0])] if single else compare_runs(runs)
    lead = [*others, *_list_gaps(runs, failures)]
    return Report(about, answer, lead, advise_on_runs(runs), sections, say_doubt(factors))


def judge_runs(runs: Sequence[Run]) -> list[Factor]:
    """Return how far simulated runs may be trusted."""
    energies = [run.metrics["energy_residual"].value for run in runs if "energy_residual" in run.metrics]
    doubts = dict.fromkeys(text for run in runs for text in run.warnings)
    return [
        verify("up to {} of the energy is unaccounted for", energies),
        trace_inputs(list(doubts), {type(run.scenario.damper.record) for run in runs}),
        count_variations(len(runs)),
    ]


def _list_gaps(runs: Sequence[Run], failures: Sequence[str]) -> list[str]:
    """Return what the answer leaves out: runs that failed, and those whose figures cannot be relied on."""
    doubtful = [f"“{name}”" for name, run in zip(label_runs(runs), runs, strict=True) if run.unverified]
    texts = [f"The figures of {name_some(doubtful)} cannot be relied on; the notes say why."] if doubtful else []
    if failures:
        others = f", and {len(failures) - 1} others" if len(failures) > 1 else ""
        texts.append(f"{len(failures)} of {len(runs) + len(failures)} runs failed: {failures[0]}{others}")
    return [format_sentence(text) for text in texts]


def _tabulate_figures(runs: Sequence[Run]) -> list[Block]:
    """Return every figure of one run, or the figures of several side by side."""
    if len(runs) == 1:
        every = [(format_sentence(each.meaning).rstrip("."), format_quantity(each.value, each.unit))
                 for each in runs[0].metrics.values()]  # fmt: skip
        return tabulate("Every figure of the run", "figure, value", every)
    units = {name: each.unit for run in reversed(runs) for name, each in run.metrics.items()}
    shown = {name: describe_channel(words, units[name]) for name, words in SHORT.items() if name in units}
    rows = [
        (f"{name} *" if run.unverified else name,
         *(_format_metric(metric, shown[metric].factor * read_metric(run, metric)) for metric in shown))
        for name, run in zip(label_runs(runs), runs, strict=True)
    ]  # fmt: skip
    best = find_best(runs)
    bold = f" The most comfortable run{' of each condition' * (len(best) > 1)} is in bold." if best else ""
    mark = f" {UNVERIFIED}" if any(run.unverified for run in runs) else ""
    head = ["run", *(each.words if each.unit == "-" else each.axis for each in shown.values())]
    return tabulate(f"Figures of each run; summary.csv has more.{bold}{mark}", head, rows, 1, best)


def _format_metric(name: str, value: float) -> str:
    return f"{value:.0f}" if name == "end_stop_hits" and np.isfinite(value) else format_number(value)


def _state_notes(runs: Sequence[Run]) -> list[str]:
    texts = [f"{run.scenario.title} is unverified: {reason}" for run in runs for reason in run.unverified]
    texts += [sentence for run in runs for sentence in run.warnings]
    return texts + [f"{run.scenario.title}: {sentence}" for run in runs for sentence in run.history.notes]


def _list_settings(scenario: Scenario) -> list[Block]:
    """Return the numbers of the first scenario by dotted key, with their units."""
    rows = [
        (key, format_unit(find_unit(scenario, key)) or "-", format_setting(value))
        for key, value in list_numbers(scenario).items()
    ]
    return tabulate(f"Settings of {scenario.title}", "key, unit, value", rows, 2, folded=True)
