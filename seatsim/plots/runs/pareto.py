"""Comfort against travel: a point for each run, a panel for each seat and floor, its performance bounds where known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.plots import style
from seatsim.plots.runs import naming
from seatsim.plots.runs.placing import Spot, place_names
from seatsim.plots.style import COLOURS, DARK, Entry, Grid
from seatsim.simulation.performance_bounds import PerformanceBounds
from seatsim.simulation.result import Run

COMFORT, TRAVEL = "driver_acceleration_weighted", "suspension_displacement_rms"
NOTE = "Over the whole run; the further down and to the left the better."
BOUND = Entry("no damper without memory comes below", "black", width=1.6)
BEST = Entry("best run found of an ideal damper", DARK, (0.0, (5.0, 1.5)), 1.6)
BAND = "0.88"
"""Grey between the bounds."""
MOST_PANELS = 20
"""Panels of a page; ten rows of two are what a screen can scroll through."""
LONGEST = 40
"""Letters of the name of a point."""
SIDES = (4.6, 2.9)
"""Height in inches of a panel that is alone, and of one among others."""


class RunPoint(NamedTuple):
    """A run: RMS travel in mm, weighted RMS acceleration in m/s^2, and its name."""

    travel: float
    comfort: float
    name: str


class Panel(NamedTuple):
    """Points that share a seat and a floor, what sets these apart from the others', and their bounds or None."""

    title: str
    points: list[RunPoint]
    bracket: PerformanceBounds | None


def plot_pareto(runs: Sequence[Run], brackets: Mapping[str, PerformanceBounds]) -> Figure:
    """Return weighted acceleration over travel, a panel for each rig, with the performance bounds by `Scenario.rig`.

    Without bounds, rigs of one run share a panel. Points are named where there is room, else they are numbered.
    """
    found = _make_panels(runs, brackets) or [Panel("", [], None)]
    shown = found[:MOST_PANELS]
    names = list(dict.fromkeys(point.name for panel in shown for point in panel.points))
    columns = min(2, len(shown))
    legend = [BOUND, BEST] if any(panel.bracket for panel in shown) else []
    grid = Grid((SIDES[columns - 1],) * -(-len(shown) // columns), columns, top=0.35, gap=(0.85, 0.95))
    numbered = any(_place_names(panel, _panel_size(grid, columns)) is None for panel in shown)
    if numbered:
        legend = [*legend, *(Entry(f"{k + 1}  {name}", _colour(k), "none", mark="o") for k, name in enumerate(names))]
    note = NOTE + (f" {len(shown)} of {len(found)} rigs are shown." if len(shown) < len(found) else "")
    page = style.make_page(f"Comfort and travel: {naming.make_title(runs)}", note, grid, legend)
    panels = [axes for row in page.rows for axes in row]
    for axes, panel in zip(panels, shown, strict=False):
        _draw_panel(axes, panel, names, numbered, _panel_size(grid, columns))
    for axes in panels[len(shown) :]:
        axes.remove()
    return page.figure


def _make_panels(runs: Sequence[Run], brackets: Mapping[str, PerformanceBounds]) -> list[Panel]:
    groups: dict[str, list[Run]] = {}
    for run in runs:
        if all(np.isfinite(run.metrics[name].value) if name in run.metrics else False for name in (COMFORT, TRAVEL)):
            groups.setdefault(run.scenario.rig, []).append(run)
    if not brackets and len(groups) > 1 and any(len(group) < 2 for group in groups.values()):
        alone = [run for group in groups.values() for run in group]
        return [Panel("", _make_points(alone, naming.label_runs(alone, LONGEST)), None)]
    found = []
    for rig, group in groups.items():
        title, names = naming.distinguish_runs(group, runs)
        found.append(Panel(title, _make_points(group, names), brackets.get(rig)))
    return found


def _make_points(runs: Sequence[Run], names: Sequence[str]) -> list[RunPoint]:
    return [
        RunPoint(1e3 * run.metrics[TRAVEL].value, run.metrics[COMFORT].value, name)
        for run, name in zip(runs, names, strict=True)
    ]


def _panel_size(grid: Grid, columns: int) -> tuple[float, float]:
    """Return width and height of a panel in inches."""
    wide = (style.WIDTH - grid.left - grid.right - grid.gap[0] * (columns - 1)) / columns
    return wide, grid.heights[0]


def _find_limits(panel: Panel) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the ranges of travel and comfort that hold points and performance bounds, with a margin."""
    travel, comfort = [point.travel for point in panel.points], [point.comfort for point in panel.points]
    if panel.bracket:
        travel += [1e3 * float(x) for x in panel.bracket.travel]
        comfort += [float(a) for a in panel.bracket.acceleration] + [float(panel.bracket.bound(max(travel) / 1e3))]
    return _pad(travel), _pad(comfort)


def _pad(values: Sequence[float]) -> tuple[float, float]:
    low, high = min(values), max(values)
    margin = 0.12 * (high - low) or 0.1 * abs(high) or 1.0
    return max(0.0, low - margin), high + margin


def _place_names(panel: Panel, size: tuple[float, float]) -> list[Spot] | None:
    across, up = _find_limits(panel) if panel.points else ((0.0, 1.0), (0.0, 1.0))
    inches = [
        (size[0] * (p.travel - across[0]) / (across[1] - across[0]), size[1] * (p.comfort - up[0]) / (up[1] - up[0]))
        for p in panel.points
    ]
    return place_names(inches, [point.name for point in panel.points], size)


def _draw_panel(axes: Axes, panel: Panel, names: list[str], numbered: bool, size: tuple[float, float]) -> None:
    if not panel.points:
        return style.explain_empty(axes, "no run with a weighted acceleration: that needs 200 samples a second")
    across, up = _find_limits(panel)
    axes.set_xlim(across)
    axes.set_ylim(up)
    if panel.bracket:
        _draw_bracket(axes, panel.bracket, across)
    texts = [str(names.index(point.name) + 1) if numbered else point.name for point in panel.points]
    named = panel._replace(points=[p._replace(name=text) for p, text in zip(panel.points, texts, strict=True)])
    spots = _place_names(named, size) or [Spot(0.1, 0.1, False)] * len(texts)
    for point, text, spot in zip(panel.points, texts, spots, strict=True):
        colour = _colour(names.index(point.name))
        axes.scatter(point.travel, point.comfort, s=49, color=colour, edgecolors="white", zorder=4)
        axes.annotate(
            text, (point.travel, point.comfort), (72 * spot.right, 72 * spot.up), textcoords="offset points",
            fontsize=9.5, va="center", ha="left", color=colour, zorder=5,
            arrowprops={"arrowstyle": "-", "color": "0.6", "linewidth": 0.7} if spot.far else None,
        )  # fmt: skip
    axes.set_title(panel.title, fontsize=10.5, loc="left")
    axes.set_xlabel("RMS suspension travel [mm]")
    axes.set_ylabel("driver, Wk RMS [m/s²]")


def _draw_bracket(axes: Axes, bracket: PerformanceBounds, across: tuple[float, float]) -> None:
    travel = np.linspace(*across, 300)
    bound, best = bracket.bound(1e-3 * travel), bracket.best(1e-3 * travel)
    axes.fill_between(travel, bound, best, where=np.isfinite(best), color=BAND, linewidth=0, zorder=1)
    style.draw_line(axes, travel, bound, BOUND)
    style.draw_line(axes, travel, best, BEST)


def _colour(index: int) -> str:
    return COLOURS[index % len(COLOURS)]
