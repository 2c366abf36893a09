"""How a notebook shows a value: its figures as a table, and pictures of it."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Iterable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING

from seatsim.schema.errors import InputError, nearest

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DPI = 72
"""Dots per inch of a picture in a notebook."""


class Pictures(dict[str, "Figure"]):
    """Figures by name; a notebook shows them below each other."""

    def _repr_html_(self) -> str:
        return "".join(f'<img alt="{html.escape(name)}" src="{_encode(figure)}">' for name, figure in self.items())


def draw(value: object, names: Sequence[str]) -> Pictures:
    """Return the pictures of a result, gap, diagnosis or identification; those that are named, or all.

    Raises:
        InputError: it has no picture of that name.
    """
    # The package that draws stands above what it shows, and takes its time to load: it is imported when asked for.
    figures: dict[str, Figure] = import_module("seatsim.plots.notebook").list_figures(value)
    for name in names:
        if name not in figures:
            raise InputError(f"no picture is called '{name}'{nearest(name, figures)}; permitted: {', '.join(figures)}")
    return Pictures({name: figures[name] for name in names or figures})


def html_table(heading: str, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table under a heading; numbers are rounded to four digits."""
    body = [_html_row("th", columns), *(_html_row("td", row) for row in rows)]
    return f"<p>{html.escape(heading)}</p><table>{''.join(body)}</table>"


def _html_row(tag: str, cells: Sequence[object]) -> str:
    shown = [f"{cell:.4g}" if isinstance(cell, float) else str(cell) for cell in cells]
    return f"<tr>{''.join(f'<{tag}>{html.escape(cell)}</{tag}>' for cell in shown)}</tr>"


def _encode(figure: Figure) -> str:
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=DPI)
    return "data:image/png;base64," + base64.b64encode(image.getvalue()).decode("ascii")
