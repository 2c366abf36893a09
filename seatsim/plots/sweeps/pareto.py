"""Comfort against travel of all runs: a panel for each floor, colour and marker by key, the Pareto front drawn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from numpy.typing import NDArray

from seatsim.plots.frame import WIDE, Picture, Quantity, make_frame
from seatsim.plots.labels import LONGEST_TITLE, clean_text
from seatsim.plots.style import COLOURS, DARK, Entry, Grid, add_axes_beside
from seatsim.plots.sweeps.naming import SCREEN, describe_column, format_level
from seatsim.sweeps.statistics.inputs import SweepRows, is_number

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
COMFORT, TRAVEL = "driver_acceleration_weighted", "suspension_displacement_rms"
MOST_POINTS = 5000
"""Points that are drawn; more of them hide each other."""
MARKERS = "osD^vP"
MOST_PANELS = 6
MAP = "viridis"
FRONT = Entry("Pareto front", "black", width=1.3)


class Looks(NamedTuple):
    """The keys that panels, colours and markers stand for; None where a plot has no use for one."""

    panel: str | None
    colour: str | None
    marker: str | None


def plot_pareto(rows: SweepRows, order: Sequence[str]) -> Picture | None:
    """Return comfort over travel; `order` lists the varied keys by importance. None without these metrics."""
    if not {COMFORT, TRAVEL} <= set(rows.metrics):
        return None
    looks = _choose_looks(rows, order)
    shown = rows.usable.dropna(subset=[COMFORT, TRAVEL])
    drawn = shown.sample(MOST_POINTS, random_state=0) if len(shown) > MOST_POINTS else shown
    panels = [None] if looks.panel is None else sorted(shown[looks.panel].unique())
    columns = 1 if len(panels) == 1 else 2 if len(panels) <= 4 else 3
    lines = -(-len(panels) // columns)
    continuous = looks.colour is not None and is_number(shown[looks.colour])
    legend = [FRONT, *_list_colours(shown, looks.colour), *_list_markers(shown, looks.marker)]
    spare = SCREEN - 0.55 - 0.3 - 0.62 * lines - 0.25 * -(-len(legend) // 3)
    grid = Grid(
        (min(4.2, spare / lines),) * lines, columns, right=1.05 if continuous else 0.2, top=0.3, gap=(0.7, 0.75)
    )
    page = make_frame(grid, legend, WIDE)
    axes = [each for row in page.rows for each in row]
    for each, value in zip(axes, panels, strict=False):
        _draw_points(each, _select(drawn, looks.panel, value), looks, shown)
        _draw_front(each, _select(shown, looks.panel, value))
        _name_axes(each, "" if value is None else f"{looks.panel} {format_level(value)}", rows)
    for each in axes[len(panels) :]:
        each.remove()
    if continuous and looks.colour is not None:
        _add_scale(axes[min(columns, len(panels)) - 1], shown[looks.colour], describe_column(looks.colour, rows.units))
    some = f" {MOST_POINTS} of {len(shown)} runs are drawn." if len(drawn) < len(shown) else ""
    return Picture(
        "Comfort against travel",
        f"A point for each run; the further down and to the left the better.{some}",
        page.figure,
    )


def find_front(travel: Array, comfort: Array) -> NDArray[np.intp]:
    """Return the indices of the runs that no other is better than in both, by rising travel."""
    order = np.lexsort((comfort, travel))
    best = np.minimum.accumulate(comfort[order])
    keep = np.concatenate([[True], comfort[order][1:] < best[:-1]])
    front: NDArray[np.intp] = order[keep]
    return front


def _choose_looks(rows: SweepRows, order: Sequence[str]) -> Looks:
    """Give panels to a key of the excitation, colour to a text or else to what matters most, markers to a text."""
    few = {key: rows.usable[key].nunique() for key in order}
    panel = next((key for key in order if key.startswith("excitation.") and few[key] <= MOST_PANELS), None)
    rest = [key for key in order if key != panel]
    texts = [key for key in rest if key in rows.texts and few[key] <= len(COLOURS)]
    colour = texts[0] if texts else next((key for key in rest if key not in rows.texts), None)
    marker = next((key for key in rest if key != colour and few[key] <= len(MARKERS)), None)
    return Looks(panel, colour, marker)


def _select(runs: pd.DataFrame, key: str | None, value: object) -> pd.DataFrame:
    return runs if key is None else runs[runs[key] == value]


def _draw_points(axes: Axes, runs: pd.DataFrame, looks: Looks, every: pd.DataFrame) -> None:
    levels = [None] if looks.marker is None else sorted(every[looks.marker].unique())
    for level, marker in zip(levels, MARKERS, strict=False):
        here = _select(runs, looks.marker, level)
        axes.scatter(
            1e3 * here[TRAVEL], here[COMFORT], c=_colours(here, looks.colour, every), s=14, marker=marker,
            linewidths=0, alpha=0.75, zorder=2,
        )  # fmt: skip


def _colours(runs: pd.DataFrame, key: str | None, every: pd.DataFrame) -> Any:
    if key is None:
        return COLOURS[0]
    if is_number(every[key]):
        return colormaps[MAP](_norm(every[key])(runs[key].to_numpy()))
    known = {value: COLOURS[k % len(COLOURS)] for k, value in enumerate(sorted(every[key].unique()))}
    return [known[value] for value in runs[key]]


def _draw_front(axes: Axes, runs: pd.DataFrame) -> None:
    travel, comfort = runs[TRAVEL].to_numpy(), runs[COMFORT].to_numpy()
    front = find_front(travel, comfort)
    axes.step(1e3 * travel[front], comfort[front], where="post", color=FRONT.colour, linewidth=FRONT.width, zorder=3)


def _name_axes(axes: Axes, title: str, rows: SweepRows) -> None:
    axes.set_title(clean_text(title, LONGEST_TITLE), fontsize=9.5, loc="left")
    axes.set_xlabel(describe_column(TRAVEL, rows.units).axis)
    axes.set_ylabel(describe_column(COMFORT, rows.units).axis)


def _list_colours(every: pd.DataFrame, key: str | None) -> list[Entry]:
    if key is None or is_number(every[key]):
        return []
    names = sorted(every[key].unique())
    return [Entry(f"{format_level(value)}", COLOURS[k % len(COLOURS)], width=4.0) for k, value in enumerate(names)]


def _list_markers(every: pd.DataFrame, key: str | None) -> list[Entry]:
    levels = [] if key is None else sorted(every[key].unique())
    return [
        Entry(f"{key} {format_level(level)}", DARK, "none", mark=mark)
        for level, mark in zip(levels, MARKERS, strict=False)
    ]


def _norm(values: pd.Series[Any]) -> Normalize:
    return Normalize(float(values.min()), float(values.max()))


def _add_scale(axes: Axes, values: pd.Series[Any], quantity: Quantity) -> None:
    bar = add_axes_beside(axes, 0.015, 0.02)
    axes.figure.colorbar(ScalarMappable(_norm(values), MAP), cax=bar, label=quantity.axis)
