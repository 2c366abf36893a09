"""Which effects this recording could take for each other."""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from numpy.typing import NDArray

from seatsim.diagnosis.result import Array, Diagnosis
from seatsim.plots.diagnosis.frame import FONT, Picture, bare, frame
from seatsim.plots.style import Grid

MOST = 10
"""Effects that are shown."""
CELL = 0.3
"""Height of a cell in inches."""
WORTH_WRITING = 0.095
DARK_FROM = 0.55
"""Alikeness from which on a cell is dark."""


def alikeness(diagnosis: Diagnosis) -> Picture | None:
    """Return the heat map of how alike the traces of the likeliest effects are, and of those alike to them."""
    names, matrix = diagnosis.evidence.collinearity
    chosen = _chosen(diagnosis)
    if len(chosen) < 2:
        return None
    part = np.abs(matrix[np.ix_(chosen, chosen)])
    shown = [names[index] for index in chosen]
    size = CELL * len(shown)
    page = frame(Grid((size,), left=2.5, right=0.2, top=0.3, bottom=0.1))
    axes = page.rows[0][0]
    bare(axes, [f"{name}  {row + 1}" for row, name in enumerate(shown)])
    below = np.tril(np.ones(part.shape, dtype=bool), -1)
    axes.imshow(np.where(below, part, np.nan), cmap=colormaps["Blues"], vmin=0.0, vmax=1.0, aspect="auto")
    axes.grid(False)
    axes.set_xticks(range(len(shown)), [str(column + 1) for column in range(len(shown))], fontsize=FONT)
    axes.tick_params(axis="x", length=0, labelbottom=False, labeltop=True)
    axes.spines["bottom"].set_visible(False)
    _write(axes.text, part, below)
    for label, name in zip(axes.get_yticklabels(), shown, strict=True):
        label.set_fontweight("bold" if name in diagnosis.selected else "normal")
    caption = (
        "0: nothing in common, 1: the same trace in these channels, once the parameters within their tolerance are"
        " taken out. Bold: selected. The likeliest effects and those most like them."
    )
    return Picture(_title(diagnosis, shown, np.where(below, part, 0.0)), caption, page.figure)


def _chosen(diagnosis: Diagnosis) -> list[int]:
    """Return the effects shown: selected, in a group, then by turns the likeliest and the most alike to those."""
    names, matrix = diagnosis.evidence.collinearity
    wanted = [*diagnosis.selected, *(name for group in diagnosis.indistinguishable for name in group)]
    wanted += [cause.effect for cause in diagnosis.causes[:3]]
    first = list(dict.fromkeys(names.index(name) for name in wanted if name in names))
    rest = [index for index in range(len(names)) if index not in first]
    if first:
        rest.sort(key=lambda index: -float(np.max(np.abs(matrix[index, first]))))
    return [*first, *rest][:MOST]


def _write(text: object, part: Array, below: NDArray[np.bool_]) -> None:
    assert callable(text)
    for row, column in np.argwhere(below & (part >= WORTH_WRITING)):
        value = float(part[row, column])
        colour = "white" if value > DARK_FROM else "0.15"
        text(column, row, f"{value:.2f}", ha="center", va="center", fontsize=9, color=colour)


def _title(diagnosis: Diagnosis, names: list[str], part: Array) -> str:
    """Return the most alike pair; where something is selected, one of that."""
    chosen = np.array([name in diagnosis.selected for name in names])
    if chosen.any():
        part = np.where(chosen[:, None] | chosen[None, :], part, 0.0)
    row, column = np.unravel_index(int(np.argmax(part)), part.shape)
    return f"Most alike here: {names[column]} and {names[row]}, {part[row, column]:.2f}"
