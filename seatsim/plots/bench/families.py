"""Which rows of a characterisation are drawn together, and in which order of colours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.characterisation.rows import WARMER, Row, group_rows
from seatsim.characterisation.summary import group_by_setting
from seatsim.plots import labels, style
from seatsim.plots.thinning import spread_evenly

MOST = 6
"""Most settings whose loops are drawn."""
_MOST_WARM = 2
"""Most settings whose loops are drawn by temperature."""
_MOST_CLOUDS = 3
"""Most groups of records without cycles that are drawn."""
MOST_LINES = 8
"""Most loops that the colours of one panel can tell apart."""
LONGEST = 24
"""Letters of a record's name in a legend."""
_SAME_CURRENT = 0.02
"""A; difference of currents that are the same but for their noise."""
_SAME_MOTION = 0.1
"""Relative difference of strokes and speeds of records whose clouds share their panels."""


class Family(NamedTuple):
    """Rows that are drawn together: their title, that of the legend, and name and colour of each."""

    title: str
    legend: str
    rows: list[Row]
    names: list[str]
    colours: list[str]


def find_families(rows: Sequence[Row]) -> tuple[list[Family], int]:
    """Return the families of loops by current, then by temperature, and the number of settings left out."""
    groups = group_by_setting(rows)
    chosen = spread_evenly(groups, MOST)
    families = [order_by_current(group) for group in chosen]
    warm = [group for group in chosen if _varies([row.temperature for row in select_largest_current(group)], WARMER)]
    warm = [group for group in warm if _varies([row.current for row in group], _SAME_CURRENT)]
    families += [order_by_temperature(group) for group in spread_evenly(warm, _MOST_WARM)]
    return families, len(groups) - len(chosen)


def order_by_current(group: Sequence[Row]) -> Family:
    """Return the loops of one setting in the order of the currents, at the lowest temperature where it varies.

    Where the current is always the same they are in the order of the temperatures; where neither tells them apart, of
    the records.
    """
    rows = select_lowest_temperature(group) if _varies([row.current for row in group], _SAME_CURRENT) else list(group)
    rows = spread_evenly(sorted(rows, key=lambda row: (row.current, row.temperature)), MOST_LINES)
    names = [f"{row.current:.3g} A" for row in rows]
    legend = "current"
    if len(set(names)) < len(rows):
        if all(np.diff([row.temperature for row in rows]) > WARMER):
            return order_by_temperature(group)
        legend, names = "record", [labels.clean_text(row.record.rsplit(",", 1)[0], LONGEST) for row in rows]
    at = f", {rows[0].temperature:.0f} °C" if np.isfinite(rows[0].temperature) and legend == "current" else ""
    return Family(describe_setting(rows[0]) + at, legend, rows, names, style.sample_colours("viridis", len(rows)))


def order_by_temperature(group: Sequence[Row]) -> Family:
    """Return the loops of one setting in the order of the temperatures, at the largest current."""
    rows = spread_evenly(sorted(select_largest_current(group), key=lambda row: row.temperature), MOST_LINES)
    names = [f"{row.temperature:.0f} °C" for row in rows]
    title = f"{describe_setting(rows[0])}, {rows[0].current:.3g} A"
    return Family(title, "temperature", rows, names, style.sample_colours("plasma", len(rows)))


def select_largest_current(group: Sequence[Row]) -> list[Row]:
    """Return the rows at the largest current, within the noise of a measured one."""
    largest = max(row.current for row in group)
    return [row for row in group if row.current >= largest - _SAME_CURRENT]


def select_lowest_temperature(group: Sequence[Row]) -> list[Row]:
    """Return the rows at the lowest temperature, or all where none was recorded."""
    lowest = min(row.temperature for row in group)
    return [row for row in group if not row.temperature > lowest + WARMER]


def describe_setting(row: Row) -> str:
    """Return amplitude and frequency of a row as a picture states them."""
    return f"{1e3 * row.amplitude:.3g} mm, {row.frequency:.3g} Hz"


def measure_legend(families: Sequence[Family]) -> float:
    """Return the width in inches that the legends beside some families, or the bar of a cloud, need."""
    letters = [len(name) for family in families for name in [*family.names, family.legend]]
    return max(0.95, 0.55 + style.LETTER * max(letters, default=0))


def _varies(values: Sequence[float], by: float) -> bool:
    known = [value for value in values if np.isfinite(value)]
    return len(known) > 1 and max(known) - min(known) > by


def group_clouds(rows: Sequence[Row]) -> list[list[Row]]:
    """Return the records without cycles in groups of the same motion."""
    return group_rows([row for row in rows if row.cloud is not None], _moves_alike)[:_MOST_CLOUDS]


def _moves_alike(a: Row, b: Row) -> bool:
    pairs = ((a.amplitude, b.amplitude), (a.peak_speed, b.peak_speed))
    return all(abs(p - q) <= _SAME_MOTION * p for p, q in pairs) and a.current != b.current
