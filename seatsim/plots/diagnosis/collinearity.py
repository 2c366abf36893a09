"""Which effects this recording can hardly distinguish: collinearity of their sensitivities."""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from numpy.typing import NDArray

from seatsim.diagnosis.result import Diagnosis
from seatsim.plots.frame import FONT, Picture, make_frame, name_rows
from seatsim.plots.style import Grid
from seatsim.plots.thinning import Array

MOST = 10
"""Effects that are shown."""
CELL = 0.3
"""Height of a cell in inches."""
WORTH_WRITING = 0.095
"""Collinearity from which on a cell holds its number: below it rounds to less than 0.1."""
DARK_FROM = 0.55
"""Collinearity from which on a cell is dark, and its number white."""


def plot_collinearity(diagnosis: Diagnosis) -> Picture | None:
    """Return the heat map of the collinearity of the likeliest effects with each other and their most collinear ones.

    Collinearity is the cosine of the angle between the sensitivities of two effects, 0 to 1.
    """
    names, matrix = diagnosis.evidence.collinearity
    chosen = _select_effects(diagnosis)
    if len(chosen) < 2:
        return None
    part = np.abs(matrix[np.ix_(chosen, chosen)])
    shown = [names[index] for index in chosen]
    size = CELL * len(shown)
    page = make_frame(Grid((size,), left=2.5, right=0.2, top=0.3, bottom=0.1))
    axes = page.rows[0][0]
    name_rows(axes, [f"{name}  {row + 1}" for row, name in enumerate(shown)])
    below = np.tril(np.ones(part.shape, dtype=bool), -1)
    axes.imshow(np.where(below, part, np.nan), cmap=colormaps["Blues"], vmin=0.0, vmax=1.0, aspect="auto")
    axes.grid(False)
    axes.set_xticks(range(len(shown)), [str(column + 1) for column in range(len(shown))], fontsize=FONT)
    axes.tick_params(axis="x", length=0, labelbottom=False, labeltop=True)
    axes.spines["bottom"].set_visible(False)
    _write_values(axes, part, below)
    for label, name in zip(axes.get_yticklabels(), shown, strict=True):
        label.set_fontweight("bold" if name in diagnosis.selected else "normal")
    caption = (
        "0: nothing in common, 1: the same sensitivity in these channels, once the parameters within their tolerance"
        " are taken out. Bold: selected. The likeliest effects and those most like them."
    )
    return Picture(_make_title(diagnosis, shown, np.where(below, part, 0.0)), caption, page.figure)


def _select_effects(diagnosis: Diagnosis) -> list[int]:
    """Return indices of the effects shown: selected, equivalent, likeliest, then the most collinear with those."""
    names, matrix = diagnosis.evidence.collinearity
    wanted = [*diagnosis.selected, *(name for group in diagnosis.indistinguishable for name in group)]
    wanted += [cause.effect for cause in diagnosis.causes[:3]]
    first = list(dict.fromkeys(names.index(name) for name in wanted if name in names))
    rest = [index for index in range(len(names)) if index not in first]
    if first:
        rest.sort(key=lambda index: -float(np.max(np.abs(matrix[index, first]))))
    return [*first, *rest][:MOST]


def _write_values(axes: Axes, part: Array, below: NDArray[np.bool_]) -> None:
    """Write the number of each cell below the diagonal that is large enough to be shown."""
    for row, column in np.argwhere(below & (part >= WORTH_WRITING)):
        value = float(part[row, column])
        colour = "white" if value > DARK_FROM else "0.15"
        axes.text(column, row, f"{value:.2f}", ha="center", va="center", fontsize=9, color=colour)


def _make_title(diagnosis: Diagnosis, names: list[str], part: Array) -> str:
    """Return the most collinear pair; where something is selected, a pair with it."""
    chosen = np.array([name in diagnosis.selected for name in names])
    if chosen.any():
        part = np.where(chosen[:, None] | chosen[None, :], part, 0.0)
    row, column = np.unravel_index(int(np.argmax(part)), part.shape)
    return f"Most collinear here: {names[column]} and {names[row]}, {part[row, column]:.2f}"
