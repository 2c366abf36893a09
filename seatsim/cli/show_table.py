"""How a table is shown: with lines on a terminal, as plain aligned text in a file or another program.

Names are never cut. Where a terminal is too narrow, columns of figures go, from the last on, and a note names them; a
file or a program has room for all of them.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from textwrap import fill
from typing import TYPE_CHECKING

from rich import box
from rich.cells import cell_len
from rich.markup import escape
from rich.measure import Measurement
from rich.table import Column, Table
from rich.text import Text

from seatsim.cli.terminal import out, say
from seatsim.schema.printing import MINUS, UNKNOWN

if TYPE_CHECKING:
    from seatsim.report.blocks import Table as ReportTable

_WIDEST = 10_000
"""Letters that no table has in a line."""
_HEADING = 12
"""Letters of a line of a heading, if its words permit."""
_PLAIN = str.maketrans({MINUS: "-", UNKNOWN: "-"})
"""Signs that programs which read a table do not take for those of numbers."""
_MOST_ROWS = 60
"""Rows of a table of a report that are printed."""


def make_table(
    title: str,
    headings: Sequence[str],
    rows: Iterable[Sequence[str]],
    left: Collection[int] = (0,),
    caption: str | None = None,
) -> Table:
    """Return a table for the terminal; `left` are the columns of names."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), title_justify="left", caption_justify="left")
    table.title, table.caption = escape(title), caption
    for k, heading in enumerate(headings):
        table.add_column(escape(heading), justify="left" if k in left else "right", vertical="bottom", no_wrap=True)
    for row in rows:
        table.add_row(*row)
    return table


def format_number(value: float, form: str) -> str:
    """Return a number as a cell, `-` where it has no value."""
    text = f"{value:{form}}" if math.isfinite(value) else "-"
    # A value that rounds to zero loses its sign: -0.0 looks like a finding.
    return text.replace("-", "", 1) if text.strip("-0.") == "" and text != "-" else text


def show_table(*tables: Table) -> None:
    """Print tables, whose columns of figures are those that stand to the right."""
    for table in tables:
        if out.is_terminal:
            left_out = _fit(table)
            out.print(table)
            if left_out:
                say(f"left out, as the terminal is narrow: {', '.join(left_out)}")
        else:
            say(_make_plain(table))


def show_report_tables(tables: Iterable[ReportTable]) -> None:
    """Print tables of a report; rows that stand out there are bold, and a note counts those that have no room."""
    for table in tables:
        rows = [[escape(cell.translate(_PLAIN)) for cell in row] for row in table.rows[:_MOST_ROWS]]
        for number in {*table.strong} & {*range(len(rows))}:
            rows[number] = [f"[bold]{cell}[/]" for cell in rows[number]]
        headings = [fill(text, _HEADING, break_long_words=False) for text in table.head]
        left = len(table.rows) - len(rows)
        caption = f"{left} more rows in report.html" if left else None
        show_table(make_table(table.caption, headings, rows, range(table.words), caption))


def _make_plain(table: Table) -> str:
    """Return a table as text: a line of headings, then a line for each row, two spaces between aligned columns."""
    columns = [_pad(column) for column in table.columns]
    lines = ["  ".join(cells).rstrip() for cells in zip(*columns, strict=True)]
    return "\n".join([*_lines(table.title), *lines, *_lines(table.caption)])


def _fit(table: Table) -> list[str]:
    """Drop columns of figures until the others have room, and return the headings of those that went."""
    for column in table.columns:
        column.overflow, column.no_wrap = "fold", column.justify == "right"
        texts = [_unmarked(column.header), *map(_unmarked, column.cells)]
        column.min_width = max((cell_len(word) for text in texts for word in text.split()), default=1)
    left_out: list[str] = []
    # Rich measures a table within the width of its options: these have more than any table needs.
    while Measurement.get(out, out.options.update(width=_WIDEST), table).minimum > out.width:
        last = next((column for column in reversed(table.columns) if column.justify == "right"), None)
        if last is None:
            break
        table.columns.remove(last)
        left_out.insert(0, _plain(last.header))
    return left_out


def _pad(column: Column) -> list[str]:
    cells = [_plain(cell) for cell in (column.header, *column.cells)]
    width = max(map(cell_len, cells), default=0)
    gaps = [" " * (width - cell_len(cell)) for cell in cells]
    at_right = column.justify == "right"
    return [gap + cell if at_right else cell + gap for gap, cell in zip(gaps, cells, strict=True)]


def _lines(title: object) -> list[str]:
    return [_plain(title)] if title else []


def _plain(cell: object) -> str:
    """Return what a cell says in one line, without the marks of its style; a word divided over lines is whole again."""
    return " ".join(_unmarked(cell).replace("-\n", "").split())


def _unmarked(cell: object) -> str:
    return (cell if isinstance(cell, Text) else Text.from_markup(str(cell), emoji=False)).plain
