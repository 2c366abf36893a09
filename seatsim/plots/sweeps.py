"""Figures of a sweep: what matters most, and comfort against travel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from seatsim.metrics.table import COMFORT, METRICS, TRAVEL
from seatsim.plots import style
from seatsim.plots.style import COLOURS, Entry, Grid, describe_metric
from seatsim.scenario.scenario import is_condition
from seatsim.schema.arrays import Array
from seatsim.schema.printing import Quantity, describe_channel, format_number, format_percent
from seatsim.sweeps.parts import SweepRows
from seatsim.sweeps.sensitivity import Sensitivity

ROAD = "excitation."
"""How the keys of the excitation begin; the first of them with few values gives each value a panel of its own."""
_MOST_KEYS = 14
_ROW = 0.27
"""Height of a row of bars in inches."""
MOST_PANELS = 6
_MOST_GROUPS = 7
_FRONT = Entry("Pareto front", "black", width=1.2)


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
    note = f"What is fitted to the runs explains {format_percent(found[0].explained)} of the variance.{cut}"
    alone = Entry("the parameter alone", COLOURS[0], width=8)
    legend = (alone, Entry("with its interactions, 95 % interval", "black", width=1.6))
    names = [row.key for row in rows]
    grid = Grid((_ROW * len(rows) + 0.1,), left=style.measure_names(names))
    figure, [[axes]] = style.make_page(f"What determines the {words}", note, grid, legend)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_yticks(np.arange(len(names)), [style.clean_text(name, 32) for name in names], fontsize=style.FONT)
    axes.grid(False, axis="y")
    axes.barh(range(len(rows)), [_clip(row.first) for row in rows], height=0.66, color=COLOURS[0], zorder=2)
    for k, row in enumerate(rows):
        axes.plot([_clip(row.total_low), _clip(row.total_high)], [k, k], color="black", linewidth=1.6, zorder=3)
    axes.set(xlim=(0, 100), xlabel="share of the variance [%]")
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
    said = "" if colour in (None, "variant") else f" The colours are values of {colour}."
    columns = min(2, len(parts))
    grid = Grid((3.2 if columns == 1 else 2.0,) * -(-len(parts) // columns), columns, top=0.3, gap=(0.7, 0.85))
    note = f"Lower left is better.{style.OWN_SCALES * (len(parts) > 1)}{said}"
    # Runs under different conditions, as with drivers of another mass, are no rivals.
    has_front = not any(is_condition(key) for key in order if key != road)
    page = style.make_page("Comfort against travel", note, grid, [*looks, *[_FRONT] * has_front])
    for axes, (title, part) in zip(page.list_panels(len(parts)), parts, strict=True):
        groups = [part] if colour is None else [part[part[colour] == value] for value in values]
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


def _clip(share: float) -> float:
    """Return a share in per cent, within 0 and 100."""
    return 100.0 * min(1.0, max(0.0, share)) if np.isfinite(share) else 0.0
