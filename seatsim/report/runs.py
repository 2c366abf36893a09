"""The reports of one simulated run and of a comparison of several: figures, signals over time, what to do next."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatsim.metrics.table import SEAT, SHORT
from seatsim.plots.runs.looks import Shown, show_runs
from seatsim.plots.style import COLOURS
from seatsim.report.blocks import Figures, Report, Signals, Table, show_pictures, tabulate
from seatsim.report.composing import compose
from seatsim.report.formatting import choose_advice, format_quantity, format_sentence, format_setting, show_table
from seatsim.report.headline import SAME, compare_runs, count_times, describe_run, find_best
from seatsim.report.packing import FINEST, Panel, pack_signals
from seatsim.scenario.numbers import find_unit, list_numbers
from seatsim.scenario.scenario import condition_of
from seatsim.schema.arrays import Array
from seatsim.schema.printing import describe_channel, format_number, format_unit
from seatsim.schema.text import name_some
from seatsim.simulation.naming import label_runs, name_runs
from seatsim.simulation.result import UNITS, Run

HITS = "end_stop_hits"
CHANNELS = (
    "driver_acceleration", "suspension_displacement", "damper_force", "coil_current", "frame_acceleration",
    "floor_acceleration", "damper_temperature",
)  # fmt: skip
UNVERIFIED = "* unverified, and never the best: the notes say why."


def report_runs(
    runs: Sequence[Run], figures: Figures, command: str, title: str, failures: Sequence[str] = ()
) -> Report:
    """Return the report of runs: of a single one, or of a comparison.

    Args:
        runs: the runs, at least one.
        figures: of their result, by name.
        command: what makes the report again.
        title: what they are on.
        failures: why others were not carried to their end.
    """
    sections = {
        "figures": [*show_pictures(figures, "pareto", "comparison"), *_tabulate_figures(runs)],
        "signals": [*show_pictures(figures, "time_histories"), show_signals(show_runs(runs))],
        "spectra": show_pictures(figures, "transmissibility", "psd"),
        "loops": show_pictures(figures, "force_velocity"),
    }
    about, said = f"Comparison of {len(runs)} simulated runs: {title}", compare_runs(runs)
    if len(runs) == 1:
        about, said = f"Simulated run: {title}", [describe_run(runs[0])]
    # What the answer leaves out: figures that cannot be relied on, and runs that failed.
    doubtful = [f"“{name}”" for name, run in zip(name_runs(runs), runs, strict=True) if run.unverified]
    gaps = [f"The figures of {name_some(doubtful)} cannot be relied on; the notes say why."] if doubtful else []
    if failures:
        others = f", and {len(failures) - 1} others" if len(failures) > 1 else ""
        gaps.append(f"{len(failures)} of {len(runs) + len(failures)} runs failed: {failures[0]}{others}")
    notes = [f"{run.scenario.title} is unverified: {reason}" for run in runs for reason in run.unverified]
    notes += [sentence for run in runs for sentence in run.warnings]
    notes += [f"{run.scenario.title}: {sentence}" for run in runs for sentence in run.history.notes]
    scenario, numbers = runs[0].scenario, list_numbers(runs[0].scenario).items()
    rows = [(key, format_unit(find_unit(scenario, key)) or "-", format_setting(value)) for key, value in numbers]
    settings = show_table("settings", rows, 2, folded=True, title=str(scenario.title))
    answer, advice, same = [*said, *map(format_sentence, gaps)], _advise_on_runs(runs), f"{100 * SAME:g} %"
    return compose("runs", about, answer, advice, sections, notes, command, settings, same=same)


def _advise_on_runs(runs: Sequence[Run]) -> list[str]:
    """Return what to do next, each in a sentence or two; the worst run comes first, and others are counted."""
    named = [(f"“{name}”", run) for name, run in zip(name_runs(runs), runs, strict=True) if not run.unverified]
    hitting, amplifying = _rank_above(named, HITS, 0.0), _rank_above(named, SEAT, 1.0 + SAME)
    counts = [f"{name} ({count_times(run.read_metric(HITS))})" for name, run in hitting]
    listed = [f"{name} (SEAT factor {format_number(run.read_metric(SEAT))})" for name, run in amplifying]
    return choose_advice(
        travel=counts and name_some(counts),
        amplifies=listed and name_some(listed),
        compare=len(runs) == 1,
        other_conditions=len(runs) > 1 and len({condition_of(run.scenario) for run in runs}) == 1,
    )


def _rank_above(named: Sequence[tuple[str, Run]], metric: str, limit: float) -> list[tuple[str, Run]]:
    """Return the runs with a metric above a limit, the largest first."""
    above = [(name, run) for name, run in named if run.read_metric(metric) > limit]
    return sorted(above, key=lambda pair: -pair[1].read_metric(metric))


def show_signals(groups: Sequence[Shown], finest: int = FINEST) -> Signals:
    """Return linked pictures of the channels that some run has; of several scenarios the reader chooses one."""
    looks = {look.label: look for shown in groups for look in shown.looks}
    lines, names = [(name, COLOURS.index(look.colour), look.alpha) for name, look in looks.items()], list(looks)
    time = {shown.scenario: max((np.asarray(run["time"]) for run in shown.runs), key=len) for shown in groups}
    panels = []
    for channel in CHANNELS:
        values = {shown.scenario: _read(shown, channel, names, len(time[shown.scenario])) for shown in groups}
        known = [[each for each in part if each is not None] for part in values.values()]
        # One that never changes, such as the temperature of most dampers, is a setting and no signal.
        if any(float(np.nanmax(line)) > float(np.nanmin(line)) for part in known for line in part):
            panels.append(Panel(channel, UNITS[channel], values))
    caption = "The list above the pictures has every scenario." if len(groups) > 1 else "All runs over time."
    omitted = next((shown.omission for shown in groups if shown.omission), "")
    return pack_signals(f"{caption}{omitted}", lines, time, panels, finest)


def _read(shown: Shown, channel: str, names: Sequence[str], length: int) -> list[Array | None]:
    """Return a channel of each named run, filled up with NaN to a length; None where there is none."""
    runs = {look.label: run for look, run in zip(shown.looks, shown.runs, strict=True)}
    found: list[Array | None] = []
    for run in map(runs.get, names):
        values = np.asarray(run[channel]) if run is not None and channel in run.history.channels else np.full(1, np.nan)
        known = np.isfinite(values).any()
        found.append(np.pad(values, (0, length - len(values)), constant_values=np.nan) if known else None)
    return found


def _tabulate_figures(runs: Sequence[Run]) -> list[Table]:
    """Return every figure of one run, or the figures of several side by side."""
    if len(runs) == 1:
        figures = runs[0].metrics.values()
        every = [(format_sentence(x.meaning).rstrip("."), format_quantity(x.value, x.unit)) for x in figures]
        return show_table("run", every)
    units = {name: each.unit for run in reversed(runs) for name, each in run.metrics.items()}
    shown = {name: describe_channel(words, units[name]) for name, words in SHORT.items() if name in units}
    rows = []
    for name, run in zip(label_runs(runs), runs, strict=True):
        values = ((metric, each.factor * run.read_metric(metric)) for metric, each in shown.items())
        # End stops are counted.
        texts = (f"{x:.0f}" if metric == HITS and np.isfinite(x) else format_number(x) for metric, x in values)
        rows.append((name, *texts))
    best, several = find_best(runs), len({condition_of(run.scenario) for run in runs}) > 1
    bold = f" In bold: the most comfortable{' of each condition' * several}." if best else ""
    mark = f" {UNVERIFIED}" if any(run.unverified for run in runs) else ""
    head = ["run", *(each.axis for each in shown.values())]
    return tabulate(f"Figures of each run; summary.csv has more.{bold}{mark}", head, rows, 1, best)
