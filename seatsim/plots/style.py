"""The common look of all figures: colours, pages with fixed margins, legends above the panels.

Pages are laid out in inches: that costs nothing, where matplotlib's own layout engines draw every text first.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple, TypedDict

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import Locator, NullLocator
from matplotlib.typing import LineStyleType
from numpy.typing import ArrayLike

WIDTH = 10.0
"""Width of a page in inches: text of 9 points stays legible where a page of a paper shrinks it to 60 %."""
MARGIN = 0.15
LETTER = 0.082
"""Width of a letter of a legend in inches, on average."""
SAMPLE = 0.7
"""Width of a legend's sample of a line, with the gaps around it, in inches."""
LINE = 0.23
"""Height of a line of text in inches."""
GREY = "0.6"
DARK = "0.25"
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#882255", "#000000")
"""Okabe and Ito's palette for all kinds of colour vision; wine replaces its yellow, which fades on white."""
DASHES: tuple[LineStyleType, ...] = ("-", (0.0, (5.0, 1.5)))
"""Every second line is dashed: two that coincide are both seen, and colour is not the only difference."""


class Entry(NamedTuple):
    """An entry of a legend: what it calls a line, and how that line looks; width in points, `alpha` its opacity."""

    label: str
    colour: str
    dashes: LineStyleType = "-"
    width: float = 1.4
    alpha: float = 1.0
    mark: str = ""


class Page(NamedTuple):
    """A figure with its panels, row by row."""

    figure: Figure
    rows: list[list[Axes]]


class Grid(NamedTuple):
    """Sizes in inches: height of each row of panels, margins, gaps between columns and between rows."""

    heights: Sequence[float]
    columns: int = 1
    left: float = 0.95
    right: float = 0.2
    top: float = 0.2
    bottom: float = 0.6
    gap: tuple[float, float] = (0.85, 0.75)


class _LineProperties(TypedDict):
    """How a line looks, as matplotlib names it."""

    color: str
    linestyle: LineStyleType
    linewidth: float
    alpha: float
    solid_capstyle: Literal["butt"]
    marker: str


def make_entries(labels: Sequence[str]) -> list[Entry]:
    """Return one distinct look for each of up to eight runs; further ones begin anew."""
    return [
        Entry(label, COLOURS[index % len(COLOURS)], DASHES[index % len(DASHES)]) for index, label in enumerate(labels)
    ]


def sample_colours(name: str, count: int) -> list[str]:
    """Return `count` colours of a colour map in the order of a quantity; its light end, pale on white, is left out."""
    last = max(1, count - 1)
    codes = [colormaps[name](0.85 * index / last, bytes=True) for index in range(count)]
    return ["#" + "".join(f"{int(part):02x}" for part in code[:3]) for code in codes]


def make_page(title: str, note: str, grid: Grid, legend: Sequence[Entry] = ()) -> Page:
    """Return a figure with a title, a note, a legend where there are entries, and empty panels.

    The height follows from what stands on the page, so that no panel shrinks where a legend grows.
    """
    columns = _legend_columns(legend)
    header = MARGIN + 0.52 + LINE * -(-len(legend) // columns) + grid.top
    height = header + sum(grid.heights) + grid.gap[1] * (len(grid.heights) - 1) + grid.bottom
    figure = Figure(figsize=(WIDTH, height))
    left = MARGIN / WIDTH
    figure.text(left, 1 - MARGIN / height, title, fontsize=12, fontweight="bold", va="top")
    figure.text(left, 1 - (MARGIN + 0.27) / height, note, fontsize=10, color=DARK, va="top")
    if legend:
        figure.legend(
            handles=[_handle(entry) for entry in legend], ncols=columns, loc="upper left", frameon=False,
            bbox_to_anchor=(left, 1 - (MARGIN + 0.56) / height), borderaxespad=0, borderpad=0,
        )  # fmt: skip
    return Page(figure, add_panels(figure, grid, WIDTH, height - header))


def draw_line(axes: Axes, x: ArrayLike, y: ArrayLike, look: Entry) -> None:
    """Draw the line through (x, y), shape (N,) each, with the look of its entry."""
    axes.plot(np.asarray(x), np.asarray(y), label=look.label, **_style(look))


def draw_legend_beside(axes: Axes, title: str) -> None:
    """Put the legend of a panel to its right."""
    axes.legend(
        title=title, alignment="left", loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False,
        borderaxespad=0,
    )  # fmt: skip


def add_axes_beside(axes: Axes, gap: float, width: float) -> Axes:
    """Return new axes to the right of a panel, as tall as it, for a bar of colours; sizes over the figure's width."""
    box = axes.get_position()
    return axes.figure.add_axes((box.x1 + gap, box.y0, width, box.height))


def set_plain_log_ticks(axis: Axis, locator: Locator) -> None:
    """Label the ticks of a logarithmic axis by plain numbers in place of powers of ten, without ticks between them."""
    axis.set_major_locator(locator)
    axis.set_major_formatter("{x:g}")
    axis.set_minor_locator(NullLocator())


def explain_empty(axes: Axes, text: str) -> None:
    """Write into the middle of a panel why it is empty."""
    axes.set_yticks([])
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", fontsize=11, color=DARK)


def _handle(look: Entry) -> Line2D:
    return Line2D([], [], label=look.label, **_style(look._replace(width=look.width + 0.5)))


def _style(look: Entry) -> _LineProperties:
    return {
        "color": look.colour, "linestyle": look.dashes, "linewidth": look.width, "alpha": look.alpha,
        "solid_capstyle": "butt", "marker": look.mark,
    }  # fmt: skip


def _legend_columns(legend: Sequence[Entry]) -> int:
    """Return the most columns that fit; the legend fills them one by one, the first ones fullest."""
    letters = [len(entry.label) for entry in legend]
    for count in range(len(letters), 1, -1):
        widths = [LETTER * max(column) + SAMPLE for column in np.array_split(letters, count)]
        if sum(widths) <= WIDTH - 2 * MARGIN:
            return count
    return 1


def add_panels(figure: Figure, grid: Grid, width: float, top: float) -> list[list[Axes]]:
    """Return new axes in a grid, row by row, on a figure `width` inches wide, from `top` inches above its foot."""
    height = float(figure.get_figheight())
    wide = (width - grid.left - grid.right - grid.gap[0] * (grid.columns - 1)) / grid.columns
    rows = []
    for tall in grid.heights:
        lefts = [grid.left + column * (wide + grid.gap[0]) for column in range(grid.columns)]
        bottom = (top - tall) / height
        rows.append([_panel(figure, (x / width, bottom, wide / width, tall / height)) for x in lefts])
        top -= tall + grid.gap[1]
    return rows


def _panel(figure: Figure, place: tuple[float, float, float, float]) -> Axes:
    axes = figure.add_axes(place)
    axes.grid(True, color="0.9", linewidth=0.7)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=9.5)
    return axes
