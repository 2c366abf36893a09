"""Pictures of a sweep: comfort against travel for each road, and means over two keys."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from seatsim.metrics.table import SHORT
from seatsim.report.blocks import Block, Matrix, Plane
from seatsim.report.formatting import format_number
from seatsim.report.planes import Curve, draw_curves, join_planes
from seatsim.report.sweep_names import COMFORT, TRAVEL, describe_column, format_level
from seatsim.schema.arrays import Array
from seatsim.sweeps.rows import SweepRows, is_number

if TYPE_CHECKING:
    import pandas as pd


ROAD = "excitation."
"""How the keys of the excitation begin; the first of them with few values gives each value a picture of its own."""
MOST_PICTURES = 6
MOST_POINTS = 4000
"""Runs that are drawn in all pictures; more of them hide each other."""
MOST_GROUPS = 8
MOST_LEVELS = 10
"""Values of a key that have rows or columns of their own; numbers with more are taken in `BINS` of as many runs."""
BINS = 6


def draw_pareto(rows: SweepRows, order: Sequence[str]) -> list[Block]:
    """Return comfort over travel, a picture for each road, coloured by what matters most of the other keys.

    Args:
        rows: the rows of the sweep.
        order: its varied keys, what matters most first.
    """
    if not {COMFORT, TRAVEL} <= set(rows.metrics):
        return []
    shown = rows.usable.dropna(subset=[COMFORT, TRAVEL])
    few = {key: shown[key].nunique() for key in order}
    road = next((key for key in order if key.startswith(ROAD) and 1 < few[key] <= MOST_PICTURES), None)
    colour = next((key for key in order if key != road and few[key] <= MOST_GROUPS), None)
    said = "" if colour is None or colour == "variant" else f" The colours are values of {colour}."
    parts = [("", shown)] if road is None else [
        (f"{road} {format_level(value)}", part) for value, part in shown.groupby(road)
    ]  # fmt: skip
    values = [] if colour is None else sorted(shown[colour].unique())
    most = MOST_POINTS // len(parts)
    planes = [_draw_plane(part, most, title, colour, values) for title, part in parts]
    drawn = sum(min(most, len(part)) for _, part in parts)
    some = f" {drawn} of {len(shown)} runs are drawn." if drawn < len(shown) else ""
    caption = f"A point for each run; lower left is better.{said}{some}"
    return [join_planes("Comfort against travel", caption, planes)]


def _draw_plane(shown: pd.DataFrame, most: int, title: str, colour: str | None, values: Sequence[object]) -> Plane:
    """Return comfort over travel of some runs, with their Pareto front; each value of a key has its colour."""
    drawn = shown.sample(most, random_state=0) if len(shown) > most else shown
    groups = [("runs", drawn)] if colour is None else [
        (format_level(value), drawn[drawn[colour] == value]) for value in values
    ]  # fmt: skip
    curves = [
        Curve(name, 1e3 * part[TRAVEL].to_numpy(float), part[COMFORT].to_numpy(float), (k + 1) % 8, "dots")
        for k, (name, part) in enumerate(groups)
    ]
    travel, comfort = shown[TRAVEL].to_numpy(float), shown[COMFORT].to_numpy(float)
    front = find_front(travel, comfort)
    curves.append(Curve("Pareto front", 1e3 * travel[front], comfort[front], 0))
    return draw_curves(title, "", (f"{SHORT[TRAVEL]} [mm]", f"{SHORT[COMFORT]} [m/s²]"), curves)


def find_front(travel: Array, comfort: Array) -> NDArray[np.intp]:
    """Return the indices of the runs that no other is better than in both, by rising travel."""
    order = np.lexsort((comfort, travel))
    best = np.minimum.accumulate(comfort[order])
    keep = np.concatenate([[True], comfort[order][1:] < best[:-1]])
    front: NDArray[np.intp] = order[keep]
    return front


def tabulate_maps(rows: SweepRows, order: Sequence[str]) -> list[Block]:
    """Return the means of comfort and travel over the two keys that matter most, none where fewer are varied."""
    keys = [key for key in order if key != "variant"]
    if len(keys) < 2:
        return []
    maps = [_tabulate(rows, metric, keys[0], keys[1]) for metric in (COMFORT, TRAVEL) if metric in rows.metrics]
    return [each for each in maps if each is not None]


def _tabulate(rows: SweepRows, metric: str, across: str, up: str) -> Matrix | None:
    """Return the mean of a metric over two keys, or None where one of them is a text with too many values."""
    import pandas as pd

    x, y = (_group(rows.usable[key]) for key in (across, up))
    if x is None or y is None:
        return None
    shown = describe_column(metric, rows.units)
    means = pd.DataFrame({"x": x, "y": y, "z": shown.factor * rows.usable[metric]})
    table = means.groupby(["y", "x"], observed=True)["z"].mean().unstack()
    values = table.to_numpy()
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    lines = [
        (str(name), [
            (format_number(value), min(9, int(10 * (value - low) / ((high - low) or 1.0)))) if np.isfinite(value)
            else ("", 0) for value in line
        ])
        for name, line in zip(table.index, values, strict=True)
    ]  # fmt: skip
    caption = f"Mean over the runs of each cell, in {shown.unit}; the darker, the larger."
    title = f"{shown.words} over {across} (columns) and {up} (rows)"
    return Matrix(f"{title[:1].upper()}{title[1:]}", caption, up, [str(name) for name in table.columns], lines)


def _group(values: pd.Series) -> pd.Series | None:
    """Return the values as ordered names of cells."""
    import pandas as pd

    if values.nunique() <= MOST_LEVELS:
        names = pd.Categorical(values.map(format_level), [format_level(x) for x in sorted(values.unique())], True)
        return pd.Series(names, index=values.index)
    if not is_number(values):
        return None
    cells = pd.qcut(values, BINS, duplicates="drop")
    return cells.cat.rename_categories([f"{c.left:.3g} to {c.right:.3g}" for c in cells.cat.categories])
