"""Excel workbooks; every sheet with rows of numbers is a group."""

from __future__ import annotations

import datetime
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from seatsim.importing.optional import need
from seatsim.importing.readers.header import first_row_of_numbers, split_header
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import Array, DataFile, Group, Signal
from seatsim.schema.errors import InputError

Cell = str | float | int | bool | datetime.datetime | datetime.date | datetime.time | datetime.timedelta | None


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the sheets of a workbook that hold rows of numbers."""
    openpyxl = need("openpyxl", "XLSX")
    book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=True)
    groups, problems = [], []
    for sheet in book.worksheets:
        rows = [row for row in sheet.iter_rows(values_only=True) if any(cell is not None for cell in row)]
        try:
            groups.append(_group(sheet.title, rows, f"{path}, sheet {sheet.title}", layout))
        except InputError as error:
            problems.append(str(error))
    if not groups and problems:
        raise InputError(problems[0])
    return DataFile(path, "", tuple(groups))


def _group(title: str, rows: Sequence[Sequence[Cell]], place: str, layout: TextLayout) -> Group:
    first = layout.header
    if first is None:
        first = first_row_of_numbers([[_is_number(cell) for cell in row] for row in rows], place)
    above = [["" if cell is None else str(cell) for cell in row] for row in rows[:first]]
    header = split_header(above, first, len(rows[first]))
    columns = list(zip(*rows[first:], strict=True))
    named = zip(header.names, header.units, columns, strict=True)
    signals = [Signal(name, unit, _values(cells)) for name, unit, cells in named]
    return Group(title, tuple(signal for signal in signals if not np.isnan(signal.values).all()))


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
