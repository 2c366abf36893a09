"""How commands write what they found: the files of a folder together, each in the way of its ending."""

from __future__ import annotations

import csv
import io
import math
import re
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seatsim.cli.outputs.printing import print_reports
from seatsim.provenance.statement import Measured, write_documented
from seatsim.report.rendering import write_html
from seatsim.schema.content import list_written
from seatsim.schema.fields import head_columns
from seatsim.schema.files import write_json, write_text, write_whole
from seatsim.schema.text import disarm

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

_Row = Mapping[str, object]
_Tables = Mapping[str, tuple[type, Sequence[object]]]
"""By name of a sheet: class of its records, and these."""
_PROPERTIES = "docProps/core.xml"
"""Part of a workbook that says when it was made."""
_INSTANT, _NO_INSTANT = re.compile(rb"\d{4}-\d\d-\d\dT[\d:]+Z"), b"2000-01-01T00:00:00Z"
"""An instant there, and the one that stands there instead, since the same tables make the same file."""


def write_outputs(
    folder: Path, contents: Mapping[str, object], seed: int | None = None, measured: Measured | None = None
) -> list[Path]:
    """Write files with a manifest, all or none, and return their paths.

    Args:
        folder: where they go.
        contents: by name of the file a record (.json), rows or a frame (.csv), tables (.xlsx), a report (.html), a
            figure (.png) or text (.yaml).
        seed: as for `write_documented`.
        measured: the same.
    """
    return print_reports(write_documented(folder, partial(write_each, contents), seed, measured))


def write_each(contents: Mapping[str, object], folder: Path) -> list[Path]:
    """Write the files of `write_outputs` to a folder, one after the other; return their paths."""
    return [_WRITERS[Path(name).suffix](folder / name, content) for name, content in contents.items()]


def name_pictures(figures: Mapping[str, object]) -> dict[str, object]:
    """Return figures by the names of their files."""
    return {f"{name}.png": figure for name, figure in figures.items()}


def _write_rows(path: Path, content: Sequence[_Row] | pd.DataFrame) -> Path:
    """Write rows below each other, with a column for every name; what is absent or NaN stays empty."""

    def write(part: Path) -> None:
        rows: Iterable[Sequence[object]]
        if isinstance(content, Sequence):
            names = list(dict.fromkeys(name for row in content for name in row))
            rows = ([row.get(name, "") for name in names] for row in content)
        else:
            names, rows = list(content.columns), content.itertuples(index=False)
        with part.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(map(disarm, names))
            writer.writerows(map(_cell, row) for row in rows)

    return write_whole(path, write)


def _cell(value: object) -> object:
    return "" if isinstance(value, float) and math.isnan(value) else disarm(value)


def _write_workbook(path: Path, tables: _Tables) -> Path:
    """Write a workbook with a sheet for each table, whose bytes depend on nothing but these.

    Units stand in the headings, numbers are numbers; a table without rows has its headings.
    """
    from openpyxl import Workbook

    book, kept = Workbook(), io.BytesIO()
    book.remove(book.active)
    for name, (record, rows) in tables.items():
        sheet = book.create_sheet(name)
        sheet.append(head_columns(record))
        for row in rows:
            sheet.append([_state_cell(getattr(row, field.name)) for field in list_written(record)])
        sheet.freeze_panes = "A2"
    book.save(kept)

    def write(part: Path) -> None:
        with zipfile.ZipFile(kept) as parts, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as target:
            for name in parts.namelist():
                content = parts.read(name)
                if name == _PROPERTIES:
                    content = _INSTANT.sub(_NO_INSTANT, content)
                target.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)

    return write_whole(path, write)


def _state_cell(value: object) -> object:
    """Return what a cell holds: nothing for what is no number, and no text that a spreadsheet would compute."""
    return None if isinstance(value, float) and not math.isfinite(value) else disarm(value)


def _write_picture(path: Path, figure: Figure) -> Path:
    from seatsim.plots.saving import save_figure

    return write_whole(path, partial(save_figure, figure))


_WRITERS: Mapping[str, Callable[[Path, Any], Path]] = {
    ".json": write_json,
    ".csv": _write_rows,
    ".html": lambda path, report: write_html(report, path),
    ".png": _write_picture,
    ".xlsx": _write_workbook,
    ".yaml": write_text,
}
"""Writers by the ending of a file."""
