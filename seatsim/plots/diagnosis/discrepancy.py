"""What is missing where the cause is unknown: its course in time, and over velocity, displacement and current."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.result import Array, Diagnosis
from seatsim.plots import style
from seatsim.plots.diagnosis.bins import binned_mean, edges, loudest, varies
from seatsim.plots.diagnosis.frame import FONT, Picture, Quantity, frame, quantity
from seatsim.plots.diagnosis.maps import OVER, PROFILE
from seatsim.plots.style import COLOURS, Entry, Grid
from seatsim.plots.thinning import thinned

CLOSE_UP = 4.0
"""Length in s of the closer look."""
DOTS = 4000
CAPTION = (
    "Dots: samples. Lines: means in bins. Explained: share of the variance, by one mean (curve) or by one for each"
    " direction (loop)."
)
LATENT = Entry("", COLOURS[6], width=1.1)
RISING = Entry("mean while it rises", COLOURS[0], width=2.0)
FALLING = Entry("mean while it falls", COLOURS[1], (0.0, (5.0, 1.5)), width=2.0)


def latent(diagnosis: Diagnosis) -> list[Picture]:
    """Return the course of what would close the gap, whole and close up, and over what may drive it."""
    found = diagnosis.evidence.discrepancy
    if found is None or len(found.values) < 2:
        return []
    time, values = found.time, found.values
    shown = quantity(found.quantity, found.unit)
    pictures = [_course(time, shown.factor * values, shown)]
    against = _against(diagnosis, len(values))
    return pictures + [_over(x, shown.factor * values, OVER.get(name), name, shown) for name, x in against.items()]


def _against(diagnosis: Diagnosis, length: int) -> dict[str, Array]:
    """Return what the signal is drawn over: the measured motion of the same rows."""
    motion = diagnosis.evidence.motion
    return {name: values for name, values in motion.items() if len(values) == length and varies(values)}


def _course(time: Array, values: Array, shown: Quantity) -> Picture:
    page = frame(Grid((1.3, 1.3), left=0.9, right=0.25, top=0.1, bottom=0.5, gap=(0.0, 0.35)))
    [upper], [lower] = page.rows
    window = loudest(time, values, CLOSE_UP)
    inside = (time >= window.start) & (time <= window.end)
    style.line(upper, *thinned(time, values), LATENT._replace(width=0.8))
    style.line(lower, time[inside], values[inside], LATENT)
    upper.axvspan(*window, color="0.92", zorder=0)
    upper.set_xlim(time[0], time[-1])
    lower.set_xlim(*window)
    lower.set_xlabel("time [s]", fontsize=FONT)
    for axes in (upper, lower):
        axes.set_ylabel(f"missing\n[{shown.unit}]", fontsize=FONT)
        axes.axhline(0.0, color="0.6", linewidth=0.8, zorder=0.5)
    size = float(np.sqrt(np.mean(values**2)))
    title = f"Missing {shown.words}: {size:.3g} {shown.unit} RMS, up to {np.max(np.abs(values)):.3g} {shown.unit}"
    return Picture(title, f"Above: the held-out run. Below: {window}, where it is greatest.", page.figure)


def _over(x: Array, values: Array, axis: Quantity | None, name: str, shown: Quantity) -> Picture:
    axis = axis or Quantity(name.replace("_", " "), "-")
    scaled = axis.factor * x
    page = frame(Grid((2.1,), left=0.9, right=0.25, top=0.1, bottom=0.5), [RISING, FALLING])
    axes = page.rows[0][0]
    every = -(-len(values) // DOTS)
    axes.scatter(scaled[::every], values[::every], s=4, linewidths=0, color="0.72", zorder=1)
    borders = edges(scaled, PROFILE)
    rising = np.gradient(scaled) > 0
    for part, look in ((rising, RISING), (~rising, FALLING)):
        style.line(axes, 0.5 * (borders[1:] + borders[:-1]), binned_mean(scaled[part], values[part], borders), look)
    axes.set_xlabel(axis.axis, fontsize=FONT)
    axes.set_ylabel(f"missing [{shown.unit}]", fontsize=FONT)
    title = f"Over {axis.words}: {_tells(scaled, values, rising, borders)}"
    return Picture(title, CAPTION, page.figure)


def _tells(scaled: Array, values: Array, rising: NDArray[np.bool_], borders: Array) -> str:
    """Return how much of the course the means over a quantity explain, without and with regard to direction."""
    alone = _explained([np.ones_like(rising)], scaled, values, borders)
    directed = _explained([rising, ~rising], scaled, values, borders)
    return f"a curve explains {100 * alone:.0f} %, a loop {100 * directed:.0f} %"


def _explained(parts: list[NDArray[np.bool_]], scaled: Array, values: Array, borders: Array) -> float:
    """Return the share of the variance that the means in bins explain, each part with means of its own."""
    bins = np.clip(np.searchsorted(borders, scaled) - 1, 0, len(borders) - 2)
    left = 0.0
    for part in parts:
        count, total = np.bincount(bins[part]), np.bincount(bins[part], values[part])
        left += float(np.sum((values[part] - (total / np.maximum(count, 1))[bins[part]]) ** 2))
    spread = float(np.sum((values - np.mean(values)) ** 2))
    return max(0.0, 1.0 - left / spread) if spread > 0 else 0.0
