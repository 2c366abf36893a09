"""Comfort against travel: a point for each run, a panel for each seat and floor, its performance bounds where known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.plots import style
from seatsim.plots.runs import naming
from seatsim.plots.style import COLOURS, DARK, Entry, Grid
from seatsim.scenario.scenario import condition_of
from seatsim.simulation.performance_bounds import PerformanceBounds
from seatsim.simulation.result import Run

COMFORT, TRAVEL, SEAT = "driver_acceleration_weighted", "suspension_displacement_rms", "seat_factor"
NOTE = "Over the whole run; lower left is better. The numbers are in the order of comfort."
BOUND = Entry("no damper without memory comes below", "black", width=1.6)
BEST = Entry("best run found of an ideal damper", DARK, (0.0, (5.0, 1.5)), 1.6)
FLOOR = Entry("as much as the floor (SEAT = 1)", DARK, ":", 1.6)
BAND = "0.88"
"""Grey between the bounds."""
NEAR = 1.6
"""How far above the greatest acceleration the floor's is still drawn, as a ratio."""
MOST_PANELS = 12
_SIDES = (3.3, 2.1)
"""Height in inches of a panel that is alone, and of one among others."""


class _RunPoint(NamedTuple):
    """A run: RMS travel in mm, weighted RMS acceleration in m/s^2, SEAT factor, and its name."""

    travel: float
    comfort: float
    seat: float
    name: str


class Panel(NamedTuple):
    """Points that share a condition, what sets these apart from the others', and their bounds or None."""

    title: str
    points: list[_RunPoint]
    bracket: PerformanceBounds | None

    @property
    def floor(self) -> float:
        """Weighted acceleration of the floor that the points share; NaN where they share none, or it is far above."""
        floors = [point.comfort / point.seat for point in self.points]
        highest = max(point.comfort for point in self.points)
        return floors[0] if np.allclose(floors, floors[0], rtol=1e-3) and floors[0] < NEAR * highest else float("nan")


def plot_pareto(runs: Sequence[Run], brackets: Mapping[str, PerformanceBounds]) -> Figure:
    """Return weighted acceleration over travel, a panel for each condition (with performance bounds: for each rig).

    Conditions of one run share a panel. Points are numbered; the legend names them, the most comfortable
    first. A line says where the driver feels as much as the floor moves.
    """
    found = _make_panels(runs, brackets) or [Panel("", [], None)]
    shown = found[:MOST_PANELS]
    points = sorted((point for panel in shown for point in panel.points), key=lambda point: point.comfort)
    colours = {point.name: COLOURS[k % len(COLOURS)] for k, point in enumerate(_order(shown))}
    ranked = list(dict.fromkeys(point.name for point in points))
    columns = min(2, len(shown))
    legend = [Entry(f"{k + 1}  {name}", colours[name], "none", mark="o") for k, name in enumerate(ranked)]
    legend += [BOUND, BEST] if any(panel.bracket for panel in shown) else []
    legend += [FLOOR] if any(panel.points and np.isfinite(panel.floor) for panel in shown) else []
    note = NOTE + (f" {len(shown)} of {len(found)} rigs are shown." if len(shown) < len(found) else "")
    grid = Grid((_SIDES[columns - 1],) * -(-len(shown) // columns), columns, top=0.3, gap=(0.75, 0.85))
    page = style.make_page(f"Comfort and travel: {naming.make_title(runs)}", note, grid, legend)
    panels = [axes for row in page.rows for axes in row]
    for axes, panel in zip(panels, shown, strict=False):
        _draw_panel(axes, panel, ranked, colours)
    for axes in panels[len(shown) :]:
        axes.remove()
    return page.figure


def _order(panels: Sequence[Panel]) -> list[_RunPoint]:
    """Return one point of each name, in the order of the runs, in which other pictures colour them."""
    return list({point.name: point for panel in panels for point in panel.points}.values())


def _make_panels(runs: Sequence[Run], brackets: Mapping[str, PerformanceBounds]) -> list[Panel]:
    groups: dict[str, list[Run]] = {}
    for run in runs:
        if all(np.isfinite(run.metrics[name].value) if name in run.metrics else False for name in (COMFORT, TRAVEL)):
            groups.setdefault(run.scenario.rig if brackets else condition_of(run.scenario), []).append(run)
    if not brackets and len(groups) > 1 and any(len(group) < 2 for group in groups.values()):
        alone = [run for group in groups.values() for run in group]
        return [Panel("", _make_points(alone, naming.label_runs(alone)), None)]
    found = []
    for rig, group in groups.items():
        title, names = naming.distinguish_runs(group, runs)
        found.append(Panel(title, _make_points(group, names), brackets.get(rig)))
    return found


def _make_points(runs: Sequence[Run], names: Sequence[str]) -> list[_RunPoint]:
    seats = [run.metrics[SEAT].value if SEAT in run.metrics else np.nan for run in runs]
    return [
        _RunPoint(1e3 * run.metrics[TRAVEL].value, run.metrics[COMFORT].value, seat, name)
        for run, seat, name in zip(runs, seats, names, strict=True)
    ]


def _pad(values: Sequence[float]) -> tuple[float, float]:
    low, high = min(values), max(values)
    margin = 0.12 * (high - low) or 0.1 * abs(high) or 1.0
    return max(0.0, low - margin), high + margin


def _draw_panel(axes: Axes, panel: Panel, ranked: Sequence[str], colours: Mapping[str, str]) -> None:
    if not panel.points:
        return style.explain_empty(axes, "no run with a weighted acceleration: that needs 200 samples a second")
    travel, comfort = [point.travel for point in panel.points], [point.comfort for point in panel.points]
    if np.isfinite(panel.floor):
        comfort.append(panel.floor)
        axes.axhline(panel.floor, color=FLOOR.colour, linestyle=FLOOR.dashes, linewidth=FLOOR.width, zorder=2)
    if panel.bracket:
        travel += [1e3 * float(x) for x in panel.bracket.travel]
        comfort += [float(a) for a in panel.bracket.acceleration] + [float(panel.bracket.bound(max(travel) / 1e3))]
        _draw_bracket(axes, panel.bracket, _pad(travel))
    axes.set_xlim(_pad(travel))
    axes.set_ylim(_pad(comfort))
    # The most comfortable one on top of those that it meets.
    for point in sorted(panel.points, key=lambda point: -point.comfort):
        axes.scatter(point.travel, point.comfort, s=150, color=colours[point.name], edgecolors="1.0", zorder=4)
        axes.annotate(
            str(ranked.index(point.name) + 1), (point.travel, point.comfort), color="1.0", fontsize=9, zorder=5,
            fontweight="bold", ha="center", va="center_baseline",
        )  # fmt: skip
    style.set_title(axes, panel.title)
    axes.set_xlabel("RMS suspension travel [mm]")
    axes.set_ylabel("driver, Wk RMS [m/s²]")


def _draw_bracket(axes: Axes, bracket: PerformanceBounds, across: tuple[float, float]) -> None:
    travel = np.linspace(*across, 200)
    bound, best = bracket.bound(1e-3 * travel), bracket.best(1e-3 * travel)
    axes.fill_between(travel, bound, best, where=np.isfinite(best), color=BAND, linewidth=0, zorder=1)
    style.draw_line(axes, travel, bound, BOUND)
    style.draw_line(axes, travel, best, BEST)
