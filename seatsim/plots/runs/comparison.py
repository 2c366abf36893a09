"""Runs side by side: comfort against travel, and lines over a swept number."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from scipy.optimize import isotonic_regression, linear_sum_assignment
from scipy.spatial.distance import cdist

from seatsim.metrics.table import COMFORT, SEAT, TRAVEL, UNWEIGHTED
from seatsim.plots import style
from seatsim.plots.runs.looks import MOST as MOST_LINES
from seatsim.plots.runs.looks import choose_looks
from seatsim.plots.style import DARK, GREY, Entry, Grid, clean_text, describe_metric
from seatsim.scenario.scenario import condition_of
from seatsim.schema.arrays import Array
from seatsim.schema.text import name_some
from seatsim.simulation import naming
from seatsim.simulation.result import Run

FLOOR = Entry("as much as the floor (SEAT = 1)", DARK, ":", 1.6)
_SIZE, _WIDER, _COVERED = 7.7, 2.5, 3.0
"""Points across a dot and more of one about it; distance in dots of the picture below which one covers another."""
_APART = 0.17
"""Least distance in inches of the names beside a panel."""
NEAR = 1.6
"""How far above the greatest acceleration the floor's is still drawn, as a ratio."""
MOST_PANELS = 12
_SIDES = (3.3, 2.1)
"""Height in inches of a panel that is alone, and of one among others, at least."""


class Panel(NamedTuple):
    """Runs that share a condition: what sets it apart from the others, the runs, their names."""

    title: str
    runs: Sequence[Run]
    names: Sequence[str]

    @property
    def points(self) -> Array:
        """RMS travel in mm and weighted RMS acceleration in m/s^2 of each run, shape (runs, 2)."""
        return np.array([[1e3 * run.read_metric(TRAVEL), run.read_metric(COMFORT)] for run in self.runs])

    @property
    def floor(self) -> float:
        """Weighted acceleration of the floor that the runs share; NaN where they share none, or it is far above."""
        felt = self.points[:, 1]
        floors = felt / [run.read_metric(SEAT) for run in self.runs]
        is_shared = np.allclose(floors, floors[0], rtol=1e-3) and floors[0] < NEAR * np.max(felt)
        return float(floors[0]) if is_shared else float("nan")


def plot_pareto(runs: Sequence[Run]) -> Figure:
    """Return weighted acceleration over travel, a panel for each condition.

    Conditions of one run share a panel. Beside a panel stand the names of its points. A line says where the driver
    feels as much as the floor moves.
    """
    found, looks = _make_panels(runs) or [Panel("", [], [])], choose_looks(runs)
    shown = found[:MOST_PANELS]
    no_floor = [f"“{panel.title}”" for panel in shown if not (panel.runs and np.isfinite(panel.floor))]
    legend = [FLOOR] * (len(no_floor) < len(shown))
    note = "Over the whole run; on the same floor, lower left is better."
    note += style.OWN_SCALES * (len(shown) > 1) + naming.explain_doubt([run for panel in shown for run in panel.runs])
    note += " Grey: runs without a line in the other pictures." * any(look.colour == GREY for look in looks.values())
    if no_floor and legend:
        note += f" SEAT = 1 is drawn where it is within the scale and the same for all: not in {name_some(no_floor)}."
    note += f" {len(shown)} of {len(found)} conditions are shown." if len(shown) < len(found) else ""
    heights = [max(_SIDES[len(shown) > 1], _APART * len(panel.runs)) for panel in shown]
    right = style.measure_names([name for panel in shown for name in panel.names]) + 0.1
    grid = Grid(heights, right=right, top=0.3, gap=(0.0, 0.85))
    page = style.make_page(f"Comfort and travel: {naming.make_title(runs)}", note, grid, legend)
    for axes, panel in zip(page.list_panels(len(shown)), shown, strict=True):
        _draw_panel(axes, panel, [looks[id(run)].colour for run in panel.runs])
    return page.figure


def _make_panels(runs: Sequence[Run]) -> list[Panel]:
    groups = dict[str, list[Run]]()
    for run in runs:
        if np.isfinite(run.read_metric(COMFORT) + run.read_metric(TRAVEL)):
            groups.setdefault(condition_of(run.scenario), []).append(run)
    if len(groups) > 1 and any(len(group) < 2 for group in groups.values()):
        alone = [run for group in groups.values() for run in group]
        return [Panel("", alone, naming.label_runs(alone))]
    named = [(group, *naming.distinguish_runs(group, runs)) for group in groups.values()]
    return [Panel(title, group, names) for group, title, names in named]


def _pad(values: Array) -> tuple[float, float]:
    low, high = float(np.min(values)), float(np.max(values))
    # At least a tenth of the values: runs that hardly differ are not spread over the whole panel.
    margin = max(0.12 * (high - low), 0.05 * abs(high)) or 1.0
    return max(low - margin, min(0.0, low)), high + margin


def _draw_panel(axes: Axes, panel: Panel, colours: Sequence[str]) -> None:
    if not panel.runs:
        return style.explain_empty(axes, "no run with a weighted acceleration: that needs 200 samples a second")
    travel, comfort = panel.points.T
    if np.isfinite(panel.floor):
        comfort = np.append(comfort, panel.floor)
        axes.axhline(panel.floor, color=FLOOR.colour, linestyle=FLOOR.dashes, linewidth=FLOOR.width, zorder=2)
    axes.set(xlim=_pad(travel), xlabel=describe_metric(TRAVEL).axis)
    axes.set(ylim=_pad(comfort), ylabel=describe_metric(COMFORT).axis)
    # A point that a later one covers is larger, so that it is a ring about it.
    places = axes.transData.transform(panel.points)
    above = [np.sum(np.hypot(*(places[k + 1 :] - place).T) < _COVERED) for k, place in enumerate(places)]
    sizes = (_SIZE + _WIDER * np.array(above)) ** 2
    axes.scatter(travel, panel.points[:, 1], sizes, colours, edgecolors="1.0", linewidths=0.5, zorder=4, clip_on=False)
    _name_points(axes, panel.points, panel.names, colours)
    style.set_title(axes, panel.title)


def _name_points(axes: Axes, points: Array, texts: Sequence[str], colours: Sequence[str]) -> None:
    """Write names in a column beside a panel, each at a line that ends in its point; no two of these lines cross."""
    lines = _APART * axes.figure.dpi / axes.bbox.height * np.arange(len(texts))
    inside = axes.transAxes.inverted().transform(axes.transData.transform(points))
    # The nearest places, in the sense of least squares, that are a line apart.
    heights = np.clip(isotonic_regression(np.sort(inside[:, 1]) - lines).x, 0.0, 1.0 - lines[-1]) + lines
    ends = np.column_stack([np.full(len(lines), 1.02), heights])
    # Of all lines from points to places, those that are shortest together do not cross.
    ends = ends[linear_sum_assignment(cdist(inside * axes.bbox.size, ends * axes.bbox.size))[1]]
    for text, end in zip(texts, ends, strict=True):
        axes.text(1.05, end[1], clean_text(text, 32), transform=axes.transAxes, va="center", fontsize=style.FONT)
    paths = np.stack([inside, ends, ends + np.array([0.02, 0.0])], axis=1)
    drawn = LineCollection(list(paths), colors=colours, linewidths=0.8, transform=axes.transAxes, clip_on=False)
    axes.add_collection(drawn, autolim=False).set_zorder(3)


COMPARED = (UNWEIGHTED, COMFORT, TRAVEL, SEAT)


def plot_comparison(runs: Sequence[Run]) -> Figure | None:
    """Return lines over the number that is swept, one line for each variant; none where no number is."""
    key, series = naming.find_swept_number(runs), dict[str, list[Run]]()
    named = zip(naming.name_runs(runs, without=[key]), runs, strict=True)
    for name, run in sorted(named, key=lambda pair: float(pair[1].scenario.label.get(key, 0.0))):
        series.setdefault(name, []).append(run)
    if not key or len(series) > MOST_LINES:
        return None
    looks_of, title = choose_looks(runs), f"Comparison: {naming.make_title(runs)}"
    looks = [looks_of[id(group[0])]._replace(label=name) for name, group in series.items()]
    axis = naming.label_axis(next(iter(series.values()))[0].scenario, key)
    note, grid = "Over the whole run; on the same floor, the smaller the better.", Grid((1.8, 1.8), 2, left=0.85)
    note += naming.explain_doubt(runs, "Hollow:")
    page = style.make_page(title, note, grid._replace(gap=(0.9, 0.65)), looks[1:] and looks)
    for axes, metric in zip(page.list_panels(), COMPARED, strict=True):
        shown = describe_metric(metric)
        for look, group in zip(looks, series.values(), strict=True):
            places = [float(run.scenario.label[key]) for run in group]
            values = [shown.factor * run.read_metric(metric) for run in group]
            style.draw_line(axes, places, values, look._replace(width=1.6, mark="o"))
            inner = ["white" if run.unverified else "none" for run in group]
            axes.scatter(places, values, 12, color=inner, linewidths=0, zorder=3)
        axes.set(xlabel=axis, ylabel=f"{shown.words} [{shown.unit}]", ylim=(0, 1.05 * axes.get_ylim()[1]))
        style.number_places(axes, places)
    return style.name_coincident(page.figure)
