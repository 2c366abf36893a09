"""The common look of all pictures: colours, pages with fixed margins, legends above the panels.

Pages are laid out in inches: that costs nothing, where matplotlib's own layout engines draw every text first.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

WIDTH = 10.0
MARGIN = 0.15
LETTER = 0.082
"""Width of a letter of a legend in inches, on average."""
LINE = 0.23
"""Height of a line of text in inches."""
GREY = "0.6"
DARK = "0.25"
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#882255", "#000000")
"""Okabe and Ito's palette for all kinds of colour vision, with wine in place of its yellow, which fades on white."""
DASHES = ("-", "--")
"""The first half of the palette is drawn solid, the second dashed, so that colour is never the only difference."""


class Entry(NamedTuple):
    """A line of a picture: what the legend calls it, and how it looks."""

    label: str
    colour: str
    dashes: str = "-"
    width: float = 1.3
    alpha: float = 1.0


class Page(NamedTuple):
    """A figure with its panels, row by row."""

    figure: Figure
    rows: list[list[Axes]]


class Grid(NamedTuple):
    """Sizes in inches: height of the panels of each row, margins, and gaps between columns and rows."""

    heights: Sequence[float]
    columns: int = 1
    left: float = 0.95
    right: float = 0.2
    gap: tuple[float, float] = (0.85, 0.75)


def entries(labels: Sequence[str]) -> list[Entry]:
    """Return one distinct look for each of up to eight runs; further ones begin anew."""
    half = len(COLOURS) // 2
    return [
        Entry(label, COLOURS[index % len(COLOURS)], DASHES[index % len(COLOURS) // half])
        for index, label in enumerate(labels)
    ]


def scale(name: str, count: int) -> list[str]:
    """Return `count` colours in the order of a quantity; the light end of the colour map is left out."""
    last = max(1, count - 1)
    codes = [colormaps[name](0.85 * index / last, bytes=True) for index in range(count)]
    return ["#" + "".join(f"{int(part):02x}" for part in code[:3]) for code in codes]


def page(title: str, note: str, grid: Grid, legend: Sequence[Entry] = ()) -> Page:
    """Return a figure with a title, a note below it, a legend of one entry or more, and empty panels."""
    columns = _legend_columns(legend)
    lines = -(-len(legend) // columns)
    header = MARGIN + 0.3 + LINE * note.count("\n") + (LINE if note else 0) + LINE * lines + 0.2
    gaps = grid.gap[1] * (len(grid.heights) - 1)
    height = header + sum(grid.heights) + gaps + 0.6
    figure = Figure(figsize=(WIDTH, height))
    left = MARGIN / WIDTH
    figure.text(left, 1 - MARGIN / height, title, fontsize=12, fontweight="bold", va="top")
    figure.text(left, 1 - (MARGIN + 0.27) / height, note, fontsize=10, color=DARK, va="top", linespacing=1.3)
    if legend:
        figure.legend(
            handles=[_handle(entry) for entry in legend], ncols=columns, loc="lower left", frameon=False,
            bbox_to_anchor=(left, 1 - (header - 0.12) / height), borderaxespad=0, borderpad=0,
        )  # fmt: skip
    return Page(figure, _panels(figure, grid, header, height))


def line(axes: Axes, x: object, y: object, entry: Entry) -> None:
    """Draw a line with the look of its entry."""
    axes.plot(
        x, y, color=entry.colour, linestyle=entry.dashes, linewidth=entry.width, alpha=entry.alpha, label=entry.label
    )  # type: ignore[arg-type]


def beside(axes: Axes, title: str) -> None:
    """Put the legend of a panel to its right."""
    axes.legend(
        title=title, loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False, borderaxespad=0, alignment="left"
    )


def say(axes: Axes, text: str) -> None:
    """Write into the middle of a panel why it is empty."""
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", fontsize=11, color=DARK)


def _handle(entry: Entry) -> Line2D:
    return Line2D(
        [], [], color=entry.colour, linestyle=entry.dashes, linewidth=entry.width + 0.5, alpha=entry.alpha,
        label=entry.label,
    )  # fmt: skip


def _legend_columns(legend: Sequence[Entry]) -> int:
    longest = max((len(entry.label) for entry in legend), default=1)
    fitting = int((WIDTH - 2 * MARGIN) / (LETTER * longest + 0.7))
    return max(1, min(len(legend), fitting))


def _panels(figure: Figure, grid: Grid, header: float, height: float) -> list[list[Axes]]:
    width = (WIDTH - grid.left - grid.right - grid.gap[0] * (grid.columns - 1)) / grid.columns
    rows, top = [], height - header
    for tall in grid.heights:
        places = [
            (grid.left + column * (width + grid.gap[0]), top - tall, width, tall) for column in range(grid.columns)
        ]
        rows.append([_panel(figure, x / WIDTH, y / height, w / WIDTH, h / height) for x, y, w, h in places])
        top -= tall + grid.gap[1]
    return rows


def _panel(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    axes = figure.add_axes((left, bottom, width, height))
    axes.grid(True, color="0.9", linewidth=0.7)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=9.5)
    return axes
