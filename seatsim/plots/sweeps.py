"""The figure of a sweep: comfort against travel."""

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
from seatsim.schema.printing import Quantity, describe_channel, format_number, format_unit
from seatsim.simulation.naming import name_key
from seatsim.sweeps.parts import SweepRows

ROAD = "excitation."
"""How the keys of the excitation begin; the first of them with few values gives each value a panel of its own."""
MOST_PANELS = 6
_MOST_GROUPS = 7
_FRONT = Entry("Pareto front", "black", width=1.2)


def describe_column(name: str, units: Mapping[str, str]) -> Quantity:
    """Return how a key, by its name, or a metric, in words, is shown."""
    return describe_metric(name) if name in METRICS else describe_channel("", units.get(name, ""))._replace(words=name)


def format_level(value: object) -> str:
    """Return the value of a key as text."""
    return min(f"{value:g}", format_number(value, 4), key=len) if isinstance(value, float) else str(value)


def _state(rows: SweepRows, key: str, value: object) -> str:
    """Return the value of a key with its unit."""
    return f"{format_level(value)} {format_unit(rows.units.get(key, ''))}".removesuffix("-").strip()


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
        parts = [(f"{name_key(road)} {_state(rows, road, value)}", part) for value, part in shown.groupby(road)]
    values = [] if colour is None else sorted(shown[colour].unique())
    names = [_state(rows, str(colour), value) for value in values] or ["a run"]
    looks = [Entry(name, COLOURS[k], "none", mark="o") for k, name in enumerate(names)]
    said = "" if colour in (None, "variant") else f" The colours are values of the {name_key(colour)}."
    columns = min(2, len(parts))
    grid = Grid((3.2 if columns == 1 else 2.0,) * -(-len(parts) // columns), columns, top=0.3, gap=(0.7, 0.85))
    note = f"Under the same conditions, lower left is better.{style.OWN_SCALES * (len(parts) > 1)}{said}"
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
            front = _find_front(travel, comfort)
            # Between two runs of it no other is known to be better than the left one; behind the dots it hides none.
            style.draw_line(axes, 1e3 * travel[front], comfort[front], _FRONT).set(drawstyle="steps-post", zorder=0.9)
        style.set_title(axes, f"{title[:1].upper()}{title[1:]}")
        axes.set(xlabel=describe_metric(TRAVEL).axis, ylabel=describe_metric(COMFORT).axis)
    return page.figure


def _find_front(travel: Array, comfort: Array) -> NDArray[np.intp]:
    """Return the indices of the runs that no other is better than in both, by rising travel."""
    order = np.lexsort((comfort, travel))
    best = np.minimum.accumulate(comfort[order])
    return np.asarray(order[np.concatenate([[True], comfort[order][1:] < best[:-1]])], np.intp)
