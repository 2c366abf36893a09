"""Excel workbooks; every sheet with rows of numbers is a group."""

from __future__ import annotations

import datetime
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatsim.importing.readers.header import check_header, first_row_of_numbers, split_header
from seatsim.importing.readers.naming import note_left_out
from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import DataFile, Group, Signal
from seatsim.schema.arrays import Array
from seatsim.schema.bounds import TooMuchError, check_made
from seatsim.schema.errors import InputError

if TYPE_CHECKING:
    from openpyxl.worksheet._read_only import ReadOnlyWorksheet

MOST_ROWS = 2**20
BYTES_OF_CELL = 64
"""Bytes that a cell takes in memory as Python holds it."""
Cell = str | float | int | bool | datetime.datetime | datetime.date | datetime.time | datetime.timedelta | None


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the sheets of a workbook that hold rows of numbers."""
    openpyxl = need("openpyxl", "XLSX")
    book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=True)
    groups, notes = [], []
    for sheet in book.worksheets:
        try:
            group, left_out = _group(sheet.title, _rows(sheet, len(content)), f"{path}, sheet {sheet.title}", layout)
        except InputError as error:
            notes.append(str(error))
            continue
        groups.append(group)
        notes += note_left_out(f"columns of the sheet {sheet.title} that hold no numbers", left_out)
    if not groups and notes:
        raise InputError(notes[0])
    return DataFile(path, "", tuple(groups), tuple(notes))


def _rows(sheet: ReadOnlyWorksheet, size: int) -> list[Sequence[Cell]]:
    """Return the rows of a sheet that hold something, of equal length.

    Raises:
        TooMuchError: the sheet has more rows or cells than one of a file of `size` bytes may have.
    """
    # The stated dimensions may be anything; without them a row is as long as its last cell.
    sheet.reset_dimensions()
    rows: list[Sequence[Cell]] = []
    cells = 0
    for number, row in enumerate(sheet.iter_rows(values_only=True)):
        if number >= MOST_ROWS:
            raise TooMuchError(f"the sheet {sheet.title} states more than {MOST_ROWS} rows, the most that Excel has")
        if any(cell is not None for cell in row):
            rows.append(row)
            cells += len(row)
            check_made(BYTES_OF_CELL * cells, size, f"the sheet {sheet.title}")
    width = max((len(row) for row in rows), default=0)
    check_made(BYTES_OF_CELL * width * len(rows), size, f"the sheet {sheet.title}")
    return [(*row, *[None] * (width - len(row))) for row in rows]


def _group(title: str, rows: Sequence[Sequence[Cell]], place: str, layout: TextLayout) -> tuple[Group, list[str]]:
    """Return the columns of numbers, and the names of the others."""
    first = layout.header
    if first is None:
        first = first_row_of_numbers([[_is_number(cell) for cell in row] for row in rows], place)
    check_header(first, len(rows), place)
    above = [["" if cell is None else str(cell) for cell in row] for row in rows[:first]]
    header = split_header(above, len(rows[first]))
    columns = list(zip(*rows[first:], strict=True))
    named = zip(header.names, header.units, columns, strict=True)
    signals = [Signal(name, unit, _values(cells)) for name, unit, cells in named]
    empty = [signal.name for signal in signals if np.isnan(signal.values).all()]
    left_out = [name for name in empty if not name.startswith("column ")]
    return Group(title, tuple(signal for signal in signals if signal.name not in empty)), left_out


def _is_number(cell: Cell) -> bool:
    return isinstance(cell, int | float | datetime.datetime | datetime.time) and not isinstance(cell, bool)


def _values(cells: Sequence[Cell]) -> Array:
    """Return cells as numbers, times in s since the first of them, NaN for what is neither."""
    first = next((cell for cell in cells if isinstance(cell, datetime.datetime)), None)
    return np.array([_number(cell, first) for cell in cells], dtype=np.float64)


def _number(cell: Cell, first: datetime.datetime | None) -> float:
    if isinstance(cell, datetime.datetime) and first is not None:
        return (cell - first).total_seconds()
    if isinstance(cell, datetime.time):
        return 3600.0 * cell.hour + 60.0 * cell.minute + cell.second + 1e-6 * cell.microsecond
    if isinstance(cell, str):
        try:
            return float(cell.strip().replace(",", "."))
        except ValueError:
            return np.nan
    return float(cell) if isinstance(cell, int | float) else np.nan
