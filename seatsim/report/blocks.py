"""What a report is made of, as plain values: sentences, tables, pictures, signals.

The template turns them into HTML. Every text is plain text, which it escapes, whatever file it came from.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from seatsim.plots.saving import Inline, render_inline
from seatsim.schema.printing import format_number

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Text(NamedTuple):
    """A paragraph."""

    text: str


class Items(NamedTuple):
    """A list of sentences."""

    items: Sequence[str]


class Code(NamedTuple):
    """A command, or another text to be copied; `label` names it to who hears the page."""

    text: str
    label: str = "Command"


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


class Line(NamedTuple):
    """A line of linked pictures: its name, the number of its look, and its opacity."""

    name: str
    look: int
    opacity: float = 1.0


class Signals(NamedTuple):
    """Linked pictures over time, packed for the script that draws them; `panels`: their titles."""

    identity: str
    caption: str
    runs: Sequence[str]
    lines: Sequence[Line]
    panels: Sequence[str]
    data: Mapping[str, object]


class Pictures(NamedTuple):
    """Pictures beside or below each other, as the page has room."""

    pictures: Sequence[Inline]


Figures: TypeAlias = "Mapping[str, Figure]"
"""Figures by name."""
Rows: TypeAlias = Iterable[Iterable[object]]
"""Rows of a table: texts, which are printed as they stand, and numbers."""
Block = Text | Items | Code | Table | Signals | Pictures


class Section(NamedTuple):
    """A part of the report: its anchor, heading and blocks; one without blocks is left out."""

    anchor: str
    heading: str
    blocks: Sequence[Block]


class Report(NamedTuple):
    """A report: what it is on, the answer, what to do next, the sections.

    `badge`: look, words, explanation.
    """

    about: str
    answer: str
    lead: Sequence[str]
    next_steps: Sequence[str]
    sections: Sequence[Section]
    badge: tuple[str, str, str] | None = None


def show_pictures(figures: Figures, *starts: str) -> list[Block]:
    """Return the figures whose names begin with one of some words, in the order of these words."""
    chosen = {name: figure for start in starts for name, figure in figures.items() if name.startswith(start)}
    return [Pictures(list(map(render_inline, chosen.values())))] if chosen else []


def tabulate(
    caption: str,
    head: str | Sequence[str],
    rows: Rows,
    words: int = 1,
    strong: Sequence[int] = (),
    folded: bool = False,
) -> list[Table]:
    """Return a table; nothing where there is no row.

    Args:
        caption: what it shows.
        head: of the columns; as one text they are separated by commas.
        rows: of texts and numbers.
        words: as for `Table`.
        strong: the same.
        folded: the same.
    """
    printed = [[format_number(cell) if isinstance(cell, float | None) else str(cell) for cell in row] for row in rows]
    names = head.split(", ") if isinstance(head, str) else head
    return [Table(caption, names, printed, words, strong, folded)] if printed else []
