"""Where the numbers of a table of cells begin, and what the lines above them say: names and units.

Text tables and sheets share this: lines of titles, a row of names, perhaps a row of units, then rows of numbers.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from seatsim.schema.errors import InputError
from seatsim.schema.units import USUAL

BRACKETS = re.compile(r"^(.*?)\s*[\[(]\s*([^\[\]()]*?)\s*[\])]\s*$")
UNIT_CELL = re.compile(r"^[\[(]?\s*[A-Za-zµμ°²³%\"Ω][A-Za-zµμ°²³%/*^_. ·0-9-]{0,11}\s*[\])]?$|^[\[(]?[-1]?[\])]?$")
LISTED_UNITS = {unit.lower() for units in USUAL.values() for unit in units} | {
    "m/s2", "m/s²", "mm/s2", "°c", "c", "k", "f", "hz", "-", "sec", "in", "lb", "kg", "bar", "pa", "deg", "rad", "°",
    "1/s", "rpm", "w", "%",
}  # fmt: skip


FOLLOWING = 4
"""Rows of numbers with which a table begins, or as many as there are."""


class Header(NamedTuple):
    """Names and units of the columns, and the number of lines above the first row of numbers."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    lines: int


def split_header(rows: Sequence[Sequence[str]], first: int, columns: int) -> Header:
    """Return what the rows above the row `first` say of so many columns.

    The row of names is the last one that fills most columns; below it may stand a row of units.
    """
    full = [row for row in rows[:first] if sum(bool(cell.strip()) for cell in row) >= max(1, 0.6 * columns)]
    units: Sequence[str] = [""] * columns
    names: Sequence[str] = []
    if len(full) > 1 and is_units(full[-1]):
        names, units = full[-2], full[-1]
    elif full:
        names = full[-1]
    cells = [name.strip().strip('"') for name in names] + [""] * columns
    named = [_name_and_unit(name, index) for index, name in enumerate(cells[:columns])]
    stated = [unit.strip().strip('"[]()').strip() for unit in [*units, *[""] * columns]][:columns]
    return Header(
        tuple(name for name, _ in named),
        tuple(unit or of_name for unit, (_, of_name) in zip(stated, named, strict=True)),
        first,
    )


def is_units(row: Sequence[str]) -> bool:
    """Say whether a row of cells holds units: all look like one, and at least half are well known."""
    cells = [cell.strip().strip('"') for cell in row if cell.strip().strip('"')]
    known = sum(cell.strip("[]() ").lower() in LISTED_UNITS for cell in cells)
    return bool(cells) and all(UNIT_CELL.match(cell) for cell in cells) and known >= 0.5 * len(cells)


def _name_and_unit(cell: str, index: int) -> tuple[str, str]:
    """Return the name and the unit of a cell such as `a_Sitz [g]`; a column without name is called by its number."""
    found = BRACKETS.match(cell)
    if found and found[1]:
        return found[1].strip(), found[2]
    return cell or f"column {index + 1}", ""


def first_row_of_numbers(rows: Sequence[Sequence[bool]], place: str) -> int:
    """Return the first row from which on most cells are numbers; `rows` say of each cell whether it is one.

    Raises:
        InputError: there is no such row.
    """
    width = max((len(row) for row in rows), default=0)
    numbers = [sum(row) >= max(1, 0.5 * width) for row in rows]
    for index in range(len(rows)):
        # One line of numbers among titles is none of the table, which goes on, though a row of it may lack numbers.
        following = numbers[index : index + FOLLOWING]
        if numbers[index] and sum(following) >= 0.75 * len(following):
            return index
    raise InputError(f"{place}: holds no row of numbers; it is no table, or its decimal sign is not the one stated")
