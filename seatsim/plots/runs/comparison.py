"""Comfort and travel of several runs side by side: bars, or lines over a swept number."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.plots import style
from seatsim.plots.runs import naming
from seatsim.plots.style import COLOURS, ROW, Entry, Grid
from seatsim.schema.arrays import Array
from seatsim.simulation.result import Run


class _Compared(NamedTuple):
    """A metric that is compared: name, label of its axis, factor to the unit shown, decimals."""

    metric: str
    axis: str
    factor: float = 1.0
    decimals: int = 2


COMPARED = (
    _Compared("driver_acceleration_rms", "driver RMS\nacceleration [m/s²]"),
    _Compared("driver_acceleration_weighted", "driver Wk-weighted\nacceleration [m/s²]"),
    _Compared("suspension_displacement_rms", "suspension RMS\ndisplacement [mm]", 1e3, 1),
    _Compared("seat_factor", "SEAT factor\n[-]"),
)
NOTE = "Over the whole run; the smaller the better."


def plot_comparison(runs: Sequence[Run]) -> Figure:
    """Return bars run by run, or lines over the number that is swept, one line for each variant."""
    key = find_swept_number(runs)
    series: dict[str, list[Run]] = {}
    for name, run in zip(naming.label_runs(runs, without=key), runs, strict=True):
        series.setdefault(name, []).append(run)
    title = f"Comparison: {naming.make_title(runs)}"
    return _plot_lines(title, key, series) if key and len(series) <= naming.MOST else _plot_bars(title, runs)


def find_swept_number(runs: Sequence[Run]) -> str:
    """Return the key with the most different values among those that are numbers in every run, or nothing."""
    counts = {}
    for key in runs[0].scenario.label:
        values = [run.scenario.label.get(key) for run in runs]
        if all(naming.is_number(value) for value in values):
            counts[key] = len(set(values))
    best = max(counts, key=lambda key: counts[key], default="")
    return best if counts.get(best, 0) > 1 else ""


def _plot_bars(title: str, runs: Sequence[Run]) -> Figure:
    names = naming.label_runs(runs, 32)
    many = len(runs) > naming.MOST
    colours = [COLOURS[0]] * len(runs) if many else [entry.colour for entry in style.make_entries(names)]
    left = style.measure_names(names)
    grid = Grid((ROW * len(runs) + 0.1,) * 2, columns=2, left=left, bottom=0.65, gap=(0.2, 0.75))
    page = style.make_page(title, NOTE, grid)
    for row, pair in zip(page.rows, (COMPARED[:2], COMPARED[2:]), strict=True):
        for column, (axes, compared) in enumerate(zip(row, pair, strict=True)):
            values = _read_metric(runs, compared)
            texts = [f"{value:.{compared.decimals}f}" if np.isfinite(value) else "none" for value in values]
            style.name_rows(axes, [""] * len(names) if column else names)
            style.draw_bars(axes, values.tolist(), colours, texts)
            # Room for the figures at the ends of the bars.
            axes.set_xlim(0.0, (1.0 + 0.45 / grid.width) * float(np.max(np.nan_to_num(values))) or 1.0)
            axes.set_xlabel(compared.axis)
    return page.figure


def _plot_lines(title: str, key: str, series: dict[str, list[Run]]) -> Figure:
    runs = [run for group in series.values() for run in group]
    looks = style.make_entries(list(series))
    swept = sorted({float(run.scenario.label[key]) for run in runs})
    page = style.make_page(title, NOTE, Grid((1.8, 1.8), 2, left=0.85, gap=(0.9, 0.65)), looks)
    for axes, compared in zip((axes for row in page.rows for axes in row), COMPARED, strict=True):
        for look, group in zip(looks, series.values(), strict=True):
            _draw_curve(axes, group, key, compared, look)
        axes.set_xlabel(naming.label_axis(runs[0].scenario, key))
        axes.set_ylabel(compared.axis)
        axes.set_ylim(0, 1.05 * axes.get_ylim()[1])
        if len(swept) <= 4:
            axes.set_xticks(swept)
    return page.figure


def _draw_curve(axes: Axes, runs: Sequence[Run], key: str, compared: _Compared, look: Entry) -> None:
    ordered = sorted(runs, key=lambda run: float(run.scenario.label[key]))
    swept, values = [float(run.scenario.label[key]) for run in ordered], _read_metric(ordered, compared)
    style.draw_line(axes, swept, values, look._replace(width=1.6))
    axes.plot(swept, values, "o", color=look.colour, markersize=4.5)


def _read_metric(runs: Sequence[Run], compared: _Compared) -> Array:
    """Return the metric of every run; NaN where it has none."""
    found = [run.metrics[compared.metric].value if compared.metric in run.metrics else np.nan for run in runs]
    return compared.factor * np.array(found)
