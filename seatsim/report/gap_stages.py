"""The gap of a diagnosis on its way from the nominal simulation to the noise floor, overall, by channel and by run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from seatsim.diagnosis.result import CalibratedParameter, Diagnosis
from seatsim.plots.diagnosis.answer import STAGES, Key, read_gap, select_stages
from seatsim.plots.labels import format_number, format_percent, format_unit
from seatsim.report.blocks import Block, Text, show_pictures, tabulate
from seatsim.report.formatting import format_noise, format_setting, say_noise

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EXPLAINED = "Refitted is the nominal scenario with its parameters moved inside their tolerance."


def show_gaps(diagnosis: Diagnosis, figures: Mapping[str, Figure]) -> list[Block]:
    """Return picture and tables of the gaps by channel and by run, and of the refitted parameters."""
    gap, keys = diagnosis.gap, select_stages(diagnosis)
    held = ", ".join(diagnosis.held_out) or "all runs"
    rows = [_make_row(diagnosis, name, keys) for name in ("overall", *gap.before.channels)]
    head = ["channel", *(STAGES[key].label for key in keys), "shrinks by"]
    blocks = [Text(f"{_describe_shrink(diagnosis)} {EXPLAINED}"), *show_pictures(figures, "gaps")]
    blocks += tabulate(f"Gaps on {held}", head, rows, 1, [0])
    if len(gap.by_run) > 1:
        lines = [
            [each.run, *(_format_gap(key, getattr(each, key).overall) for key in keys), format_percent(each.shrink)]
            for each in gap.by_run
        ]
        strong = [k for k, each in enumerate(gap.by_run) if each.run in diagnosis.held_out]
        blocks += tabulate("Gaps of every run, overall; held out in bold", ["run", *head[1:]], lines, 1, strong)
    return [*blocks, *_list_parameters(diagnosis.parameters)]


def _make_row(diagnosis: Diagnosis, name: str, keys: Sequence[Key]) -> list[str]:
    gap = diagnosis.gap
    before, after = read_gap(gap, "before", name), read_gap(gap, "after", name)
    change = 1 - after / before if after is not None and before else None
    if name == "overall" and math.isfinite(gap.shrink):
        change = gap.shrink
    gaps = [_format_gap(key, read_gap(gap, key, name)) for key in keys]
    return [name.replace("_", " "), *gaps, format_percent(change)]


def _format_gap(key: Key, gap: float | None) -> str:
    return format_noise(gap) if key == "floor" else format_percent(gap)


def _describe_shrink(diagnosis: Diagnosis) -> str:
    gap = diagnosis.gap
    if not diagnosis.selected or not math.isfinite(gap.shrink):
        before, after = format_percent(gap.before.overall), format_percent(gap.calibrated.overall)
        return f"Refitting alone takes the gap from {before} to {after}; {say_noise(gap.floor.overall)}."
    low, high = gap.shrink_interval
    known = math.isfinite(low + high)
    between = f" (90 % interval on other runs of the kind: {format_percent(low)} to {format_percent(high)})" * known
    effects = "effect" if len(diagnosis.selected) == 1 else "effects"
    return f"The gap shrinks by {format_percent(gap.shrink)}{between} with the {effects} found."


def _list_parameters(parameters: Sequence[CalibratedParameter]) -> list[Block]:
    ranked = sorted(parameters, key=lambda each: not each.at_bound)
    rows = [
        [f"{each.name} (at its bound)" if each.at_bound else each.name, format_unit(each.unit),
         format_setting(each.nominal), format_number(each.value, 4),
         f"{format_setting(each.bound[0])} to {format_setting(each.bound[1])}"]
        for each in ranked
    ]  # fmt: skip
    strong = [k for k, each in enumerate(ranked) if each.at_bound]
    caption = "Parameters refitted within their tolerance"
    return tabulate(caption, "parameter, unit, nominal, refitted, bounds", rows, 2, strong)
