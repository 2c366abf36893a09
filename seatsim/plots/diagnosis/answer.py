"""The answer of a diagnosis in three pictures: the gaps, the blocks they lie in, the effects that may cause them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator

from seatsim.diagnosis.result import Cause, Diagnosis, Gaps
from seatsim.plots import style
from seatsim.plots.frame import FONT, Picture, draw_bars, make_frame, name_rows
from seatsim.plots.style import COLOURS, Grid
from seatsim.recordings.gap import Gap

MOST = 10
"""Causes that are shown."""
ROW = 0.27
"""Height of a row of bars in inches."""
CHOSEN, EQUIVALENT, OTHER, REST = COLOURS[0], COLOURS[4], "0.72", "0.45"
"""Colours of selected effects, of effects that explain the gap equally well, of others, of no or an unknown cause."""
TICKS = (1, 2, 5)
Key = Literal["floor", "before", "calibrated", "after"]


class Stage(NamedTuple):
    """A gap of the diagnosis: its field in `Gaps`, what it is called, and its marker and colour."""

    key: Key
    words: str
    marker: str
    colour: str


STAGES = (
    Stage("floor", "noise floor", "|", "0.35"),
    Stage("before", "nominal", "o", COLOURS[1]),
    Stage("calibrated", "refitted", "D", COLOURS[2]),
    Stage("after", "with effects", "s", COLOURS[0]),
)


def select_stages(diagnosis: Diagnosis) -> list[Stage]:
    """Return the gaps that are shown: without effects, `after` would repeat the refit alone."""
    return [stage for stage in STAGES if stage.key != "after" or diagnosis.selected]


def read_gap(gaps: Gaps, key: Key, channel: str) -> float | None:
    """Return the gap of a channel, or of all ("overall"), over the signal's standard deviation; None if unknown."""
    figures = {"floor": gaps.floor, "before": gaps.before, "calibrated": gaps.calibrated, "after": gaps.after}[key]
    return figures.overall if channel == "overall" else figures.channels.get(channel)


def plot_gaps(diagnosis: Diagnosis) -> Picture | None:
    """Return the gap of each channel on its way from the nominal simulation to the noise floor."""
    channels = list(diagnosis.gap.before.channels)
    if not channels:
        return None
    names, stages = ["overall", *channels], select_stages(diagnosis)
    rows = [[read_gap(diagnosis.gap, stage.key, name) or 0.0 for stage in stages] for name in names]
    figure = _draw_gaps(names, stages, rows)
    return Picture("Gap of each channel, on a logarithmic scale", "Held-out runs. Left is better.", figure)


def plot_gap(found: Gap) -> Figure:
    """Return the gap of each channel beside its noise floor."""
    floor = [found.floor.overall, *(found.floor.channels[name] for name in found.channels)]
    rows = list(zip(floor, [found.overall, *found.channels.values()], strict=True))
    return _draw_gaps(["overall", *found.channels], [STAGES[0], STAGES[1]._replace(words="gap")], rows)


def _draw_gaps(names: Sequence[str], stages: Sequence[Stage], rows: Sequence[Sequence[float]]) -> Figure:
    """Return a figure with the gaps of each name, one for each stage."""
    page = make_frame(Grid((ROW * len(names) + 0.15,), left=1.95, top=0.4, bottom=0.55))
    axes = page.rows[0][0]
    name_rows(axes, [name.replace("_", " ") for name in names])
    axes.set_xscale("log")
    for row, values in enumerate(rows):
        _draw_stages(axes, row, [(stage, 100 * value) for stage, value in zip(stages, values, strict=True)])
    axes.axhline(0.5, color="0.8", linewidth=0.8)
    style.set_plain_log_ticks(axes.xaxis, LogLocator(subs=TICKS))
    axes.set_xlabel("gap [% of the signal's standard deviation]", fontsize=FONT)
    handles = [_make_marker(stage, stage.words) for stage in stages]
    page.figure.legend(
        handles=handles, ncols=4, loc="upper left", bbox_to_anchor=(0.02, 0.995), frameon=False, fontsize=FONT,
        columnspacing=1.2, handletextpad=0.2, borderpad=0.2, borderaxespad=0.2,
    )  # fmt: skip
    return page.figure


def plot_location(diagnosis: Diagnosis) -> Picture | None:
    """Return the shares of the gap that lie in the blocks."""
    shares = diagnosis.where
    if not shares:
        return None
    page = make_frame(Grid((ROW * len(shares) + 0.1,), left=1.15, right=0.55, top=0.1, bottom=0.55))
    axes = page.rows[0][0]
    name_rows(axes, [share.block for share in shares])
    values = [100 * share.share for share in shares]
    merged = _equivalent_blocks(diagnosis)
    colours = [
        CHOSEN if row == 0 else EQUIVALENT if share.block in merged else OTHER for row, share in enumerate(shares)
    ]
    draw_bars(axes, values, colours, [_format_percent(value) for value in values], range(len(shares)))
    axes.set_xlim(0, 100)
    axes.set_xlabel("share of the gap [%]", fontsize=FONT)
    first = shares[0]
    title = f"{_format_percent(100 * first.share)} of the gap lies in the {first.block}"
    caption = "Shares of the gap by block; they add up to 100 %."
    if diagnosis.verdict == "unknown":
        title = f"What stays unexplained lies in the {first.block}"
    elif first.block in merged and len(merged) > 1:
        title = f"The gap lies in the {' or the '.join(merged)}"
        caption += " Light blue: cannot be told from the first on this recording."
    return Picture(title, caption, page.figure)


def plot_ranking(diagnosis: Diagnosis) -> Picture | None:
    """Return how probable the first causes are, and what each alone takes off the gap."""
    causes = diagnosis.causes[:MOST]
    if not causes:
        return None
    names = [*(cause.effect for cause in causes), "none", "unknown"]
    page = make_frame(
        Grid((ROW * len(names) + 0.1,), columns=2, left=2.2, right=0.5, top=0.1, bottom=0.72, gap=(0.6, 0.0))
    )
    left, right = page.rows[0]
    colours = [_choose_colour(diagnosis, cause.effect) for cause in causes]
    _draw_probabilities(left, diagnosis, names, colours)
    _draw_shrinks(right, causes, len(names), colours)
    for axes in (left, right):
        axes.axhline(len(causes) - 0.5, color="0.8", linewidth=0.8)
    for label, name in zip(left.get_yticklabels(), names, strict=True):
        label.set_fontweight("bold" if name in diagnosis.selected else "normal")
    equivalent = " Light blue: explain the gap as well." if EQUIVALENT in colours else ""
    caption = f"Bold and blue: selected.{equivalent} Probabilities are of being at work: two can both be near 100 %."
    return Picture(_make_headline(diagnosis), caption, page.figure)


def _draw_probabilities(axes: Axes, diagnosis: Diagnosis, names: Sequence[str], colours: list[str]) -> None:
    name_rows(axes, names)
    shown = [cause.probability for cause in diagnosis.causes[:MOST]]
    values = [100 * p for p in (*shown, diagnosis.probability_none, diagnosis.probability_unknown)]
    draw_bars(axes, values, [*colours, REST, REST], [_format_percent(value) for value in values], range(len(names)))
    axes.set_xlim(0, 100)
    axes.set_xlabel("probability [%]", fontsize=FONT)


def _draw_shrinks(axes: Axes, causes: Sequence[Cause], rows: int, colours: list[str]) -> None:
    name_rows(axes, [""] * rows)
    values = [100 * cause.shrink if np.isfinite(cause.shrink) else 0.0 for cause in causes]
    draw_bars(axes, values, colours, [_format_percent(value) for value in values], range(len(causes)))
    axes.set_xlim(min(0.0, *values) * 1.1, max(10.0, *values))
    axes.set_xlabel("alone takes off the\nrefitted gap [%]", fontsize=FONT)


def _find_equivalent(diagnosis: Diagnosis) -> list[str]:
    """Return the effects in a group with a selected one, which this recording cannot tell from it."""
    groups = [group for group in diagnosis.indistinguishable if set(group) & set(diagnosis.selected)]
    return [name for group in groups for name in group]


def _equivalent_blocks(diagnosis: Diagnosis) -> list[str]:
    """Return the blocks of those effects, in the order of their shares."""
    found = {name.partition(".")[0] for name in _find_equivalent(diagnosis)}
    return [share.block for share in diagnosis.where if share.block in found]


def _choose_colour(diagnosis: Diagnosis, effect: str) -> str:
    if effect in diagnosis.selected:
        return CHOSEN
    return EQUIVALENT if effect in _find_equivalent(diagnosis) else OTHER


def _make_headline(diagnosis: Diagnosis) -> str:
    first, *_ = diagnosis.causes
    equivalent = _find_equivalent(diagnosis)
    if equivalent:
        likely = [cause for cause in diagnosis.causes if cause.effect in equivalent]
        return " or ".join(f"{cause.effect} {_format_percent(100 * cause.probability)}" for cause in likely)
    if diagnosis.verdict == "unknown":
        return f"Unknown cause: {_format_percent(100 * diagnosis.probability_unknown)} probable"
    chosen = [cause for cause in diagnosis.causes if cause.effect in diagnosis.selected] or [first]
    named = ", ".join(f"{cause.effect} {_format_percent(100 * cause.probability)}" for cause in chosen)
    others = [cause for cause in diagnosis.causes if cause not in chosen]
    return f"{named}; next {others[0].effect} {_format_percent(100 * others[0].probability)}" if others else named


def _draw_stages(axes: Axes, row: int, points: Sequence[tuple[Stage, float]]) -> None:
    """Draw the gaps of one channel in per cent, joined by a line; one of zero has no place on a logarithmic scale."""
    known = [value for _, value in points if value > 0]
    if known:
        axes.plot([min(known), max(known)], [row, row], color="0.8", linewidth=1.5, zorder=1)
    for stage, value in points:
        if value > 0:
            look = _make_marker(stage, "")
            look.set_data([value], [row])
            axes.add_line(look)
    axes.update_datalim([(value, row) for value in known])
    axes.autoscale_view(scaley=False)


def _make_marker(stage: Stage, words: str) -> Line2D:
    marker, colour = stage.marker, stage.colour
    # Markers of one area look unequal in size; the refit is hollow, so that what lies behind it is seen.
    size = {"|": 13.0, "o": 8.0, "D": 6.0, "s": 6.5}[marker]
    hollow = "white" if marker == "D" else colour
    return Line2D(
        [], [], linestyle="", marker=marker, markersize=size, markeredgecolor=colour, markerfacecolor=hollow,
        markeredgewidth=2.2 if marker in "|D" else 1.0, label=words, zorder=3,
    )  # fmt: skip


def _format_percent(value: float) -> str:
    return "< 1 %" if 0 < value < 0.95 else f"{value:.0f} %"
