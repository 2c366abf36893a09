"""The frame of the narrow pictures of a diagnosis, `WIDTH` inches wide; their titles and captions stand beside them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from seatsim.plots import labels
from seatsim.plots.quantities import FACTORS, Quantity
from seatsim.plots.style import LETTER, LINE, MARGIN, SAMPLE, Entry, Grid, Page, add_panels

WIDTH = 5.8
FONT = 9.5
"""Size of text in points."""


class Picture(NamedTuple):
    """A picture with the heading that says what is to be seen and the caption that says how it is drawn."""

    title: str
    caption: str
    figure: Figure


def format_number(value: float) -> str:
    """Return a number with two significant digits or more, in powers of ten only below 0.0001; with a true minus."""
    return (f"{value:.0f}" if abs(value) >= 9.95 else f"{value:.2g}").replace("-", "−")


def describe_quantity(name: str, unit: str) -> Quantity:
    """Return how a channel in SI units is drawn."""
    factor, shown = FACTORS.get(unit, (1.0, labels.clean_text(labels.format_unit(unit), 20) or "-"))
    return Quantity(labels.clean_text(name.replace("_", " "), 40), shown, factor)


def make_frame(grid: Grid, legend: Sequence[Entry] = (), width: float = WIDTH) -> Page:
    """Return a figure `width` inches wide with a legend above the panels where there are entries, and empty panels."""
    columns = _count_columns(legend, width)
    header = grid.top + (LINE * -(-len(legend) // columns) + 0.08 if legend else 0.0)
    height = header + sum(grid.heights) + grid.gap[1] * (len(grid.heights) - 1) + grid.bottom
    figure = Figure(figsize=(width, height))
    if legend:
        handles = [make_handle(entry) for entry in legend]
        figure.legend(
            handles=handles, ncols=columns, loc="upper left", frameon=False, fontsize=FONT, borderpad=0,
            bbox_to_anchor=(MARGIN / width, 1 - 0.06 / height), borderaxespad=0, columnspacing=1.2, handlelength=2.2,
        )  # fmt: skip
    return Page(figure, add_panels(figure, grid, width, height - header))


def make_handle(look: Entry) -> Line2D:
    """Return the sample of a line for a legend, a little wider than the line, so that its colour is seen."""
    return Line2D(
        [], [], label=look.label, linewidth=look.width + 0.4, color=look.colour, linestyle=look.dashes,
        alpha=look.alpha, marker=look.mark,
    )  # fmt: skip


def name_rows(axes: Axes, names: Sequence[str]) -> None:
    """Make a panel of rows, the first one on top: names instead of a scale, grid lines upright only."""
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_yticks(np.arange(len(names)), [labels.clean_text(name, 34) for name in names], fontsize=FONT)
    axes.grid(False, axis="y")
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)


def draw_bars(axes: Axes, values: ArrayLike, colours: Sequence[str], texts: Sequence[str], at: Sequence[int]) -> None:
    """Draw horizontal bars in the rows `at`, with a text at the end of each."""
    for row, value, colour, text in zip(at, np.asarray(values, dtype=float), colours, texts, strict=True):
        axes.barh(row, value, height=0.66, color=colour, zorder=2)
        axes.annotate(
            text, (max(float(value), 0.0), row), xytext=(4, 0), textcoords="offset points", va="center",
            fontsize=FONT, zorder=3,
        )  # fmt: skip


def _count_columns(legend: Sequence[Entry], width: float) -> int:
    """Return the most columns of a legend that fit into a figure `width` inches wide."""
    for count in range(len(legend), 1, -1):
        rows = [legend[start::count] for start in range(count)]
        if sum(LETTER * max(len(look.label) for look in row) + SAMPLE for row in rows) <= width - 2 * MARGIN:
            return count
    return 1
