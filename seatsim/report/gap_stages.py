"""The gap of a diagnosis on its way from the nominal simulation to the noise floor, overall, by channel and by run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

from seatsim.diagnosis.result import CalibratedParameter, Diagnosis, Gaps
from seatsim.plots.labels import format_unit
from seatsim.report.blocks import Bar, Bars, Block, Table, Text
from seatsim.report.formatting import format_noise, format_number, format_percent, format_setting, say_noise

Stage = Literal["before", "calibrated", "after", "floor"]
HEADINGS: dict[Stage, str] = {
    "before": "nominal", "calibrated": "refitted", "after": "with effects", "floor": "noise floor",
}  # fmt: skip
EXPLAINED = (
    "Gap: RMS of measured less simulated over the standard deviation of the measured signal. Refitted: the nominal"
    " scenario with its parameters moved inside their tolerance."
)


def show_gaps(diagnosis: Diagnosis) -> list[Block]:
    """Return tables of the gaps by channel and by run, and of the refitted parameters."""
    gap = diagnosis.gap
    names = ["overall", *gap.before.channels]
    keys = list_stages(diagnosis)
    held = ", ".join(diagnosis.held_out) or "all runs"
    rows = [_make_row(diagnosis, name, keys) for name in names]
    head = ["channel", *(HEADINGS[key] for key in keys), "shrinks by"]
    blocks: list[Block] = [Text(_describe_shrink(diagnosis)), Text(EXPLAINED)]
    blocks += [Table(f"Gaps on {held}", head, rows, 1, [0]), _draw_stages(diagnosis, keys)]
    if len(diagnosis.gap.by_run) > 1:
        lines = [
            [each.run, *(_format_gap(key, getattr(each, key).overall) for key in keys), format_percent(each.shrink)]
            for each in diagnosis.gap.by_run
        ]
        strong = [k for k, each in enumerate(diagnosis.gap.by_run) if each.run in diagnosis.held_out]
        blocks.append(Table("Gaps of every run, overall; held out in bold", ["run", *head[1:]], lines, 1, strong))
    if diagnosis.parameters:
        blocks.append(_list_parameters(diagnosis.parameters))
    return blocks


def list_stages(diagnosis: Diagnosis) -> list[Stage]:
    """Return the gaps that are shown: without effects, the last scenario is the refitted one."""
    return ["before", "calibrated", *(["after"] if diagnosis.selected else []), "floor"]  # type: ignore[list-item]


def read_gap(gaps: Gaps, key: Stage, channel: str) -> float | None:
    """Return the gap of a channel, or of all ("overall"); None where it is not known."""
    figures = {"floor": gaps.floor, "before": gaps.before, "calibrated": gaps.calibrated, "after": gaps.after}[key]
    return figures.overall if channel == "overall" else figures.channels.get(channel)


def _make_row(diagnosis: Diagnosis, name: str, keys: Sequence[Stage]) -> list[str]:
    gap = diagnosis.gap
    before, after = read_gap(gap, "before", name), read_gap(gap, "after", name)
    change = 1 - after / before if after is not None and before else None
    if name == "overall" and math.isfinite(gap.shrink):
        change = gap.shrink
    return [
        name.replace("_", " "),
        *(_format_gap(key, read_gap(gap, key, name)) for key in keys),
        format_percent(change),
    ]


def _format_gap(key: Stage, gap: float | None) -> str:
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


def _draw_stages(diagnosis: Diagnosis, keys: Sequence[Stage]) -> Bars:
    values = [(key, read_gap(diagnosis.gap, key, "overall") or 0.0) for key in keys]
    known = [(key, value if math.isfinite(value) else 0.0) for key, value in values]
    most = max((value for _, value in known), default=0.0) or 1.0
    looks = {"before": "high", "after": "chosen", "calibrated": "alike", "floor": "plain"}
    bars = [
        Bar(HEADINGS[key], 0.0, round(100 * value / most, 2), _format_gap(key, value), looks[key])
        for key, value in known
    ]
    return Bars("Overall gap, step by step", "On the run held out; shorter is better.", "scenario", "gap", bars)


def _list_parameters(parameters: Sequence[CalibratedParameter]) -> Table:
    ranked = sorted(parameters, key=lambda each: not each.at_bound)
    rows = [
        [each.name, format_unit(each.unit), "at its bound" if each.at_bound else "within its bounds",
         format_setting(each.nominal), format_number(each.value, 4),
         f"{format_setting(each.bound[0])} to {format_setting(each.bound[1])}"]
        for each in ranked
    ]  # fmt: skip
    strong = [k for k, each in enumerate(ranked) if each.at_bound]
    caption = "Parameters refitted within their tolerance; in bold those that the refit pushes to a bound"
    return Table(caption, ["parameter", "unit", "refit", "nominal", "refitted", "bounds"], rows, 3, strong)
