"""The model discrepancy where the cause is unknown: over time, and over velocity, displacement and current."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.result import Diagnosis
from seatsim.metrics import rms
from seatsim.plots import style
from seatsim.plots.diagnosis.bins import bin_edges, bin_mean, find_window, varies
from seatsim.plots.diagnosis.maps import OVER, PROFILE
from seatsim.plots.frame import FONT, Picture, Quantity, describe_quantity, make_frame
from seatsim.plots.style import COLOURS, Entry, Grid
from seatsim.plots.thinning import Array, thin_line

CLOSE_UP = 4.0
"""Length in s of the closer look."""
DOTS = 4000
"""Samples that are drawn; more hide each other."""
CAPTION = (
    "Dots: samples. Lines: means in bins. Explained: share of the variance, by one mean (curve) or by one for each"
    " direction (loop)."
)
MISSING = Entry("", COLOURS[6], width=1.1)
RISING = Entry("mean while it rises", COLOURS[0], width=2.0)
FALLING = Entry("mean while it falls", COLOURS[1], (0.0, (5.0, 1.5)), width=2.0)


def plot_discrepancy(diagnosis: Diagnosis) -> list[Picture]:
    """Return pictures of the signal that would close the gap: whole and close up, and over what may drive it."""
    found = diagnosis.evidence.discrepancy
    if found is None or len(found.values) < 2:
        return []
    time, values = found.time, found.values
    shown = describe_quantity(found.quantity, found.unit)
    pictures = [_plot_time(time, shown.factor * values, shown)]
    against = _find_abscissas(diagnosis.evidence.motion, len(values))
    return pictures + [_plot_over(x, shown.factor * values, OVER.get(name), name, shown) for name, x in against.items()]


def _find_abscissas(motion: Mapping[str, Array], length: int) -> dict[str, Array]:
    """Return the quantities that the discrepancy is drawn over: those that vary and have its `length`."""
    return {name: values for name, values in motion.items() if len(values) == length and varies(values)}


def _plot_time(time: Array, values: Array, shown: Quantity) -> Picture:
    page = make_frame(Grid((1.3, 1.3), left=0.9, right=0.25, top=0.1, bottom=0.5, gap=(0.0, 0.35)))
    [upper], [lower] = page.rows
    window = find_window(time, values, CLOSE_UP)
    inside = (time >= window.start) & (time <= window.end)
    style.draw_line(upper, *thin_line(time, values), MISSING._replace(width=0.8))
    style.draw_line(lower, time[inside], values[inside], MISSING)
    upper.axvspan(*window, color="0.92", zorder=0)
    upper.set_xlim(time[0], time[-1])
    lower.set_xlim(*window)
    lower.set_xlabel("time [s]", fontsize=FONT)
    for axes in (upper, lower):
        axes.set_ylabel(f"missing\n[{shown.unit}]", fontsize=FONT)
        axes.axhline(0.0, color="0.6", linewidth=0.8, zorder=0.5)
    title = (
        f"Missing {shown.words}: {rms(values):.3g} {shown.unit} RMS, up to {np.max(np.abs(values)):.3g} {shown.unit}"
    )
    return Picture(title, f"Above: the held-out run. Below: {window}, where it is greatest.", page.figure)


def _plot_over(x: Array, values: Array, axis: Quantity | None, name: str, shown: Quantity) -> Picture:
    """Return samples over a quantity, with means in bins where it rises and where it falls."""
    axis = axis or Quantity(name.replace("_", " "), "-")
    scaled = axis.factor * x
    page = make_frame(Grid((2.1,), left=0.9, right=0.25, top=0.1, bottom=0.5), [RISING, FALLING])
    axes = page.rows[0][0]
    every = -(-len(values) // DOTS)
    axes.scatter(scaled[::every], values[::every], s=4, linewidths=0, color="0.72", zorder=1)
    borders = bin_edges(scaled, PROFILE)
    rising = np.gradient(scaled) > 0
    for part, look in ((rising, RISING), (~rising, FALLING)):
        style.draw_line(axes, 0.5 * (borders[1:] + borders[:-1]), bin_mean(scaled[part], values[part], borders), look)
    axes.set_xlabel(axis.axis, fontsize=FONT)
    axes.set_ylabel(f"missing [{shown.unit}]", fontsize=FONT)
    title = f"Over {axis.words}: {_describe_shares(scaled, values, rising, borders)}"
    return Picture(title, CAPTION, page.figure)


def _describe_shares(scaled: Array, values: Array, rising: NDArray[np.bool_], borders: Array) -> str:
    """Return the shares of the discrepancy that means over a quantity explain, without and with its direction."""
    alone = _explained_share([np.ones_like(rising)], scaled, values, borders)
    directed = _explained_share([rising, ~rising], scaled, values, borders)
    return f"a curve explains {100 * alone:.0f} %, a loop {100 * directed:.0f} %"


def _explained_share(parts: list[NDArray[np.bool_]], scaled: Array, values: Array, borders: Array) -> float:
    """Return the share of the variance that means in bins explain, 1 - sum (x - mean)^2 / sum (x - mean of all)^2.

    parts: masks of samples, shape (N,), each of which has means of its own.
    """
    bins = np.clip(np.searchsorted(borders, scaled) - 1, 0, len(borders) - 2)
    left = 0.0
    for part in parts:
        count, total = np.bincount(bins[part]), np.bincount(bins[part], values[part])
        left += float(np.sum((values[part] - (total / np.maximum(count, 1))[bins[part]]) ** 2))
    spread = float(np.sum((values - np.mean(values)) ** 2))
    return max(0.0, 1.0 - left / spread) if spread > 0 else 0.0
