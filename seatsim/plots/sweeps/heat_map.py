"""The mean of a metric over two keys."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from seatsim.plots.frame import FONT, WIDTH, Picture, format_number, make_frame
from seatsim.plots.labels import clean_text
from seatsim.plots.style import Grid, add_axes_beside
from seatsim.plots.sweeps.naming import SCREEN, describe_column, format_level
from seatsim.sweeps.statistics.inputs import SweepRows, is_number

if TYPE_CHECKING:
    import pandas as pd

MOST_LEVELS = 12
"""Values of a key that have rows or columns of their own; numbers with more are taken in `BINS` of as many runs."""
BINS = 6
MAP = "cividis"
CELL = 0.42


def plot_heat_map(rows: SweepRows, metric: str, across: str, up: str) -> Picture | None:
    """Return the mean of a metric over two keys, or None where one of them is a text with too many values."""
    import pandas as pd

    groups = [_group(rows.usable[key]) for key in (across, up)]
    if groups[0] is None or groups[1] is None:
        return None
    quantity = describe_column(metric, rows.units)
    means = pd.DataFrame({"x": groups[0], "y": groups[1], "z": quantity.factor * rows.usable[metric]})
    table = means.groupby(["y", "x"], observed=True)["z"].mean().unstack()
    high = min(CELL * len(table) + 0.3, SCREEN - 1.4)
    page = make_frame(Grid((high,), left=1.5, right=1.0, top=0.2, bottom=1.0), width=WIDTH)
    axes = page.rows[0][0]
    values = table.to_numpy()
    image = axes.imshow(values, cmap=MAP, aspect="auto", origin="lower")
    for (i, j), value in np.ndenumerate(values):
        if np.isfinite(value):
            dark = value < 0.5 * (np.nanmin(values) + np.nanmax(values))
            axes.text(
                j,
                i,
                format_number(value),
                ha="center",
                va="center",
                fontsize=FONT - 2,
                color="white" if dark else "black",
            )
    axes.grid(False)
    axes.set_xticks(range(len(table.columns)), list(table.columns), rotation=30, ha="right")
    axes.set_yticks(range(len(table.index)), list(table.index))
    axes.set_xlabel(describe_column(across, rows.units).axis)
    axes.set_ylabel(describe_column(up, rows.units).axis)
    axes.figure.colorbar(image, cax=add_axes_beside(axes, 0.02, 0.03), label=quantity.axis)
    title = f"{quantity.words} over {across} and {up}"
    return Picture(title, "Mean over the runs of each cell.", page.figure)


def _group(values: pd.Series[Any]) -> pd.Series[Any] | None:
    """Return the values as ordered names of cells."""
    import pandas as pd

    if values.nunique() <= MOST_LEVELS:
        levels = sorted(values.unique())
        names = pd.Categorical(values.map(_name_of), [_name_of(level) for level in levels], ordered=True)
        return pd.Series(names, index=values.index)
    if not is_number(values):
        return None
    cells = pd.qcut(values, BINS, duplicates="drop")
    return cells.cat.rename_categories([f"{cell.left:.3g} – {cell.right:.3g}" for cell in cells.cat.categories])


def _name_of(value: object) -> str:
    return clean_text(format_level(value), 24)
