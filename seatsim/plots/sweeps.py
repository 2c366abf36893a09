"""Figures of a sweep: what matters most, how far keys move a metric, comfort against travel, means over two keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import fill

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure
from numpy.typing import NDArray

from seatsim.metrics.table import COMFORT, METRICS, TRAVEL
from seatsim.plots import style
from seatsim.plots.style import COLOURS, DARK, ROW, Entry, Grid, clean_text, describe_metric
from seatsim.scenario.scenario import is_condition
from seatsim.schema.arrays import Array
from seatsim.schema.printing import Quantity, describe_channel, format_number, format_percent, format_unit
from seatsim.sweeps.parts import SweepRows, is_number
from seatsim.sweeps.sensitivity import Sensitivity

ROAD = "excitation."
"""How the keys of the excitation begin; the first of them with few values gives each value a panel of its own."""
_MOST_KEYS = 14
MOST_PANELS = 6
_MOST_POINTS = 4000
"""Runs that are drawn in all panels; more of them hide each other."""
_MOST_GROUPS = 7
_MOST_LEVELS = 8
"""Values of a key that have rows or columns of their own; numbers with more are taken in `BINS` of as many runs."""
BINS = 5
_FRONT = Entry("Pareto front", "black", width=1.2)
_BESIDE = "alone / with"
"""Head of the two figures beside each bar."""


def describe_column(name: str, units: Mapping[str, str]) -> Quantity:
    """Return how a key, by its name, or a metric, in words, is shown."""
    return describe_metric(name) if name in METRICS else describe_channel("", units.get(name, ""))._replace(words=name)


def format_level(value: object) -> str:
    """Return the value of a key as text."""
    return format_number(value, 4) if isinstance(value, float) else str(value)


def plot_shares(found: Sequence[Sensitivity], words: str) -> Figure:
    """Return the shares of the variance of a metric that its keys explain, alone and with others."""
    rows = found[:_MOST_KEYS]
    cut = f" The {_MOST_KEYS} strongest of {len(found)} parameters." if len(found) > _MOST_KEYS else ""
    note = (
        f"Figures: the parameter alone / with its interactions.{cut} What is fitted to the runs explains"
        f" {format_percent(found[0].explained)} of the variance; the rest is in no bar."
    )
    alone = Entry("the parameter alone", COLOURS[0], width=8)
    legend = (alone, Entry("with its interactions, 95 % interval", "black", width=1.6))
    texts = [f"{format_percent(row.first)} / {format_percent(row.total)}" for row in rows]
    grid = Grid((), right=0.25 + style.LETTER * max(map(len, (*texts, _BESIDE))))
    title, names = f"What determines the {words}", [row.key for row in rows]
    figure, [axes] = style.make_rows(title, note, names, legend, [0], grid)
    style.draw_bars(axes, [_clip(row.first) for row in rows], [COLOURS[0]] * len(rows), [""] * len(rows))
    for k, (row, text) in enumerate(zip(rows, texts, strict=True)):
        ends = [_clip(row.total_low), _clip(row.total_high)]
        axes.plot(ends, [k, k], color="black", linewidth=1.6, zorder=3)
        axes.annotate(text, (1.02, k), xycoords=("axes fraction", "data"), va="center", fontsize=style.FONT)
    axes.annotate(_BESIDE, (1.02, 1.0), xycoords="axes fraction", va="bottom", fontsize=style.FONT, color=DARK)
    axes.set(xlim=(0, 100), xlabel="share of the variance [%]")
    return figure


def plot_tornado(found: Sequence[Sensitivity], rows: SweepRows) -> Figure:
    """Return from where to where the mean of a metric goes between a low and a high value of each key."""
    shown, strongest = describe_column(found[0].metric, rows.units), found[:_MOST_KEYS]
    note = "Where a parameter is a text: at the values with the smallest and with the largest mean."
    high = Entry("mean at its 95 % quantile", COLOURS[0], "none", mark="o")
    legend = [high._replace(label="mean at its 5 % quantile", hollow=True), high]
    grid = Grid((2 * ROW * len(strongest) + 0.1,), left=0.3, right=0.3)
    figure, [[axes]] = style.make_page(f"How far each parameter moves the mean {shown.words}", note, grid, legend)
    style.name_rows(axes, [""] * len(strongest))
    for k, row in enumerate(strongest):
        unit = format_unit(rows.units.get(row.key, "")).removesuffix("-")
        name = f"{row.key}: {format_level(row.low)} to {format_level(row.high)} {unit}".strip()
        ends = [shown.factor * row.at_low, shown.factor * row.at_high]
        axes.plot(ends, [k, k], color=COLOURS[0], linewidth=4, solid_capstyle="butt", zorder=2)
        for end, face in zip(ends, ("1.0", COLOURS[0]), strict=True):
            axes.plot([end], [k], "o", markersize=7, markeredgecolor=COLOURS[0], markerfacecolor=face, zorder=3)
        axes.annotate(clean_text(name, 64), (0.0, k - 0.33), xycoords=("axes fraction", "data"), fontsize=style.FONT)
    axes.margins(x=0.08)
    axes.set_xlabel(f"mean {shown.axis}")
    return figure


def plot_comfort(rows: SweepRows, order: Sequence[str]) -> Figure | None:
    """Return comfort over travel, a panel for each road, coloured by what matters most of the other keys.

    Args:
        rows: the rows of the sweep.
        order: its varied keys, what matters most first.
    """
    if not {COMFORT, TRAVEL} <= set(rows.metrics):
        return None
    shown = rows.usable.dropna(subset=[COMFORT, TRAVEL])
    few = {key: shown[key].nunique() for key in order}
    road = next((key for key in order if key.startswith(ROAD) and 1 < few[key] <= MOST_PANELS), None)
    colour = next((key for key in order if key != road and few[key] <= _MOST_GROUPS), None)
    parts = [("", shown)]
    if road is not None:
        parts = [(f"{road.removeprefix(ROAD)} {format_level(value)}", part) for value, part in shown.groupby(road)]
    values = [] if colour is None else sorted(shown[colour].unique())
    names = [*map(format_level, values)] or ["a run"]
    looks = [Entry(name, COLOURS[k], "none", mark="o") for k, name in enumerate(names)]
    most = _MOST_POINTS // len(parts)
    drawn = sum(min(most, len(part)) for _, part in parts)
    some = f" {drawn} of {len(shown)} runs are drawn." if drawn < len(shown) else ""
    said = "" if colour in (None, "variant") else f" The colours are values of {colour}."
    columns = min(2, len(parts))
    grid = Grid((3.2 if columns == 1 else 2.0,) * -(-len(parts) // columns), columns, top=0.3, gap=(0.7, 0.85))
    note = f"Lower left is better.{style.OWN_SCALES * (len(parts) > 1)}{said}{some}"
    # Runs under different conditions, as with drivers of another mass, are no rivals.
    has_front = not any(is_condition(key) for key in order if key != road)
    page = style.make_page("Comfort against travel", note, grid, [*looks, *[_FRONT] * has_front])
    for axes, (title, part) in zip(page.list_panels(len(parts)), parts, strict=True):
        dots = part.sample(most, random_state=0) if len(part) > most else part
        groups = [dots] if colour is None else [dots[dots[colour] == value] for value in values]
        for group, look in zip(groups, looks, strict=False):
            x, y = 1e3 * group[TRAVEL], group[COMFORT]
            axes.scatter(x, y, s=14, linewidths=0, alpha=0.7, color=look.colour, rasterized=True)
        travel, comfort = (part[name].to_numpy(float) for name in (TRAVEL, COMFORT))
        if has_front:
            front = find_front(travel, comfort)
            # Between two runs of it no other is known to be better than the left one; behind the dots it hides none.
            style.draw_line(axes, 1e3 * travel[front], comfort[front], _FRONT).set(drawstyle="steps-post", zorder=0.9)
        style.set_title(axes, title)
        axes.set(xlabel=describe_metric(TRAVEL).axis, ylabel=describe_metric(COMFORT).axis)
    return page.figure


def find_front(travel: Array, comfort: Array) -> NDArray[np.intp]:
    """Return the indices of the runs that no other is better than in both, by rising travel."""
    order = np.lexsort((comfort, travel))
    best = np.minimum.accumulate(comfort[order])
    return np.asarray(order[np.concatenate([[True], comfort[order][1:] < best[:-1]])], np.intp)


def plot_means(rows: SweepRows, order: Sequence[str], metric: str) -> Figure | None:
    """Return the means of a metric over the two keys that matter most, none where fewer are varied.

    None too where one of them is a text with too many values.
    """
    keys = [key for key in order if key != "variant"][:2]
    cells = [_group(rows.usable[key]) for key in keys]
    if len(keys) < 2 or metric not in rows.metrics or any(each is None for each in cells):
        return None
    shown = describe_column(metric, rows.units)
    means = pd.DataFrame({"x": cells[0], "y": cells[1], "z": shown.factor * rows.usable[metric]})
    table = means.groupby(["y", "x"], observed=True)["z"].mean().unstack()
    values = table.to_numpy()
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    names = [str(name) for name in table.index]
    label = clean_text(describe_column(keys[1], rows.units).axis)
    height = max(1.6, 0.32 * len(names), style.LETTER * (max(map(len, label.split())) + 1))
    grid = Grid((height,), left=style.measure_names(names) + 2 * style.LINE, right=0.15, bottom=0.55)
    every = " of all variants" * ("variant" in order)
    note = f"Mean over the runs{every} of each cell, in {shown.unit}; the darker, the larger."
    figure, [[axes]] = style.make_page(f"Mean {shown.words} over {keys[0]} and {keys[1]}", note, grid)
    axes.grid(False)
    axes.pcolormesh(values, cmap=colormaps["Blues"], rasterized=True)
    for (row, column), value in np.ndenumerate(values):
        if np.isfinite(value):
            # Black and white stay so on dark paper, since the cells do.
            ink = "#fffffe" if value > low + 0.62 * (high - low) else "#000001"
            axes.text(column + 0.5, row + 0.5, format_number(value), ha="center", va="center", fontsize=9, color=ink)
    axes.set_xticks(np.arange(values.shape[1]) + 0.5, [clean_text(str(name), 12) for name in table.columns], fontsize=9)
    axes.set_yticks(np.arange(len(names)) + 0.5, [clean_text(name, 32) for name in names], fontsize=9)
    axes.set_xlabel(clean_text(describe_column(keys[0], rows.units).axis))
    axes.set_ylabel(fill(label, int(height / style.LETTER)))
    return figure


def _group(values: pd.Series) -> pd.Series | None:
    """Return the values as ordered names of cells."""
    if values.nunique() <= _MOST_LEVELS:
        names = pd.Categorical(values.map(format_level), [format_level(x) for x in sorted(values.unique())], True)
        return pd.Series(names, index=values.index)
    if not is_number(values):
        return None
    cells = pd.qcut(values, BINS, duplicates="drop")
    return cells.cat.rename_categories([f"{c.left:.3g} to {c.right:.3g}" for c in cells.cat.categories])


def _clip(share: float) -> float:
    """Return a share in per cent, within 0 and 100."""
    return 100.0 * min(1.0, max(0.0, share)) if np.isfinite(share) else 0.0
