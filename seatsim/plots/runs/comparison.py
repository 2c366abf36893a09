"""Comfort and travel of several runs side by side: bars, or lines over a swept number."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.plots import style
from seatsim.plots.runs import naming
from seatsim.plots.style import COLOURS, LETTER, Entry, Grid
from seatsim.schema.arrays import Array
from seatsim.simulation.result import Run


class Compared(NamedTuple):
    """A metric that is compared: name, label of its axis, factor to the unit shown, decimals."""

    metric: str
    axis: str
    factor: float = 1.0
    decimals: int = 2


COMPARED = (
    Compared("driver_acceleration_rms", "driver RMS\nacceleration [m/s²]"),
    Compared("driver_acceleration_weighted", "driver Wk-weighted\nacceleration [m/s²]"),
    Compared("suspension_displacement_rms", "suspension RMS\ndisplacement [mm]", 1e3, 1),
    Compared("seat_factor", "SEAT factor\n[-]"),
)
NOTE = "Over the whole run; the smaller the better."
BAR = 0.32
"""Height of a bar with its gap in inches."""
LONGEST = 34
"""Letters of the name of a bar."""


def plot_comparison(runs: Sequence[Run]) -> Figure:
    """Return bars run by run, or lines over the number that is swept, one line for each variant."""
    key = find_swept_number(runs)
    lines = _group_lines(runs, key)
    return _plot_lines(key, lines) if key and len(lines) <= naming.MOST else _plot_bars(runs)


def find_swept_number(runs: Sequence[Run]) -> str:
    """Return the key with the most different values among those that are numbers in every run, or nothing."""
    counts = {}
    for key in runs[0].scenario.label:
        values = [run.scenario.label.get(key) for run in runs]
        if all(naming.is_number(value) for value in values):
            counts[key] = len(set(values))
    best = max(counts, key=lambda key: counts[key], default="")
    return best if counts.get(best, 0) > 1 else ""


def _plot_bars(runs: Sequence[Run]) -> Figure:
    names = naming.label_runs(runs, LONGEST)
    many = len(runs) > naming.MOST
    colours = [COLOURS[0]] * len(runs) if many else [entry.colour for entry in style.make_entries(names)]
    left = 0.35 + LETTER * max(len(name) for name in names)
    height = BAR * len(runs) + 0.2
    grid = Grid((height,), columns=len(COMPARED), left=left, bottom=0.75, gap=(0.25, 0.0))
    page = style.make_page(f"Comparison: {naming.make_title(runs)}", NOTE, grid)
    for axes, compared in zip(page.rows[0], COMPARED, strict=True):
        _draw_bars(axes, _read_metric(runs, compared), compared, colours)
    page.rows[0][0].set_yticks(range(len(runs)), names, fontsize=10)
    for axes in page.rows[0][1:]:
        axes.set_yticks([])
    return page.figure


def _draw_bars(axes: Axes, values: Array, compared: Compared, colours: Sequence[str]) -> None:
    bars = axes.barh(np.arange(len(values)), np.nan_to_num(values), height=0.62, color=colours)
    texts = [f"{value:.{compared.decimals}f}" if np.isfinite(value) else "none" for value in values]
    axes.bar_label(bars, texts, padding=3, fontsize=9.5)
    longest = float(np.max(np.nan_to_num(values)))
    axes.set_xlim(0.0, 1.3 * longest or 1.0)
    axes.set_ylim(len(values) - 0.4, -0.6)
    axes.grid(False, axis="y")
    axes.locator_params(axis="x", nbins=4)
    axes.set_xticks([tick for tick in axes.get_xticks() if tick <= longest])
    axes.set_xlabel(compared.axis)


def _group_lines(runs: Sequence[Run], key: str) -> dict[str, list[Run]]:
    """Return the runs that differ in nothing but the swept number, by what else sets them apart."""
    series: dict[str, list[Run]] = {}
    for name, run in zip(naming.label_runs(runs, without=key), runs, strict=True):
        series.setdefault(name, []).append(run)
    return series


def _plot_lines(key: str, series: dict[str, list[Run]]) -> Figure:
    runs = [run for group in series.values() for run in group]
    looks = style.make_entries(list(series))
    swept = sorted({float(run.scenario.label[key]) for run in runs})
    page = style.make_page(f"Comparison: {naming.make_title(runs)}", NOTE, Grid((2.5, 2.5), 2, gap=(0.95, 0.7)), looks)
    panels = [axes for row in page.rows for axes in row]
    for axes, compared in zip(panels, COMPARED, strict=True):
        for look, group in zip(looks, series.values(), strict=True):
            _draw_curve(axes, group, key, compared, look)
        axes.set_xlabel(naming.label_axis(runs[0].scenario, key))
        axes.set_ylabel(compared.axis)
        axes.set_ylim(0, 1.05 * axes.get_ylim()[1])
        if len(swept) <= naming.MOST:
            axes.set_xticks(swept)
    return page.figure


def _draw_curve(axes: Axes, runs: Sequence[Run], key: str, compared: Compared, look: Entry) -> None:
    ordered = sorted(runs, key=lambda run: float(run.scenario.label[key]))
    swept, values = [float(run.scenario.label[key]) for run in ordered], _read_metric(ordered, compared)
    style.draw_line(axes, swept, values, look._replace(width=1.6))
    axes.plot(swept, values, "o", color=look.colour, markersize=4.5)


def _read_metric(runs: Sequence[Run], compared: Compared) -> Array:
    """Return the metric of every run; NaN where it has none."""
    found = [run.metrics[compared.metric].value if compared.metric in run.metrics else np.nan for run in runs]
    return compared.factor * np.array(found)
