"""Runs side by side: comfort against travel, and bars or lines over a swept number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from string import ascii_uppercase
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.metrics.table import COMFORT, SEAT, TRAVEL, UNWEIGHTED
from seatsim.plots import style
from seatsim.plots.runs.looks import MOST as MOST_LINES
from seatsim.plots.runs.looks import choose_looks, explain_grey
from seatsim.plots.style import DARK, ROW, Entry, Grid, describe_metric
from seatsim.scenario.scenario import condition_of
from seatsim.schema.arrays import Array
from seatsim.schema.printing import format_number
from seatsim.simulation import naming
from seatsim.simulation.performance_bounds import PerformanceBounds
from seatsim.simulation.result import Run

BOUND = Entry("lower bound without hysteresis", "black", width=1.6)
BEST = Entry("best run found, floor known ahead", DARK, (0.0, (5.0, 1.5)), 1.6)
FLOOR = Entry("as much as the floor (SEAT = 1)", DARK, ":", 1.6)
_SAME_PLACE = 10.0
"""Distance in points of print, below which a mark would cover another's number."""
_ENOUGH = 15.0
"""Distance in points of print, at which a mark disturbs no letters."""
NEAR = 1.6
"""How far above the greatest acceleration the floor's is still drawn, as a ratio."""
MOST_PANELS = 12
_SIDES = (3.3, 2.1)
"""Height in inches of a panel that is alone, and of one among others."""


class Panel(NamedTuple):
    """Runs that share a condition: what sets it apart from the others, the runs, their names, their bounds or None."""

    title: str
    runs: Sequence[Run]
    names: Sequence[str]
    bracket: PerformanceBounds | None = None

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


def plot_pareto(runs: Sequence[Run], brackets: Mapping[str, PerformanceBounds]) -> Figure:
    """Return weighted acceleration over travel, a panel for each condition (with performance bounds: for each rig).

    Conditions of one run share a panel. Points have letters; the legend names them, in the order of the runs. A line
    says where the driver feels as much as the floor moves.
    """
    found, looks = _make_panels(runs, brackets) or [Panel("", [], [])], choose_looks(runs)
    shown, columns = found[:MOST_PANELS], min(2, len(found))
    named = {name: run for panel in shown for name, run in zip(panel.names, panel.runs, strict=True)}
    points = {
        name: Entry(f"{_letter(k)}  {name}", looks[id(run)].colour, "none", mark="o")
        for k, (name, run) in enumerate(named.items())
    }
    legend = [*points.values(), *[BOUND, BEST] * any(panel.bracket for panel in shown)]
    legend += [FLOOR] * any(panel.runs and np.isfinite(panel.floor) for panel in shown)
    note = "Over the whole run; on the same floor, lower left is better."
    note += style.OWN_SCALES * (len(shown) > 1) + explain_grey(looks)
    note += f" {len(shown)} of {len(found)} rigs are shown." if len(shown) < len(found) else ""
    grid = Grid((_SIDES[columns - 1],) * -(-len(shown) // columns), columns, top=0.3, gap=(0.75, 0.85))
    page = style.make_page(f"Comfort and travel: {naming.make_title(runs)}", note, grid, legend)
    for axes, panel in zip(page.list_panels(len(shown)), shown, strict=True):
        _draw_panel(axes, panel, points)
    return page.figure


def _letter(number: int) -> str:
    """Return A to Z, then A1 to Z1: a number could be taken for that in a name."""
    again, place = divmod(number, len(ascii_uppercase))
    return ascii_uppercase[place] + str(again or "")


def _make_panels(runs: Sequence[Run], brackets: Mapping[str, PerformanceBounds]) -> list[Panel]:
    groups = dict[str, list[Run]]()
    for run in runs:
        if np.isfinite(run.read_metric(COMFORT) + run.read_metric(TRAVEL)):
            groups.setdefault(run.scenario.rig if brackets else condition_of(run.scenario), []).append(run)
    if not brackets and len(groups) > 1 and any(len(group) < 2 for group in groups.values()):
        alone = [run for group in groups.values() for run in group]
        return [Panel("", alone, naming.label_runs(alone))]
    named = [(rig, group, *naming.distinguish_runs(group, runs)) for rig, group in groups.items()]
    return [Panel(title, group, names, brackets.get(rig)) for rig, group, title, names in named]


def _pad(values: Array) -> tuple[float, float]:
    low, high = float(np.min(values)), float(np.max(values))
    # At least a tenth of the values: runs that hardly differ are not spread over the whole panel.
    margin = max(0.12 * (high - low), 0.05 * abs(high)) or 1.0
    return low - margin, high + margin


def _draw_panel(axes: Axes, panel: Panel, looks: Mapping[str, Entry]) -> None:
    if not panel.runs:
        return style.explain_empty(axes, "no run with a weighted acceleration: that needs 200 samples a second")
    travel, comfort = panel.points.T
    if np.isfinite(panel.floor):
        comfort = np.append(comfort, panel.floor)
        axes.axhline(panel.floor, color=FLOOR.colour, linestyle=FLOOR.dashes, linewidth=FLOOR.width, zorder=2)
    if panel.bracket:
        travel = np.append(travel, 1e3 * panel.bracket.travel)
        comfort = np.append(comfort, [*panel.bracket.acceleration, panel.bracket.bound(1e-3 * np.max(travel))])
        draw_bounds(axes, np.linspace(*_pad(travel), 200), panel.bracket)
    axes.set(xlim=_pad(travel), xlabel=describe_metric(TRAVEL).axis)
    axes.set(ylim=_pad(comfort), ylabel=describe_metric(COMFORT).axis)
    # The most comfortable one on top of those that it meets.
    for point, name in sorted(zip(panel.points.tolist(), panel.names, strict=True), key=lambda pair: -pair[0][1]):
        axes.scatter(point[0], point[1], s=150, color=looks[name].colour, edgecolors="1.0", zorder=4)
    _write_letters(axes, panel.points, [looks[name].label.split()[0] for name in panel.names])
    style.set_title(axes, panel.title)


def draw_bounds(axes: Axes, travel: Array, bracket: PerformanceBounds) -> None:
    """Draw the bounds of a rig over an RMS travel in mm, with the area between them."""
    bound, best = bracket.bound(1e-3 * travel), bracket.best(1e-3 * travel)
    axes.fill_between(travel, bound, best, where=np.isfinite(best), color=style.AREA, linewidth=0, zorder=1)
    style.draw_line(axes, travel, bound, BOUND)
    style.draw_line(axes, travel, best, BEST)


def _write_letters(axes: Axes, points: Array, letters: Sequence[str]) -> None:
    """Write the letter of each point into it; those of points at one place stand where other points are far."""
    places = axes.transData.transform(points) * 72 / axes.figure.dpi
    left = sorted(range(len(letters)), key=lambda k: letters[k])
    while left:
        near = [k for k in left if np.linalg.norm(places[k] - places[left[0]]) < _SAME_PLACE]
        left = [k for k in left if k not in near]
        text, others = " ".join(letters[k] for k in near), np.delete(places, near, axis=0)
        across, up = np.ptp(places[near], axis=0) / 2 + (8.0 + 4.0 * len(text), 15.0)
        spots = np.array([(across, 0.0), (0.0, up), (0.0, -up), (-across, 0.0)]) if len(near) > 1 else np.zeros((1, 2))
        # From the middle of the outer ones, so that no mark of the group lies below its letters.
        spots = spots + (np.min(places[near], axis=0) + np.max(places[near], axis=0)) / 2
        gaps = np.linalg.norm(spots[:, None] - others, axis=2)
        spot = spots[np.argmax(np.min(gaps, axis=1, initial=_ENOUGH))] - places[near[0]]
        axes.annotate(
            text, points[near[0]], tuple(spot), textcoords="offset points", fontsize=9, zorder=5, fontweight="bold",
            ha="center", va="center_baseline", color="0.0" if len(near) > 1 else "1.0",
        )  # fmt: skip


COMPARED = (UNWEIGHTED, COMFORT, TRAVEL, SEAT)
NOTE = "Over the whole run; on the same floor, the smaller the better."


def plot_comparison(runs: Sequence[Run]) -> Figure:
    """Return bars run by run, or lines over the number that is swept, one line for each variant."""
    key, series = naming.find_swept_number(runs), dict[str, list[Run]]()
    for name, run in zip(naming.label_runs(runs, without=[key]), runs, strict=True):
        series.setdefault(name, []).append(run)
    title = f"Comparison: {naming.make_title(runs)}"
    return _plot_lines(title, key, series) if key and len(series) <= MOST_LINES else _plot_bars(title, runs)


def _plot_bars(title: str, runs: Sequence[Run]) -> Figure:
    names = naming.label_runs(runs, 32)
    looks, left = choose_looks(runs), style.measure_names(names)
    grid = Grid((ROW * len(runs) + 0.1,) * 2, columns=2, left=left, gap=(0.3, 0.6))
    page = style.make_page(title, NOTE + explain_grey(looks), grid)
    for k, (axes, metric) in enumerate(zip(page.list_panels(), COMPARED, strict=True)):
        shown = describe_metric(metric)
        values = [shown.factor * run.read_metric(metric) for run in runs]
        style.name_rows(axes, [""] * len(names) if k % 2 else names)
        style.draw_bars(axes, values, [looks[id(run)].colour for run in runs], list(map(format_number, values)))
        # Room for the figures at the ends of the bars.
        end = (1.0 + 0.45 / grid.width) * float(np.max(np.nan_to_num(values)))
        axes.set(xlim=(0.0, end or 1.0), xlabel=f"{shown.words} [{shown.unit}]")
    return page.figure


def _plot_lines(title: str, key: str, series: dict[str, list[Run]]) -> Figure:
    of_runs = choose_looks([run for group in series.values() for run in group])
    looks = [of_runs[id(group[0])]._replace(label=name) for name, group in series.items()]
    axis = naming.label_axis(next(iter(series.values()))[0].scenario, key)
    page = style.make_page(title, NOTE, Grid((1.8, 1.8), 2, left=0.85, gap=(0.9, 0.65)), looks[1:] and looks)
    for axes, metric in zip(page.list_panels(), COMPARED, strict=True):
        shown = describe_metric(metric)
        for look, group in zip(looks, series.values(), strict=True):
            points = [(float(run.scenario.label[key]), shown.factor * run.read_metric(metric)) for run in group]
            places, values = zip(*sorted(points, key=lambda point: point[0]), strict=True)
            style.draw_line(axes, places, values, look._replace(width=1.6, mark="o"))
        axes.set(xlabel=axis, ylabel=f"{shown.words} [{shown.unit}]")
        axes.set_ylim(0, 1.05 * axes.get_ylim()[1])
    return style.name_coincident(page.figure)
