"""What a report is made of, as plain values: sentences, tables, bars, signals, planes.

The template turns them into HTML. Every text is plain text, which it escapes, whatever file it came from.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple


class Text(NamedTuple):
    """A paragraph."""

    text: str
    kind: str = "text"


class Items(NamedTuple):
    """A list of sentences."""

    items: Sequence[str]
    kind: str = "items"


class Code(NamedTuple):
    """A command, or another text to be copied; `label` names it to who hears the page."""

    text: str
    label: str = "Command"
    kind: str = "code"


class Table(NamedTuple):
    """A table: the first columns hold `words`, the others numbers; rows in `strong` stand out.

    A `folded` one shows its caption alone until it is opened, or printed.
    """

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    words: int = 1
    strong: Sequence[int] = ()
    folded: bool = False
    kind: str = "table"


class Bar(NamedTuple):
    """A row of a bar chart: `start` and `end` in per cent of the width, an interval where it is known, and its text."""

    name: str
    start: float
    end: float
    text: str
    look: str = "plain"
    interval: tuple[float, float] | None = None


class Bars(NamedTuple):
    """A bar chart whose rows are those of a table; `heading` and `value` head its names and its figures."""

    title: str
    caption: str
    heading: str
    value: str
    rows: Sequence[Bar]
    kind: str = "bars"


class Matrix(NamedTuple):
    """A table of numbers with shades 0 to 9, a row for each name; an empty text is an empty cell."""

    title: str
    caption: str
    corner: str
    columns: Sequence[str]
    rows: Sequence[tuple[str, Sequence[tuple[str, int]]]]
    kind: str = "matrix"


class Signals(NamedTuple):
    """Linked pictures over time or frequency, packed for the script that draws them; `panels`: title, sentence."""

    identity: str
    caption: str
    runs: Sequence[str]
    lines: Sequence[tuple[str, int]]
    panels: Sequence[tuple[str, str]]
    data: Mapping[str, Any]
    kind: str = "signals"


class Tick(NamedTuple):
    """A mark of an axis: its place in per cent from the start, and its text."""

    at: float
    text: str


class Shape(NamedTuple):
    """A path of a plane in a square of 1000 by 1000, drawn in look 0 to 7 as a line or as dots, or a cell's shade."""

    path: str
    look: int
    form: str = "line"


class Plane(NamedTuple):
    """A picture of one quantity over another, drawn as SVG: loops, clouds of points, maps."""

    title: str
    caption: str
    x_axis: str
    y_axis: str
    x_ticks: Sequence[Tick]
    y_ticks: Sequence[Tick]
    shapes: Sequence[Shape]
    legend: Sequence[tuple[str, int, str]]
    empty: str = ""
    kind: str = "plane"


class Facets(NamedTuple):
    """Planes of one figure, each under its title, with one legend."""

    title: str
    caption: str
    planes: Sequence[Plane]
    legend: Sequence[tuple[str, int, str]]
    kind: str = "facets"


Block = Text | Items | Code | Table | Bars | Matrix | Signals | Plane | Facets


class Section(NamedTuple):
    """A part of the report: its anchor, heading and blocks; one without blocks is left out."""

    anchor: str
    heading: str
    blocks: Sequence[Block]


class Report(NamedTuple):
    """A report: what it is on, a badge (look, words, explanation), the answer, what to do next, the sections."""

    about: str
    answer: str
    lead: Sequence[str]
    next_steps: Sequence[str]
    sections: Sequence[Section]
    badge: tuple[str, str, str] | None = None
