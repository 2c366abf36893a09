"""The answer of a diagnosis in three pictures: the gaps, the blocks they lie in, the effects that may cause them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from matplotlib.figure import Figure

from seatsim.diagnosis.result import Diagnosis, Gaps, RunGaps
from seatsim.plots import style
from seatsim.plots.style import COLOURS, Entry, Grid, draw_bars, make_rows
from seatsim.recordings.gap import Gap, GapFigures
from seatsim.schema.text import join_names

MOST = 10
"""Causes that are shown."""
LIKELY = 0.01
"""Probability from which on an effect has a row of its own."""
_CHOSEN, _EQUIVALENT, OTHER, REST = COLOURS[0], COLOURS[4], "0.72", "0.45"
"""Colours of selected effects, of effects that explain the gap equally well, of others, of no or an unknown cause."""
SMALLEST = 1e-4
"""Gap below which none is drawn: a logarithmic scale has no zero."""
Key = Literal["floor", "before", "calibrated", "after"]
STAGES: dict[Key, Entry] = {
    "floor": Entry("noise floor", "black", "none", mark="|", hollow=True),
    "before": Entry("nominal", COLOURS[1], "none", mark="o"),
    "calibrated": Entry("refitted", COLOURS[2], "none", mark="D", hollow=True),
    "after": Entry("with effects", COLOURS[0], "none", mark="s"),
}
"""How each gap of a diagnosis is called and marked."""
_SIZES = {"|": 13, "o": 8, "D": 10, "s": 5}
"""Sizes of the marks in points: of marks at one place, each is seen."""


def select_stages(diagnosis: Diagnosis) -> list[Key]:
    """Return the gaps that are shown, in the order of the diagnosis; without effects `after` is that of the refit."""
    after: list[Key] = ["after"] if diagnosis.selected else []
    return ["before", "calibrated", *after, "floor"]


def find_last(diagnosis: Diagnosis) -> Entry:
    """Return what the simulation of `augmented.yaml` is called, and its mark; without effects it is the refitted."""
    return STAGES["after" if diagnosis.selected else "calibrated"]


def read_gap(gaps: Gaps | RunGaps, key: Key, channel: str) -> float | None:
    """Return the gap of a channel, or of all ("overall"), over the signal's standard deviation; None if unknown."""
    figures: GapFigures = getattr(gaps, key)
    return figures.overall if channel == "overall" else figures.channels.get(channel)


def plot_gaps(diagnosis: Diagnosis) -> Figure | None:
    """Return the gap of each channel on its way from the nominal simulation to the noise floor."""
    channels = list(diagnosis.gap.before.channels)
    if not channels:
        return None
    names, keys = ["overall", *channels], select_stages(diagnosis)
    rows = [[read_gap(diagnosis.gap, key, name) or 0.0 for key in keys] for name in names]
    stages = [STAGES[key] for key in keys]
    return _draw_gaps("Gap of each channel, before and after", names, stages, rows, " of held-out runs")


def plot_gap(found: Gap) -> Figure:
    """Return the gap of each channel beside its noise floor."""
    floor = [found.floor.overall, *(found.floor.channels[name] for name in found.channels)]
    rows = list(zip([found.overall, *found.channels.values()], floor, strict=True))
    stages = [STAGES["before"]._replace(label="gap"), STAGES["floor"]]
    return _draw_gaps("Gap of each channel", ["overall", *found.channels], stages, rows)


def _draw_gaps(
    title: str, names: Sequence[str], stages: Sequence[Entry], rows: Sequence[Sequence[float]], where: str = ""
) -> Figure:
    """Return a figure with the gaps of each name, one for each stage."""
    known = [100 * value for row in rows for value in row if np.isfinite(value) and value > SMALLEST]
    # A noise floor that nobody stated has no mark, and none in the legend.
    columns = zip(stages, zip(*rows, strict=True), strict=True)
    legend = [stage for stage, values in columns if max(np.nan_to_num(values)) > 0]
    shown = [name.replace("_", " ") for name in names]
    note = f"RMS of measured less simulated over the spread of the signal{where}; further left is better."
    figure, [axes] = make_rows(title, note, shown, legend, [0])
    style.scale_log(axes, "x", min(known, default=1.0) / 1.4, max(known, default=1.0) * 1.4)
    for row, values in enumerate(rows):
        seen = [(stage, 100 * value) for stage, value in zip(stages, values, strict=True) if value > SMALLEST]
        if seen:
            axes.plot([min(v for _, v in seen), max(v for _, v in seen)], [row, row], color="0.8", linewidth=1.5)
        for stage, value in seen:
            style.draw_line(axes, [value], [row], stage).set(markersize=_SIZES[stage.mark], zorder=3)
    if not known:
        axes.text(0.5, 0.5, f"every gap is below {100 * SMALLEST:g} %", transform=axes.transAxes, ha="center")
    axes.axhline(0.5, color="0.8", linewidth=0.8)
    axes.set_xlabel("gap [%]")
    return figure


def plot_location(diagnosis: Diagnosis) -> Figure | None:
    """Return the shares of the gap that lie in the blocks."""
    shares = diagnosis.where
    if not shares:
        return None
    alike = {name.partition(".")[0] for name in _find_equivalent(diagnosis)}
    merged = [share.block for share in shares if share.block in alike]
    first, note = shares[0], "The shares add up to 100 %."
    title = f"{_format_percent(100 * first.share)} of the gap lies in the {first.block}"
    if diagnosis.verdict == "unknown":
        title = f"What stays unexplained lies in the {first.block}"
    elif first.block in alike and len(merged) > 1:
        title = f"The gap lies in the {' or the '.join(merged)}"
        note += " Light blue: cannot be told from the first on this recording."
    names, values = [share.block for share in shares], [100 * share.share for share in shares]
    figure, [axes] = make_rows(title, note, names, [], [])
    colours = [_CHOSEN, *(_EQUIVALENT if share.block in alike else OTHER for share in shares[1:])]
    draw_bars(axes, values, colours, list(map(_format_percent, values)))
    axes.set(xlim=(0, 100), xticks=[0, 50, 100], xlabel="share of the gap [%]")
    return figure


def plot_ranking(diagnosis: Diagnosis) -> Figure | None:
    """Return how probable the first causes are, and what each alone takes off the gap; equal rows are one."""
    if not diagnosis.causes:
        return None
    names, probabilities, shrinks, colours, texts = map(list, zip(*_list_rows(diagnosis), strict=True))
    alike = [name for name, colour in zip(names, colours, strict=True) if colour in (_CHOSEN, _EQUIVALENT)]
    found = join_names(alike, "or" if _EQUIVALENT in colours else "and") if diagnosis.selected else "none is named"
    title = f"Effects at work: {found}"
    equivalent = " Light blue: explain the gap as well." if _EQUIVALENT in colours else ""
    note = (
        f"Bold and blue: the answer of the diagnosis.{equivalent} Left: how probable it is that an effect is at work;"
        " two effects can both be near 100 %."
    )
    strong = [k for k, colour in enumerate(colours) if colour == _CHOSEN]
    grid = Grid((), 2, right=0.45, bottom=0.7, gap=(0.7, 0.0))
    figure, [left, right] = make_rows(title, note, names, [], strong, grid)
    for axes in (left, right):
        axes.axhline(len(names) - 2.5, color="0.8", linewidth=0.8)
    draw_bars(left, probabilities, colours, texts)
    left.set(xlim=(0, 100), xticks=[0, 50, 100], xlabel="probability [%]")
    draw_bars(right, shrinks, colours, [_format_percent(each) if np.isfinite(each) else "" for each in shrinks])
    known = np.nan_to_num(shrinks)
    right.set(xlim=(min(0.0, *known) * 1.5, 100), xlabel="refitted gap that the\neffect alone removes [%]")
    return figure


def _list_rows(diagnosis: Diagnosis) -> list[tuple[str, float, float, str, str]]:
    """Return of each row its name, probability and shrink in per cent, the colour, and the text of the probability."""
    looks = dict.fromkeys(_find_equivalent(diagnosis), _EQUIVALENT) | dict.fromkeys(diagnosis.selected, _CHOSEN)
    likely = [each for each in diagnosis.causes if each.effect in diagnosis.selected or each.probability >= LIKELY]
    shown = likely[:MOST]
    rows = [(each.effect, each.probability, each.shrink, looks.get(each.effect, OTHER), "") for each in shown]
    if rest := [each.probability for each in diagnosis.causes if each not in shown]:
        most = f"at most {_format_percent(100 * max(rest))}" if max(rest) >= LIKELY else f"below {100 * LIKELY:g} %"
        rows.append((f"{len(rest)} other effect{'s' * (len(rest) > 1)}", max(rest), np.nan, OTHER, most))
    ends = {"no effect at all": diagnosis.probability_none, "another cause": diagnosis.probability_unknown}
    answer = "" if diagnosis.selected else max(ends, key=lambda name: ends[name])
    rows += [(name, value, np.nan, _CHOSEN if name == answer else REST, "") for name, value in ends.items()]
    return [
        (name, 100 * p, 100 * shrink, look, text or _format_percent(100 * p)) for name, p, shrink, look, text in rows
    ]


def _find_equivalent(diagnosis: Diagnosis) -> list[str]:
    """Return the effects in a group with a selected one, which this recording cannot tell from it."""
    groups = [group for group in diagnosis.indistinguishable if set(group) & set(diagnosis.selected)]
    return [name for group in groups for name in group]


def _format_percent(value: float) -> str:
    return "< 1 %" if 0 < value < 0.95 else f"{value:.0f} %"
