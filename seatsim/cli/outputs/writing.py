"""How commands write what they found: the files of a folder together, each in the way of its ending."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seatsim.provenance.manifest import Measured, write_documented
from seatsim.report.rendering import write_html
from seatsim.schema.files import write_json, write_text, write_whole
from seatsim.schema.text import disarm

if TYPE_CHECKING:
    import pandas as pd

Row = Mapping[str, object]


def write_outputs(
    folder: Path, contents: Mapping[str, object], seed: int | None = None, measured: Measured | None = None
) -> list[Path]:
    """Write files with a manifest, all or none, and return their paths.

    Args:
        folder: where they go.
        contents: by name of the file a record (.json), rows or a frame (.csv), a report (.html), a figure (.png) or
            text (.yaml).
        seed: as for `write_documented`.
        measured: the same.
    """
    return write_documented(folder, partial(write_each, contents), seed, measured)


def write_each(contents: Mapping[str, object], folder: Path) -> list[Path]:
    """Write the files of `write_outputs` to a folder, one after the other; return their paths."""
    return [WRITERS[Path(name).suffix](folder / name, content) for name, content in contents.items()]


def name_pictures(figures: Mapping[str, object]) -> dict[str, object]:
    """Return figures by the names of their files."""
    return {f"{name}.png": figure for name, figure in figures.items()}


def _write_rows(path: Path, content: Sequence[Row] | pd.DataFrame) -> Path:
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


def _write_picture(path: Path, figure: Any) -> Path:
    from seatsim.plots.saving import save_figure

    return write_whole(path, partial(save_figure, figure))


WRITERS: Mapping[str, Callable[[Path, Any], Path]] = {
    ".json": write_json,
    ".csv": _write_rows,
    ".html": lambda path, report: write_html(report, path),
    ".png": _write_picture,
    ".yaml": write_text,
}
"""Writers by the ending of a file."""
