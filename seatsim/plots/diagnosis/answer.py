"""The answer of a diagnosis in three pictures: the gaps, the blocks they lie in, the effects that may cause them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullLocator

from seatsim.diagnosis.result import Cause, Diagnosis
from seatsim.plots.diagnosis.frame import FONT, Picture, bare, bars, frame
from seatsim.plots.style import COLOURS, Grid

MOST = 10
"""Causes that are shown."""
ROW = 0.27
"""Height of a row of bars in inches."""
STAGES = (
    ("floor", "noise floor", "|", "0.35"),
    ("before", "nominal", "o", COLOURS[1]),
    ("calibrated", "refitted", "D", COLOURS[2]),
    ("after", "with effects", "s", COLOURS[0]),
)
"""Field of the gaps, its words, marker and colour."""
CHOSEN, TWIN, OTHER, REST = COLOURS[0], COLOURS[4], "0.72", "0.45"
TICKS = (1, 2, 5)


def stages(diagnosis: Diagnosis) -> list[tuple[str, str, str, str]]:
    """Return the gaps that are shown: without effects, what `after` adds is the refit alone."""
    return [stage for stage in STAGES if stage[0] != "after" or diagnosis.selected]


def gaps(diagnosis: Diagnosis) -> Picture | None:
    """Return the gap of each channel on its way from the nominal simulation to the noise floor."""
    channels = list(diagnosis.gap.before.channels)
    if not channels:
        return None
    names = ["overall", *channels]
    page = frame(Grid((ROW * len(names) + 0.15,), left=1.95, top=0.4, bottom=0.55))
    axes = page.rows[0][0]
    bare(axes, [name.replace("_", " ") for name in names])
    axes.set_xscale("log")
    for row, name in enumerate(names):
        _way(axes, row, [(look, _gap(diagnosis, stage, name)) for stage, *look in stages(diagnosis)])
    axes.axhline(0.5, color="0.8", linewidth=0.8)
    _log_percent(axes)
    axes.set_xlabel("gap [% of the signal's standard deviation]", fontsize=FONT)
    handles = [_marker(marker, colour, words) for _, words, marker, colour in stages(diagnosis)]
    page.figure.legend(
        handles=handles, ncols=4, loc="upper left", bbox_to_anchor=(0.02, 0.995), frameon=False, fontsize=FONT,
        columnspacing=1.2, handletextpad=0.2, borderpad=0.2, borderaxespad=0.2,
    )  # fmt: skip
    return Picture("Gap of each channel, on a logarithmic scale", "Held-out runs. Left is better.", page.figure)


def where(diagnosis: Diagnosis) -> Picture | None:
    """Return the shares of the gap that lie in the blocks."""
    shares = diagnosis.where
    if not shares:
        return None
    page = frame(Grid((ROW * len(shares) + 0.1,), left=1.15, right=0.55, top=0.1, bottom=0.55))
    axes = page.rows[0][0]
    bare(axes, [share.block for share in shares])
    values = [100 * share.share for share in shares]
    merged = _blocks(diagnosis)
    colours = [CHOSEN if row == 0 else TWIN if share.block in merged else OTHER for row, share in enumerate(shares)]
    bars(axes, values, colours, [_percent(value) for value in values], range(len(shares)))
    axes.set_xlim(0, 100)
    axes.set_xlabel("share of the gap [%]", fontsize=FONT)
    first = shares[0]
    title = f"{_percent(100 * first.share)} of the gap lies in the {first.block}"
    caption = "Shares of the gap by block; they add up to 100 %."
    if diagnosis.verdict == "unknown":
        title = f"What stays unexplained lies in the {first.block}"
    elif first.block in merged and len(merged) > 1:
        title = f"The gap lies in the {' or the '.join(merged)}"
        caption += " Light blue: cannot be told from the first on this recording."
    return Picture(title, caption, page.figure)


def ranking(diagnosis: Diagnosis) -> Picture | None:
    """Return how probable the first causes are, and what each alone takes off the gap."""
    causes = diagnosis.causes[:MOST]
    if not causes:
        return None
    names = [*(cause.effect for cause in causes), "none", "unknown"]
    page = frame(Grid((ROW * len(names) + 0.1,), columns=2, left=2.2, right=0.5, top=0.1, bottom=0.72, gap=(0.6, 0.0)))
    left, right = page.rows[0]
    colours = [_colour(diagnosis, cause.effect) for cause in causes]
    _probabilities(left, diagnosis, names, colours)
    _shrinks(right, causes, len(names), colours)
    for axes in (left, right):
        axes.axhline(len(causes) - 0.5, color="0.8", linewidth=0.8)
    for label, name in zip(left.get_yticklabels(), names, strict=True):
        label.set_fontweight("bold" if name in diagnosis.selected else "normal")
    twins = " Light blue: explain the gap as well." if TWIN in colours else ""
    caption = f"Bold and blue: selected.{twins} Probabilities are of being at work: two can both be near 100 %."
    return Picture(_headline(diagnosis), caption, page.figure)


def _probabilities(axes: Axes, diagnosis: Diagnosis, names: Sequence[str], colours: list[str]) -> None:
    bare(axes, names)
    shown = [cause.probability for cause in diagnosis.causes[:MOST]]
    values = [100 * p for p in (*shown, diagnosis.probability_none, diagnosis.probability_unknown)]
    bars(axes, values, [*colours, REST, REST], [_percent(value) for value in values], range(len(names)))
    axes.set_xlim(0, 100)
    axes.set_xlabel("probability [%]", fontsize=FONT)


def _shrinks(axes: Axes, causes: Sequence[Cause], rows: int, colours: list[str]) -> None:
    bare(axes, [""] * rows)
    values = [100 * cause.shrink if np.isfinite(cause.shrink) else 0.0 for cause in causes]
    bars(axes, values, colours, [_percent(value) for value in values], range(len(causes)))
    axes.set_xlim(min(0.0, *values) * 1.1, max(10.0, *values))
    axes.set_xlabel("alone takes off the\nrefitted gap [%]", fontsize=FONT)


def _twins(diagnosis: Diagnosis) -> list[str]:
    """Return the effects in a group with a selected one, which this recording cannot tell from it."""
    groups = [group for group in diagnosis.indistinguishable if set(group) & set(diagnosis.selected)]
    return [name for group in groups for name in group]


def _blocks(diagnosis: Diagnosis) -> list[str]:
    """Return the blocks of those effects, in the order of their shares."""
    found = {name.partition(".")[0] for name in _twins(diagnosis)}
    return [share.block for share in diagnosis.where if share.block in found]


def _colour(diagnosis: Diagnosis, effect: str) -> str:
    if effect in diagnosis.selected:
        return CHOSEN
    return TWIN if effect in _twins(diagnosis) else OTHER


def _headline(diagnosis: Diagnosis) -> str:
    first, *_ = diagnosis.causes
    twins = _twins(diagnosis)
    if twins:
        likely = [cause for cause in diagnosis.causes if cause.effect in twins]
        return " or ".join(f"{cause.effect} {_percent(100 * cause.probability)}" for cause in likely)
    if diagnosis.verdict == "unknown":
        return f"Unknown cause: {_percent(100 * diagnosis.probability_unknown)} probable"
    chosen = [cause for cause in diagnosis.causes if cause.effect in diagnosis.selected] or [first]
    named = ", ".join(f"{cause.effect} {_percent(100 * cause.probability)}" for cause in chosen)
    others = [cause for cause in diagnosis.causes if cause not in chosen]
    return f"{named}; next {others[0].effect} {_percent(100 * others[0].probability)}" if others else named


def _way(axes: Axes, row: int, points: list[tuple[Any, float]]) -> None:
    """Draw the gaps of one channel, joined by a line."""
    known = [value for _, value in points if value > 0]
    if known:
        axes.plot([min(known), max(known)], [row, row], color="0.8", linewidth=1.5, zorder=1)
    for (_, marker, colour), value in points:
        if value > 0:
            look = _marker(marker, colour, "")
            look.set_data([value], [row])
            axes.add_line(look)
    axes.update_datalim([(value, row) for value in known])
    axes.autoscale_view(scaley=False)


def _marker(marker: str, colour: str, words: str) -> Line2D:
    size = {"|": 13.0, "o": 8.0, "D": 6.0, "s": 6.5}[marker]
    hollow = "white" if marker == "D" else colour
    return Line2D(
        [], [], linestyle="", marker=marker, markersize=size, markeredgecolor=colour, markerfacecolor=hollow,
        markeredgewidth=2.2 if marker in "|D" else 1.0, label=words, zorder=3,
    )  # fmt: skip


def _log_percent(axes: Axes) -> None:
    axes.xaxis.set_major_locator(LogLocator(subs=TICKS))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_locator(NullLocator())


def _gap(diagnosis: Diagnosis, stage: str, name: str) -> float:
    values: dict[str, Any] = getattr(diagnosis.gap, stage)
    value = values.get("overall") if name == "overall" else values.get("channels", {}).get(name)
    return 100 * float(value) if value is not None else 0.0


def _percent(value: float) -> str:
    return "< 1 %" if 0 < value < 0.95 else f"{value:.0f} %"
