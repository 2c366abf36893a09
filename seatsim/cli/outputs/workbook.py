"""Tables of records as a workbook: a sheet for each table, units in the headings, numbers as numbers."""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from seatsim.schema.columns import head_columns
from seatsim.schema.content import list_written
from seatsim.schema.files import write_whole
from seatsim.schema.text import disarm

_Tables = Mapping[str, tuple[type, Sequence[object]]]
"""By name of the sheet: class of its records, and these."""
_PROPERTIES = "docProps/core.xml"
"""Part of a workbook that says when it was made."""
_INSTANT, _NO_INSTANT = re.compile(rb"\d{4}-\d\d-\d\dT[\d:]+Z"), b"2000-01-01T00:00:00Z"
"""An instant there, and the one that stands there instead, since the same tables make the same file."""


def write_workbook(path: Path, tables: _Tables) -> Path:
    """Write a workbook whose bytes depend on nothing but its tables; one without rows has its headings."""
    return write_whole(path, partial(_write, tables))


def _write(tables: _Tables, path: Path) -> None:
    from openpyxl import Workbook

    book, kept = Workbook(), io.BytesIO()
    book.remove(book.active)
    for name, (record, rows) in tables.items():
        sheet = book.create_sheet(name)
        sheet.append(head_columns(record))
        for row in rows:
            sheet.append([_cell(getattr(row, field.name)) for field in list_written(record)])
        sheet.freeze_panes = "A2"
    book.save(kept)
    with zipfile.ZipFile(kept) as parts, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as target:
        for part in parts.namelist():
            content = parts.read(part)
            if part == _PROPERTIES:
                content = _INSTANT.sub(_NO_INSTANT, content)
            target.writestr(zipfile.ZipInfo(part), content, zipfile.ZIP_DEFLATED)


def _cell(value: object) -> object:
    """Return what a cell holds: nothing for what is no number, and no text that a spreadsheet would compute."""
    return None if isinstance(value, float) and not math.isfinite(value) else disarm(value)
