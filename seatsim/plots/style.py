"""The common look of all pictures: colours, pages with fixed margins, legends above the panels, scales, texts.

Pages are laid out in inches: that costs nothing, where matplotlib's own layout engines draw every text first. A page is
as wide as a telephone shows it legibly; a screen shows two side by side.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import cycle
from textwrap import wrap
from typing import Literal, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, to_hex
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator, ScalarFormatter
from matplotlib.typing import LineStyleType
from numpy.typing import ArrayLike

from seatsim.metrics.table import METRICS, SHORT
from seatsim.schema.printing import LONGEST, MINUS, RAISED, Quantity, describe_channel, shorten
from seatsim.schema.text import name_some

WIDTH = 5.8
"""Width of a page in inches."""
_MARGIN = 0.12
LETTER, _BOLD = 0.074, 0.1
"""Width of a letter of 9.5 points, and of one of a title, in inches, on average."""
SAMPLE = 0.62
"""Width of a legend's sample of a line, with the gaps around it, in inches."""
LINE = 0.21
"""Height of a line of text in inches."""
NOTE = int(WIDTH / 0.0725)
"""Letters of a line of a note, in which few are wide."""
FONT = 9.5
"""Size of text in points."""
GREY, DARK = "0.6", "0.25"
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#882255", "#000000")
"""Okabe and Ito's palette for all kinds of colour vision; wine replaces its yellow, which fades on white."""
DASHES: tuple[LineStyleType, ...] = ("-", (0.0, (5.0, 1.5)), (0.0, (7.0, 1.5, 1.5, 1.5)))
"""Neighbours differ in their dashes, and so do the two blues and the two reds: colour is not the only difference."""
AREA = "0.91"
"""Grey of areas, such as a band of noise; a wide line of a legend names one."""
_WIDER, _WIDEST, _APART, _PALE = 2.0, 6.0, 0.8, 0.45
"""Of lines on each other: points by which each is wider than the next, at most in all, at least; their opacity."""
_MUCH, _ENOUGH = 1 / 2, 10
"""Share of two lines, of that many points at least, on each other from which on a note says so; one hides the other."""
_NUMBER, _FEW = 0.6, 3
"""Width in inches of a number along an axis, such as -0.025, with the space to the next; how many are few."""
_TICK = (0.4, 0.2)
"""Least distance of the numbers of a logarithmic axis in inches, along and up."""
_FREQUENCIES = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000)
"""Hz at which an axis begins."""


class Entry(NamedTuple):
    """An entry of a legend: what it calls a line, and how that line looks; width in points, `alpha` its opacity.

    `mark` is a marker of matplotlib.
    """

    label: str
    colour: str
    dashes: LineStyleType = "-"
    width: float = 1.4
    alpha: float = 1.0
    mark: str = ""


OWN_SCALES = " Each panel has its own scales."
MEASURED = Entry("measured", GREY, width=3.2)
"""Wide and pale: a simulation that agrees lies upon it, and both are seen."""


class Page(NamedTuple):
    """A figure with its panels, row by row."""

    figure: Figure
    rows: list[list[Axes]]

    def list_panels(self, count: int | None = None) -> list[Axes]:
        """Return the panels, row by row; where some are counted, the others are taken out of the page."""
        panels = [axes for row in self.rows for axes in row]
        for axes in [] if count is None else panels[count:]:
            axes.remove()
        return panels[:count]


class Grid(NamedTuple):
    """Sizes in inches: height of each row of panels, margins, gaps between columns and between rows."""

    heights: Sequence[float]
    columns: int = 1
    left: float = 0.9
    right: float = 0.2
    top: float = 0.12
    bottom: float = 0.5
    gap: tuple[float, float] = (0.75, 0.7)

    @property
    def width(self) -> float:
        """Width of a panel in inches."""
        return (WIDTH - self.left - self.right - self.gap[0] * (self.columns - 1)) / self.columns


def describe_metric(name: str) -> Quantity:
    """Return how a metric of a run is shown, in few words."""
    return describe_channel(SHORT.get(name, name), METRICS[name].unit)


class _Numbers(ScalarFormatter):
    """Numbers of an axis; a power of ten that all share stands in its label, before the unit."""

    def set_locs(self, locs: list[float]) -> None:
        super().set_locs(locs)
        if isinstance(self.axis, Axis):
            power = self.get_offset().replace(MINUS, "-").translate(RAISED).replace("¹e", "10") + " "
            self.axis.offsetText.set_visible(False)
            self.axis.label.set_text(re.sub(r"\[(10\S+ )?", f"[{power.lstrip()}", self.axis.label.get_text()))


def clean_text(text: str, longest: int = LONGEST) -> str:
    """Return a text of at most `longest` letters that matplotlib prints as it stands.

    Names come from scenarios and recordings. matplotlib would set what stands between two dollar signs as a formula,
    and hides a label that begins with an underscore.
    """
    short = shorten(text, longest)
    return (f" {short}" if short.startswith("_") else short).replace("$", r"\$")


def make_entries(labels: Sequence[str]) -> list[Entry]:
    """Return a look for each of some lines: after eight the colours begin anew, with other dashes."""
    return [Entry(*look) for look in zip(labels, cycle(COLOURS), cycle(DASHES), strict=False)]


def shade(name: str) -> ListedColormap:
    """Return a colour map without its light end, which is pale on white."""
    return ListedColormap(colormaps[name](np.linspace(0.0, 0.85, 256)))


def sample_colours(name: str, count: int) -> list[str]:
    """Return `count` colours of a colour map in the order of a quantity."""
    return [to_hex(code) for code in shade(name)(np.linspace(0.0, 1.0, count))]


def make_page(title: str, note: str, grid: Grid, legend: Sequence[Entry] = ()) -> Page:
    """Return a figure with a title, a note, a legend where there are entries, and empty panels.

    The height follows from what stands on the page, so that no panel shrinks where a legend grows. The two texts of the
    figure are title and note: a report takes them out, and prints them beside the picture.
    """
    lines = [_break(clean_text(text, 400), most) for text, most in ((title, int(WIDTH / _BOLD)), (note, NOTE))]
    head, columns = measure_head(*map(len, lines)), _count_columns(legend)
    top = head + LINE * -(-len(legend) // columns) + grid.top
    height = top + sum(grid.heights) + grid.gap[1] * (len(grid.heights) - 1) + grid.bottom
    figure, left = Figure(figsize=(WIDTH, height)), _MARGIN / WIDTH
    figure.text(left, 1 - _MARGIN / height, "\n".join(lines[0]), fontsize=11.5, fontweight="bold", va="top")
    below = _MARGIN + LINE * (len(lines[0]) + 0.15)
    figure.text(left, 1 - below / height, "\n".join(lines[1]), fontsize=FONT, color=DARK, va="top")
    # Samples are a little wider than the lines, so that their colours are seen.
    handles = [_dress(Line2D([], []), entry._replace(width=entry.width + 0.5), 64) for entry in legend]
    if legend:
        figure.legend(
            handles=handles, ncols=columns, loc="upper left", bbox_to_anchor=(left, 1 - head / height), frameon=False,
            fontsize=FONT, borderaxespad=0, borderpad=0, columnspacing=1.2, handlelength=2.0, labelspacing=0.35,
        )  # fmt: skip
    return Page(figure, _add_panels(figure, grid, height - top))


def _break(text: str, letters: int) -> list[str]:
    """Return the lines of a cleaned text; names in quotation marks stay whole, as do a figure and its sign."""
    text = re.sub("“[^”]*”", lambda name: name[0].replace(" ", "\u00a0"), text)
    return wrap(text.replace(" %", "\u00a0%").replace(" °", "\u00a0°"), letters, break_on_hyphens=False)


def measure_head(title: int, note: int) -> float:
    """Return the height in inches of a title and a note of that many lines, which stand above everything else."""
    return _MARGIN + LINE * (title + note) + 0.12


def draw_line(axes: Axes, x: ArrayLike, y: ArrayLike, look: Entry) -> Line2D:
    """Draw the line through (x, y), shape (N,) each, with the look of its entry; return it.

    Dashes lie upon solid lines, which are seen between them.
    """
    [line] = axes.plot(np.asarray(x), np.asarray(y), zorder=2.0 if look.dashes == "-" else 2.1)
    return _dress(line, look, LONGEST)


def add_colour_bar(axes: Axes, drawn: ScalarMappable, label: str, extend: str = "neither") -> Axes:
    """Return the axes of a new bar of the colours in which something is drawn, to the right of a panel.

    It ends in a tip where larger values have the last colour, `extend="max"`.
    """
    box = axes.get_position()
    beside = axes.figure.add_axes((box.x1 + 0.025, box.y0, 0.025, box.height))
    bar = axes.figure.colorbar(drawn, cax=beside, label=label, extend=extend, format=_Numbers())
    if bar.solids is not None:
        # Dots may be translucent.
        bar.solids.set_alpha(1.0)
    return beside


def name_coincident(figure: Figure) -> Figure:
    """Return a finished figure whose note names lines that lie on each other, and those that its scales leave out.

    It says in which panels, where that is not so in all that these lines share; else those on each other are all seen.
    """
    # matplotlib gives lines of its own a label that begins with an underscore.
    named = [{n: line for line in axes.lines if (n := str(line.get_label())) and n[0] != "_"} for axes in figure.axes]
    found, sentences = dict[tuple[str, ...], list[Axes]](), list[str]()
    for axes, lines in zip(figure.axes, named, strict=True):
        listed = list[list[str]]()
        for least, said in ((1.0, "{} coincide{}."), (_MUCH, "{} coincide over half of their length or more{}.")):
            groups: dict[str, list[str]] = {}
            for name, line in lines.items():
                is_seen = bool(np.any(np.asarray(line.get_ydata(), float) >= axes.get_ylim()[0]))
                alike = (first for first in groups if first and _measure_overlap(lines[first], line) >= least)
                groups.setdefault(next(alike, name) if is_seen else "", []).append(name)
            for first, group in groups.items():
                if (len(group) > 1 or not first) and group not in listed:
                    key = (said if first else "Nothing of {} lies within the scales{}.", *group)
                    found.setdefault(key, []).append(axes)
            listed += groups.values()
    for (words, *group), panels in found.items():
        is_shared = len(panels) == sum(set(group) <= set(lines) for lines in named)
        where = "" if is_shared else f" ({', '.join(dict.fromkeys(map(_name_panel, panels)))})"
        sentences.append(words.format(name_some([f"“{name.strip()}”" for name in group]), where))
        if is_shared and "coincide{}" in words:
            _nest_lines(figure, group)
    _lengthen_note(figure, " ".join(sentences))
    return figure


def _name_panel(axes: Axes) -> str:
    """Return the title of a panel, or else what an axis of it is called, without the unit."""
    return " ".join((axes.get_title(loc="left") or axes.get_ylabel() or axes.get_xlabel()).partition("[")[0].split())


def _nest_lines(figure: Figure, group: Sequence[str]) -> None:
    """Make lines that lie on each other solid, the last one thin and the others pale, the earlier the wider.

    Those whose looks already are so stay as they are.
    """
    lines = {name: [line for axes in figure.axes for line in axes.lines if line.get_label() == name] for name in group}
    if max(np.diff([lines[name][0].get_linewidth() for name in group])) < -_APART:
        return
    for legend in figure.findobj(Legend):
        for text, sample in zip(legend.get_texts(), legend.legend_handles, strict=True):
            if isinstance(sample, Line2D) and text.get_text() in lines:
                lines[text.get_text()].append(sample)
    step = min(_WIDER, _WIDEST / (len(group) - 1))
    for rank, line in ((rank, line) for rank, name in enumerate(reversed(group)) for line in lines[name]):
        line.set(linestyle="-" if line.is_dashed() else line.get_linestyle(), linewidth=1.0 + step * rank)
        line.set(markersize=line.get_markersize() + step * rank, zorder=2.0 - 0.01 * rank)
        line.set_alpha(_PALE if rank else 1.0)


def _measure_overlap(one: Line2D, other: Line2D) -> float:
    """Return which share of the points of a line is as near to one of another as the wider one is wide.

    Both have as many points. Of lines that differ in width, or that have few points, both are seen unless all are near.
    """
    first, second = (line.get_transform().transform(line.get_xydata()) * 72 / line.figure.dpi for line in (one, other))
    if first.shape != second.shape or len(first) < 2:
        return 0.0
    known = np.isfinite(first).all(axis=1), np.isfinite(second).all(axis=1)
    # A thinned line has the least and the largest value of an interval in either order.
    apart = np.fmin.reduce([np.max(np.abs(first - np.roll(second, k, axis=0)), axis=1) for k in (-1, 0, 1)])
    widths = one.get_linewidth(), other.get_linewidth()
    near = apart[known[0] & known[1]] <= max(widths)
    if bool(np.all(near)) and np.array_equal(*known):
        return 1.0
    is_hidden = abs(widths[0] - widths[1]) < 0.5 * _APART and len(near) >= _ENOUGH
    return 0.99 * float(np.mean(near)) if is_hidden else 0.0


def _lengthen_note(figure: Figure, sentence: str) -> None:
    """Put sentences of cleaned names behind the note of a figure, which grows; all else keeps its size."""
    note, old = figure.texts[1], float(figure.get_figheight())
    before = note.get_text().splitlines()
    lines = _break(" ".join([*before, sentence]), NOTE)
    new = old + LINE * (len(lines) - len(before))
    anchors = [legend.get_bbox_to_anchor().transformed(figure.transFigure.inverted()) for legend in figure.legends]
    note.set_text("\n".join(lines))
    figure.set_figheight(new)
    for axes in figure.axes:
        left, bottom, width, height = axes.get_position().bounds
        axes.set_position((left, bottom * old / new, width, height * old / new))
    for text in figure.texts:
        text.set_y(1 - (1 - text.get_position()[1]) * old / new)
    for legend, anchor in zip(figure.legends, anchors, strict=True):
        legend.set_bbox_to_anchor((anchor.x0, anchor.y0 * old / new))


def set_title(axes: Axes, text: str) -> None:
    """Put a title above a panel, as wide as the panel at most."""
    longest = int(axes.get_position().width * WIDTH / LETTER)
    axes.set_title(clean_text(text, longest), loc="left", fontsize=FONT)


def scale_log(axes: Axes, which: Literal["x", "y"], low: float, high: float) -> None:
    """Make an axis logarithmic from `low` to `high`: with numbers within a decade where there is room."""
    axes.set(**{f"{which}scale": "log", f"{which}lim": (low, high)})
    axis, k = (axes.xaxis, 0) if which == "x" else (axes.yaxis, 1)
    most = max(2, int(axes.bbox.size[k] / axes.figure.dpi / _TICK[k]))
    is_plain = low > 2e-4 and high < 5e4
    # Powers of ten with a factor read badly: they stand where decades alone would be too few.
    room = np.log10(high / low) / (most if is_plain else 0.5 * most)
    finest = ((1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8), (1, 1.5, 2, 3, 5, 7)) if high < 10 * low else ()
    subs = next((subs for subs in (*finest, (1, 2, 5), (1, 3)) if room * len(subs) <= 1), (1,))
    axis.set_major_locator(LogLocator(subs=subs, numticks=most))
    axis.set_major_formatter("{x:g}" if is_plain else _write_power)
    axis.set_minor_locator(NullLocator())


def scale_frequency_axis(axes: Axes, low: float, high: float) -> None:
    """Make the lower axis of a panel one of frequency in Hz, logarithmic, from a named frequency to the highest."""
    low = max((tick for tick in _FREQUENCIES if tick <= low < high), default=_FREQUENCIES[0])
    scale_log(axes, "x", low, high)
    axes.set_xlabel("frequency [Hz]")


def number_places(axes: Axes, places: Sequence[float]) -> None:
    """Write the numbers of rising places along a panel where there is room for each; else round numbers stay."""
    room = np.min(np.diff(places), initial=np.inf) / np.ptp(axes.get_xlim()) * axes.get_position().width * WIDTH
    if room > LETTER * (2 + max(len(f"{place:g}") for place in places)):
        axes.set_xticks(places)


def measure_names(names: Sequence[str]) -> float:
    """Return the width in inches that the names of rows need."""
    return 0.3 + LETTER * min(32, max(map(len, names), default=0))


def explain_empty(axes: Axes, text: str) -> None:
    """Write into the middle of a panel why it is empty."""
    axes.set(xticks=[], yticks=[])
    lines = wrap(text, int(axes.get_position().width * WIDTH / LETTER))
    axes.text(0.5, 0.5, "\n".join(lines), transform=axes.transAxes, ha="center", va="center", color=DARK)


def _dress(line: Line2D, look: Entry, longest: int) -> Line2D:
    """Return a line with the look of an entry, and its label in at most `longest` letters."""
    line.set(color=look.colour, linestyle=look.dashes, linewidth=look.width, alpha=look.alpha, marker=look.mark)
    line.set(label=clean_text(look.label, longest), solid_capstyle="butt")
    return line


def _write_power(value: float, _position: object) -> str:
    """Return a number in powers of ten, as all numbers of an axis of many decades are."""
    exponent = int(np.floor(np.log10(value) + 1e-9))
    if exponent in (0, 1):
        return f"{value:g}"
    return f"{value / 10.0**exponent:g}×10".removeprefix("1×") + str(exponent).translate(RAISED)


def _count_columns(legend: Sequence[Entry]) -> int:
    """Return the most columns that fit; the legend fills them one by one, the first ones fullest."""
    letters = [min(64, len(entry.label)) for entry in legend]
    for count in range(len(letters), 1, -1):
        widths = [LETTER * max(column) + SAMPLE for column in np.array_split(letters, count)]
        if sum(widths) <= WIDTH - 2 * _MARGIN:
            # No more columns than the rows need: an order by columns is read wrong where some are much shorter.
            return -(-len(letters) // -(-len(letters) // count))
    return 1


def _add_panels(figure: Figure, grid: Grid, top: float) -> list[list[Axes]]:
    """Return new axes in a grid, row by row, from `top` inches above the foot of a figure."""
    height, rows = float(figure.get_figheight()), []
    for tall in grid.heights:
        lefts = [grid.left + column * (grid.width + grid.gap[0]) for column in range(grid.columns)]
        boxes = [(x / WIDTH, (top - tall) / height, grid.width / WIDTH, tall / height) for x in lefts]
        rows.append([_add_panel(figure, box) for box in boxes])
        top -= tall + grid.gap[1]
    return rows


def _add_panel(figure: Figure, place: tuple[float, float, float, float]) -> Axes:
    """Return new axes with round numbers, as many as there is room for."""
    axes = figure.add_axes(place)
    axes.grid(True, color="0.9", linewidth=0.7)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=FONT)
    along = max(2, int(axes.bbox.width / axes.figure.dpi / _NUMBER))
    # Of few numbers, multiples of 3 are often the only ones on both sides of 0.
    steps = (1, 2, 5, 10) if along > _FEW else (1, 2, 3, 5, 10)
    axes.xaxis.set_major_locator(MaxNLocator(along, steps=steps))
    axes.yaxis.set_major_locator(MaxNLocator("auto", steps=(1, 2, 5, 10)))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(_Numbers())
    axes.ticklabel_format(useOffset=False, scilimits=(-3, 6))
    return axes
