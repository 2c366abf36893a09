"""The reports of one simulated run and of a comparison of several."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from seatsim.metrics.table import SHORT
from seatsim.plots.labels import format_unit
from seatsim.plots.runs.naming import find_unit, label_runs
from seatsim.report.blocks import Block, Items, Report, Section, Table
from seatsim.report.credibility.card import show_card
from seatsim.report.credibility.evidence import collect_runs
from seatsim.report.formatting import (
    describe_channel,
    format_number,
    format_percent,
    format_quantity,
    format_sentence,
    format_setting,
)
from seatsim.report.method import describe_method
from seatsim.report.run_pictures import draw_loops, group_runs, name_runs, show_signals, show_spectra
from seatsim.report.spectra import METHOD as SPECTRA
from seatsim.scenario.numbers import list_numbers
from seatsim.schema.text import join_names
from seatsim.simulation.result import Run

Array = NDArray[np.float64]

COMFORT, TRAVEL = "driver_acceleration_weighted", "suspension_displacement_peak"
METHOD = (
    "Accelerations are of the whole run after the settling time that the scenario states, weighted by Wk of ISO"
    " 2631-1; the SEAT factor is the driver's weighted acceleration over the floor's.",
    SPECTRA,
)


def report_runs(runs: Sequence[Run], command: str, title: str) -> Report:
    """Return the report of runs: of a single one, or of a comparison.

    Args:
        runs: the runs, at least one.
        command: what makes the report again.
        title: of the folder that they share.
    """
    groups = group_runs(runs)
    drawn = sum(map(len, groups.values()))
    omitted = f" {drawn} of {len(runs)} runs are drawn." if drawn < len(runs) else ""
    sections = [
        Section("figures", "Comfort, travel and effort", [_make_table(runs)]),
        Section("signals", "Signals over time", [show_signals(groups, omitted)]),
        Section("spectra", "Driver and floor over frequency", show_spectra(groups)),
        Section("loops", "Loops", [draw_loops(groups)]),
        Section("notes", "Notes", _list_notes(runs)),
        show_card(collect_runs(runs)),
        describe_method(METHOD, command, [_list_settings(runs)]),
    ]
    single = len(runs) == 1
    about = f"Simulated run: {title}" if single else f"Comparison of {len(runs)} simulated runs: {title}"
    answer = describe_run(runs[0]) if single else _compare(runs)
    return Report(about, answer, [], _advise(runs), sections)


def describe_run(run: Run) -> str:
    """Return in a sentence what a run comes to: comfort, and the travel that it takes."""
    comfort, seat = read_metric(run, COMFORT), read_metric(run, "seat_factor")
    said = f"{run.scenario.title}: the driver feels {format_quantity(comfort, 'm/s^2')} (weighted RMS)"
    if np.isfinite(seat):
        change = "less" if seat < 1 else "more"
        said += f", {format_percent(abs(1 - seat))} {change} than the floor moves"
    said += f"; the suspension travels up to {format_quantity(read_metric(run, TRAVEL), 'm')} from its rest"
    hits = read_metric(run, "end_stop_hits")
    if np.isfinite(hits):
        said += " and never meets its end stops" if hits == 0 else f" and meets its end stops {hits:.0f} times"
    return f"{said}."


def read_metric(run: Run, name: str) -> float:
    """Return a metric of a run in SI units, NaN where it has none."""
    return run.metrics[name].value if name in run.metrics else float("nan")


def _make_table(runs: Sequence[Run]) -> Table:
    if len(runs) == 1:
        return list_metrics(runs[0])
    chosen = [name for name in SHORT if any(name in run.metrics for run in runs)]
    shown = {name: describe_channel(SHORT[name], _unit_of(runs, name)) for name in chosen}
    head = ["run", *(each.words if each.unit == "-" else each.axis for each in shown.values())]
    rows = [
        [
            f"{name} (unverified)" if run.unverified else name,
            *(_format_metric(metric, shown[metric].factor * read_metric(run, metric)) for metric in chosen),
        ]
        for name, run in zip(name_runs(runs), runs, strict=True)
    ]
    best = [order[0] for order in _rank_within(runs)]
    bold = f" The most comfortable run{' of each scenario' * (len(best) > 1)} is in bold." if best else ""
    return Table(f"Figures of each run; summary.csv has more.{bold}", head, rows, 1, best)


def _format_metric(name: str, value: float) -> str:
    return f"{value:.0f}" if name == "end_stop_hits" and np.isfinite(value) else format_number(value)


def list_metrics(run: Run) -> Table:
    """Return every figure of a run as a table."""
    rows = [
        [format_sentence(metric.meaning).rstrip("."), format_quantity(metric.value, metric.unit)]
        for metric in run.metrics.values()
    ]
    return Table("Every figure of the run", ["figure", "value"], rows)


def _unit_of(runs: Sequence[Run], name: str) -> str:
    return next(run.metrics[name].unit for run in runs if name in run.metrics)


def _rank(runs: Sequence[Run]) -> list[int]:
    """Return the runs with a weighted acceleration that can be relied on, the most comfortable first."""
    known = [k for k, run in enumerate(runs) if np.isfinite(read_metric(run, COMFORT)) and not run.unverified]
    return sorted(known, key=lambda k: read_metric(runs[k], COMFORT))


def _rank_within(runs: Sequence[Run]) -> list[list[int]]:
    """Return the order of comfort within each scenario, whose runs share a floor, or over all where each has one."""
    order = _rank(runs)
    groups: dict[str, list[int]] = {run.scenario.name: [] for run in runs}
    for k in order:
        groups[runs[k].scenario.name].append(k)
    known = [group for group in groups.values() if group]
    return known if 1 < len(known) < len(order) else [order] * bool(order)


def _compare(runs: Sequence[Run]) -> str:
    orders = _rank_within(runs)
    if len(orders) > 1:
        return _name_winners(runs, [order[0] for order in orders])
    order = _rank(runs)
    if len(order) < 2:
        return f"{len(runs)} runs were simulated; too few of them have figures that can be relied on to be compared."
    best, worst = runs[order[0]], runs[order[-1]]
    low, high = read_metric(best, COMFORT), read_metric(worst, COMFORT)
    if high <= 1.005 * low:
        return f"All {len(order)} runs are alike in comfort: {format_quantity(low, 'm/s^2')} (weighted RMS)."
    names = name_runs(runs)
    return (
        f"Of {len(order)} runs “{names[order[0]]}” is the most comfortable: the driver feels"
        f" {format_quantity(low, 'm/s^2')} (weighted RMS), {format_percent(1 - low / high)} less than with"
        f" “{names[order[-1]]}”; the suspension travels up to {format_quantity(read_metric(best, TRAVEL), 'm')}."
    )


def _name_winners(runs: Sequence[Run], best: Sequence[int]) -> str:
    """Return the most comfortable run of each scenario in a sentence."""
    names = {k: label_runs([runs[k]])[0] for k in best}
    size = {k: f"{runs[k].scenario.name}: {format_quantity(read_metric(runs[k], COMFORT), 'm/s^2')}" for k in best}
    if len(set(names.values())) == 1:
        listed = "; ".join(size.values())
        return f"In every scenario “{names[best[0]]}” is the most comfortable (weighted RMS of the driver in {listed})."
    listed = "; ".join(f"“{names[k]}” in {size[k]}" for k in best)
    return f"The most comfortable runs, by the weighted RMS of the driver's acceleration, are {listed}."


def _advise(runs: Sequence[Run]) -> list[str]:
    found = []
    named = list(zip(name_runs(runs), runs, strict=True))
    hitting = [name for name, run in named if read_metric(run, "end_stop_hits") > 0]
    doubtful = [name for name, run in named if run.unverified]
    if doubtful:
        found.append(f"Do not rely on {join_names(doubtful[:3])}: the notes say why the figures are unverified.")
    if hitting:
        found.append(f"Look at the travel of {join_names(hitting[:3])}: the seat hits its end stops, which the driver"
                     " feels as a jolt.")  # fmt: skip
    amplifies = [name for name, run in named if read_metric(run, "seat_factor") > 1]
    if amplifies:
        found.append(f"The driver feels more than the floor moves in {join_names(amplifies[:3])}: try more damping near"
                     " the resonance of the seat, or a law such as skyhook.")  # fmt: skip
    if len(runs) == 1:
        found.append("Compare it with other laws or settings: seatsim compare takes several scenarios or a sweep.")
    else:
        found.append("Check that the order holds on other roads and with other drivers: seatsim sweep varies both.")
    return found


def _list_notes(runs: Sequence[Run]) -> list[Block]:
    texts = [f"{run.scenario.title} is unverified: {reason}" for run in runs for reason in run.unverified]
    texts += [sentence for run in runs for sentence in run.warnings]
    texts += [f"{run.scenario.title}: {sentence}" for run in runs for sentence in run.history.notes]
    return [Items([format_sentence(text) for text in dict.fromkeys(texts)])] if texts else []


def _list_settings(runs: Sequence[Run]) -> Table:
    """Return the numbers of the first scenario by dotted key, with their units."""
    scenario = runs[0].scenario
    rows = [
        [key, format_unit(find_unit(scenario, key)) or "-", format_setting(value)]
        for key, value in list_numbers(scenario).items()
    ]
    return Table(f"Settings of {scenario.title}", ["key", "unit", "value"], rows, 2, folded=True)
