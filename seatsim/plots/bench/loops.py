"""Loops of a characterisation: which records share their panels, in which order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from seatsim.characterisation.rows import WARMER, Row
from seatsim.characterisation.summary import Characterisation, group_by_setting
from seatsim.plots.loops import Family, plot_families
from seatsim.plots.style import clean_text
from seatsim.plots.thinning import spread_evenly
from seatsim.simulation.damper_bench import SineTest

MOST, _MOST_WARM = 6, 2
"""Most settings whose loops are drawn by current, and by temperature."""
MOST_LINES = 8
"""Most loops that the colours of one panel can tell apart."""
_LONGEST = 24
"""Letters of a record's name in a legend."""
_SAME_CURRENT = 0.02
"""A; difference of currents that are the same but for their noise."""


def plot_loops(found: Characterisation) -> Figure:
    """Return the loops by current for each amplitude and frequency, and by temperature where it varies."""
    families, left_out = _find_families(found.rows)
    note = "Mean of the steady cycles. Displacement from mid-stroke."
    note += f" {left_out} further settings are not shown." if left_out else ""
    return plot_families(f"Loops: {found.name}", note, families)


def _find_families(rows: Sequence[Row]) -> tuple[list[Family], int]:
    """Return the families of loops by current, then by temperature, and the number of settings left out."""
    groups = group_by_setting(rows)
    chosen = spread_evenly(groups, MOST)
    warm = [group for group in chosen if _varies([row.temperature for row in select_largest_current(group)], WARMER)]
    warm = [group for group in warm if _varies([row.current for row in group], _SAME_CURRENT)]
    families = [*map(_order_by_current, chosen), *map(_order_by_temperature, spread_evenly(warm, _MOST_WARM))]
    return families, len(groups) - len(chosen)


def _order_by_current(group: Sequence[Row]) -> Family:
    """Return the loops of one setting in the order of the currents, at the lowest temperature where it varies.

    Where the current is always the same they are in the order of the temperatures; where neither tells them apart, of
    the records.
    """
    rows = select_lowest_temperature(group) if _varies([row.current for row in group], _SAME_CURRENT) else list(group)
    rows = spread_evenly(sorted(rows, key=lambda row: (row.current, row.temperature)), MOST_LINES)
    legend, names = "current", [f"{row.current:.3g} A" for row in rows]
    if len(set(names)) < len(rows):
        if all(np.diff([row.temperature for row in rows]) > WARMER):
            return _order_by_temperature(group)
        full = [row.record for row in rows]
        # The current, or the time in the record, stands behind the last comma; it may be all that differs.
        short = [name.rpartition(",")[0] or name for name in full]
        legend = "record"
        names = [clean_text(name, _LONGEST) for name in (short if len(set(short)) == len(rows) else full)]
    at = f", {rows[0].temperature:.0f} °C" if np.isfinite(rows[0].temperature) and legend == "current" else ""
    return Family(describe_setting(rows[0]) + at, legend, list(zip(names, map(_centre_loop, rows), strict=True)))


def _order_by_temperature(group: Sequence[Row]) -> Family:
    """Return the loops of one setting in the order of the temperatures, at the largest current."""
    rows = spread_evenly(sorted(select_largest_current(group), key=lambda row: row.temperature), MOST_LINES)
    loops = [(f"{row.temperature:.0f} °C", _centre_loop(row)) for row in rows]
    return Family(f"{describe_setting(rows[0])}, {rows[0].current:.3g} A", "temperature", loops, "plasma")


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


def _centre_loop(row: Row) -> SineTest:
    """Return the loop of a row with its displacement from mid-stroke."""
    assert row.loop is not None
    x = row.loop.displacement
    return row.loop._replace(displacement=x - 0.5 * (np.max(x) + np.min(x)))


def _varies(values: Sequence[float], by: float) -> bool:
    known = [value for value in values if np.isfinite(value)]
    return len(known) > 1 and max(known) - min(known) > by
