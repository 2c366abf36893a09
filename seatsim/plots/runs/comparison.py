"""Runs side by side: comfort against travel, and bars or lines over a swept number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.metrics.table import COMFORT, SEAT, TRAVEL, UNWEIGHTED
from seatsim.plots import style
from seatsim.plots.labels import format_number
from seatsim.plots.runs import naming
from seatsim.plots.style import DARK, ROW, Entry, Grid
from seatsim.scenario.scenario import condition_of
from seatsim.simulation.performance_bounds import PerformanceBounds
from seatsim.simulation.result import Run

BOUND = Entry("no damper without memory comes below", "black", width=1.6)
BEST = Entry("best run found of an ideal damper", DARK, (0.0, (5.0, 1.5)), 1.6)
FLOOR = Entry("as much as the floor (SEAT = 1)", DARK, ":", 1.6)
BAND = "0.88"
"""Grey between the bounds."""
SAME_PLACE = 10.0
"""Distance in points of print, below which a mark would cover another's number."""
NEAR = 1.6
"""How far above the greatest acceleration the floor's is still drawn, as a ratio."""
MOST_PANELS = 12
_SIDES = (3.3, 2.1)
"""Height in inches of a panel that is alone, and of one among others."""


class _RunPoint(NamedTuple):
    """A run: RMS travel in mm, weighted RMS acceleration in m/s^2, SEAT factor, its name, and its colour."""

    travel: float
    comfort: float
    seat: float
    name: str
    colour: str


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

    Conditions of one run share a panel. Points are numbered; the legend names them, in the order of the runs. A line
    says where the driver feels as much as the floor moves.
    """
    found = _make_panels(runs, brackets) or [Panel("", [], None)]
    shown = found[:MOST_PANELS]
    points = [point for panel in shown for point in panel.points]
    colours, columns = {point.name: point.colour for point in points}, min(2, len(shown))
    legend = [Entry(f"{k}  {name}", colours[name], "none", mark="o") for k, name in enumerate(colours, 1)]
    legend += [BOUND, BEST] if any(panel.bracket for panel in shown) else []
    legend += [FLOOR] if any(panel.points and np.isfinite(panel.floor) for panel in shown) else []
    note = "Over the whole run; on the same floor, lower left is better. Numbers as in the legend."
    note += f" {len(shown)} of {len(found)} rigs are shown." if len(shown) < len(found) else ""
    grid = Grid((_SIDES[columns - 1],) * -(-len(shown) // columns), columns, top=0.3, gap=(0.75, 0.85))
    page = style.make_page(f"Comfort and travel: {naming.make_title(runs)}", note, grid, legend)
    for axes, panel in zip(page.list_panels(len(shown)), shown, strict=True):
        _draw_panel(axes, panel, list(colours))
    return page.figure


def _make_panels(runs: Sequence[Run], brackets: Mapping[str, PerformanceBounds]) -> list[Panel]:
    groups, looks = dict[str, list[Run]](), naming.choose_looks(runs)

    def make_points(group: Sequence[Run], names: Sequence[str]) -> list[_RunPoint]:
        figures = [[run.read_metric(metric) for metric in (TRAVEL, COMFORT, SEAT)] for run in group]
        return [
            _RunPoint(1e3 * travel, comfort, seat, name, looks[id(run)].colour)
            for (travel, comfort, seat), name, run in zip(figures, names, group, strict=True)
        ]

    for run in runs:
        if np.isfinite(run.read_metric(COMFORT) + run.read_metric(TRAVEL)):
            groups.setdefault(run.scenario.rig if brackets else condition_of(run.scenario), []).append(run)
    if not brackets and len(groups) > 1 and any(len(group) < 2 for group in groups.values()):
        alone = [run for group in groups.values() for run in group]
        return [Panel("", make_points(alone, naming.label_runs(alone)), None)]
    named = [(rig, group, *naming.distinguish_runs(group, runs)) for rig, group in groups.items()]
    return [Panel(title, make_points(group, names), brackets.get(rig)) for rig, group, title, names in named]


def _pad(values: Sequence[float]) -> tuple[float, float]:
    low, high = min(values), max(values)
    # At least a tenth of the values: runs that hardly differ are not spread over the whole panel.
    margin = max(0.12 * (high - low), 0.05 * abs(high)) or 1.0
    return max(0.0, low - margin), high + margin


def _draw_panel(axes: Axes, panel: Panel, names: Sequence[str]) -> None:
    if not panel.points:
        return style.explain_empty(axes, "no run with a weighted acceleration: that needs 200 samples a second")
    travel, comfort = [point.travel for point in panel.points], [point.comfort for point in panel.points]
    if np.isfinite(panel.floor):
        comfort.append(panel.floor)
        axes.axhline(panel.floor, color=FLOOR.colour, linestyle=FLOOR.dashes, linewidth=FLOOR.width, zorder=2)
    if panel.bracket:
        travel += [1e3 * float(x) for x in panel.bracket.travel]
        comfort += [float(a) for a in panel.bracket.acceleration] + [float(panel.bracket.bound(max(travel) / 1e3))]
        places = np.linspace(*_pad(travel), 200)
        bound, best = panel.bracket.bound(1e-3 * places), panel.bracket.best(1e-3 * places)
        axes.fill_between(places, bound, best, where=np.isfinite(best), color=BAND, linewidth=0, zorder=1)
        style.draw_line(axes, places, bound, BOUND)
        style.draw_line(axes, places, best, BEST)
    axes.set(xlim=_pad(travel), ylim=_pad(comfort), xlabel="RMS suspension travel [mm]", ylabel="driver, Wk RMS [m/s²]")
    # The most comfortable one on top of those that it meets.
    for point in sorted(panel.points, key=lambda point: -point.comfort):
        axes.scatter(point.travel, point.comfort, s=150, color=point.colour, edgecolors="1.0", zorder=4)
    _number_points(axes, panel.points, names)
    style.set_title(axes, panel.title)


def _number_points(axes: Axes, points: Sequence[_RunPoint], names: Sequence[str]) -> None:
    """Write the number of each point into it; those of points at one place stand beside it."""
    left = sorted(points, key=lambda point: names.index(point.name))
    while left:
        places = axes.transData.transform([point[:2] for point in left]) * 72 / axes.figure.dpi
        near = np.linalg.norm(places - places[0], axis=1) < SAME_PLACE
        numbers = [str(names.index(point.name) + 1) for point, close in zip(left, near, strict=True) if close]
        alone = len(numbers) == 1
        axes.annotate(
            " ".join(numbers), left[0][:2], (0 if alone else 8, 0), textcoords="offset points", fontsize=9, zorder=5,
            fontweight="bold", ha="center" if alone else "left", va="center_baseline", color="1.0" if alone else "0.0",
        )  # fmt: skip
        left = [point for point, close in zip(left, near, strict=True) if not close]


class _Compared(NamedTuple):
    """A metric that is compared: name, label of its axis, factor to the unit shown."""

    metric: str
    axis: str
    factor: float = 1.0

    def read(self, run: Run) -> float:
        """Return the metric of a run in the unit shown, NaN where it has none."""
        return self.factor * run.read_metric(self.metric)


COMPARED = (
    _Compared(UNWEIGHTED, "driver RMS\nacceleration [m/s²]"),
    _Compared(COMFORT, "driver Wk-weighted\nacceleration [m/s²]"),
    _Compared(TRAVEL, "suspension RMS\ndisplacement [mm]", 1e3),
    _Compared(SEAT, "SEAT factor\n[-]"),
)
NOTE = "Over the whole run; on the same floor, the smaller the better."


def plot_comparison(runs: Sequence[Run]) -> Figure:
    """Return bars run by run, or lines over the number that is swept, one line for each variant."""
    key = find_swept_number(runs)
    series: dict[str, list[Run]] = {}
    for name, run in zip(naming.label_runs(runs, without=[key]), runs, strict=True):
        series.setdefault(name, []).append(run)
    title = f"Comparison: {naming.make_title(runs)}"
    return _plot_lines(title, key, series) if key and len(series) <= naming.MOST else _plot_bars(title, runs)


def find_swept_number(runs: Sequence[Run]) -> str:
    """Return the key with the most different values among those that are numbers in every run, or nothing."""
    counts = {"": 1}
    for key in runs[0].scenario.label:
        values = [run.scenario.label.get(key) for run in runs]
        if all(map(naming.is_number, values)):
            counts[key] = len(set(values))
    return max(counts, key=lambda key: counts[key])


def _plot_bars(title: str, runs: Sequence[Run]) -> Figure:
    names = naming.label_runs(runs, 32)
    looks, left = naming.choose_looks(runs), style.measure_names(names)
    grid = Grid((ROW * len(runs) + 0.1,) * 2, columns=2, left=left, bottom=0.65, gap=(0.2, 0.75))
    page = style.make_page(title, NOTE, grid)
    for k, (axes, compared) in enumerate(zip(page.list_panels(), COMPARED, strict=True)):
        values = list(map(compared.read, runs))
        texts = [format_number(value) for value in values]
        style.name_rows(axes, [""] * len(names) if k % 2 else names)
        style.draw_bars(axes, values, [looks[id(run)].colour for run in runs], texts)
        # Room for the figures at the ends of the bars.
        end = (1.0 + 0.45 / grid.width) * float(np.max(np.nan_to_num(values)))
        axes.set(xlim=(0.0, end or 1.0), xlabel=compared.axis)
    return page.figure


def _plot_lines(title: str, key: str, series: dict[str, list[Run]]) -> Figure:
    runs = [run for group in series.values() for run in group]
    of_runs = naming.choose_looks(runs)
    looks = [of_runs[id(group[0])]._replace(label=name) for name, group in series.items()]
    swept = sorted({float(run.scenario.label[key]) for run in runs})
    page = style.make_page(title, NOTE, Grid((1.8, 1.8), 2, left=0.85, gap=(0.9, 0.65)), looks)
    for axes, compared in zip(page.list_panels(), COMPARED, strict=True):
        for look, group in zip(looks, series.values(), strict=True):
            ordered = sorted(group, key=lambda run: float(run.scenario.label[key]))
            places = [float(run.scenario.label[key]) for run in ordered]
            style.draw_line(axes, places, list(map(compared.read, ordered)), look._replace(width=1.6, mark="o"))
        axes.set(xlabel=naming.label_axis(runs[0].scenario, key), ylabel=compared.axis)
        axes.set_ylim(0, 1.05 * axes.get_ylim()[1])
        if len(swept) <= 4:
            axes.set_xticks(swept)
    return page.figure
