"""Where the numbers of a table of cells begin, and what the lines above them say: names and units of its columns.

Text tables and sheets share this: lines of titles, a row of names, perhaps a row of units, then rows of numbers. A row
names the columns only where it has as many cells as there are columns.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from seatsim.importing.names import read_name
from seatsim.importing.readers.dialect import LISTED_UNITS, Kind, find_body, kind_of
from seatsim.schema.errors import InputError
from seatsim.schema.units import is_unit

BRACKETS = re.compile(r"^(.*?)\s*([\[({<])\s*([^\[\](){}<>]*?)\s*[\])}>]\s*$")
SLASH = re.compile(r"^(.*?\S)\s*/\s*\(?([^/()\s]+(?:/[^/()\s]+)?)\)?$")
UNIT_CELL = re.compile(r"^[\[(]?\s*[A-Za-zµμ°²³%\"Ω][A-Za-zµμ°²³%/*^_. ·0-9-]{0,11}\s*[\])]?$|^[\[(]?[-1]?[\])]?$")

NOTHING = "-"
"""What stands in place of a unit where none is stated."""
MOSTLY = 0.75
"""Share of the rows from the first one on, as far as the table was looked at, that belong to it."""


class Header(NamedTuple):
    """Names and units of the columns."""

    names: tuple[str, ...]
    units: tuple[str, ...]


def split_header(rows: Sequence[Sequence[str]], columns: int) -> Header:
    """Return what the rows above the numbers say of so many columns; rows of another width are titles.

    Of the rows of texts that fill most columns one may hold units; of the others the one that says most holds the
    names, the last one where several say as much.
    """
    full = [row for row in rows if len(row) == columns and may_be_names(row)]
    below = next((row for row in reversed(full) if is_units(row)), None) if len(full) > 1 else None
    others = [row for row in full if row is not below]
    names = max(reversed(others), key=_count_meanings, default=[""] * columns)
    named = [_name_and_unit(name, index) for index, name in enumerate(names)]
    stated = [_unmarked(unit).strip("[]() ") for unit in below or [""] * columns]
    stated = ["" if unit == NOTHING else unit for unit in stated]
    return Header(
        tuple(name for name, _ in named),
        tuple(unit or of_name for unit, (_, of_name) in zip(stated, named, strict=True)),
    )


def may_be_names(row: Sequence[str]) -> bool:
    """Say whether a row holds texts in most columns, and no number; numbers that count columns are names, too."""
    filled = [cell for cell in row if cell.strip()]
    return len(filled) >= max(1, 0.6 * len(row)) and (
        not any(kind_of(cell, ".") for cell in filled) or count_columns(row)
    )


def count_columns(row: Sequence[str]) -> bool:
    """Say whether a row has a text or nothing in front, and then numbers that count from 0 or 1."""
    numbers = [cell.strip() for cell in row[1:]]
    counts = [[str(number) for number in range(begin, begin + len(numbers))] for begin in (0, 1)]
    return len(numbers) > 1 and not kind_of(row[0], ".") and numbers in counts


def _count_meanings(row: Sequence[str]) -> int:
    """Return how many different names of a row mean something: `V, V` are units of several columns."""
    return sum(read_name(cell)[:2] != (None, None) for cell in {*row})


def is_units(row: Sequence[str]) -> bool:
    """Say whether a row of cells holds units: all look like one, and at least half are well known."""
    cells = [text for cell in row if (text := _unmarked(cell))]
    known = sum(cell.strip("[]() ").lower() in LISTED_UNITS for cell in cells)
    return bool(cells) and all(UNIT_CELL.match(cell) for cell in cells) and known >= 0.5 * len(cells)


def _unmarked(cell: str) -> str:
    return cell.strip().strip('"').strip()


def _name_and_unit(cell: str, index: int) -> tuple[str, str]:
    """Return the name and the unit of a cell such as `a_Sitz [g]` or `F/kN`; one without name is called by its number.

    A word in round brackets, such as `(left)`, is a unit only where there is such a one.
    """
    text = " ".join(_unmarked(cell).split())
    found = BRACKETS.match(text)
    if found and found[1]:
        unit = found[3].removeprefix("in ").strip()
        if found[2] == "[" or is_unit(unit) or unit == NOTHING:
            return found[1].rstrip("/ ").strip() or text, "" if unit == NOTHING else unit
    parted = SLASH.match(text)
    if parted and is_unit(parted[2]):
        return parted[1], parted[2]
    return text or f"column {index + 1}", ""


def check_header(header: int, lines: int, place: str) -> None:
    """Raise InputError where no row is left below so many lines above the first row of numbers."""
    if header >= lines:
        raise InputError(f"{place}: has {lines} lines; csv.header {header} counts those above the first row of numbers")


def first_row_of_numbers(rows: Sequence[Sequence[Kind]], place: str) -> int:
    """Return the first row of the table; `rows` say of each cell what it holds.

    The table is the longest stretch of equally wide rows with numbers. A row belongs to it where the first column of
    numbers holds no text, and at most half of the others do: a line of factors or serial numbers begins with a word.

    Raises:
        InputError: there is no such row.
    """
    begin, end = find_body(rows)
    if begin == end:
        raise InputError(f"{place}: holds no row of numbers; it is no table")
    body = rows[begin:end]
    columns = range(len(body[0]))
    numeric = [column for column in columns if 2 * sum(row[column] is True for row in body) > len(body)]
    numeric = numeric or [column for column in columns if any(row[column] for row in body)]
    belongs = [len(row) == len(columns) and _belongs(row, numeric) for row in rows[:end]]
    # Rows above a remark belong to the table, a line of numbers among titles does not.
    return next(row for row in range(end) if belongs[row] and sum(belongs[row:end]) >= MOSTLY * (end - row))


def _belongs(row: Sequence[Kind], numeric: Sequence[int]) -> bool:
    texts = sum(row[column] is False for column in numeric)
    return any(row) and row[numeric[0]] is not False and 2 * texts <= len(numeric)
