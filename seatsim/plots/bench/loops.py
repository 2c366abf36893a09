"""Force-velocity and force-displacement loops of a characterisation, and the clouds of records without cycles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from seatsim.characterisation.rows import Row
from seatsim.characterisation.summary import WARMER, Characterisation, group_by_setting, group_rows
from seatsim.plots import labels, style
from seatsim.plots.style import LETTER, SAMPLE, Entry, Grid

T = TypeVar("T")

MOST = 6
"""Most settings whose loops are drawn."""
MOST_WARM = 2
"""Most settings whose loops are drawn by temperature."""
MOST_CLOUDS = 3
MOST_LINES = 8
LONGEST = 24
"""Letters of a record's name in a legend."""
SAME_CURRENT = 0.02
"""A; difference of currents that are the same but for their noise."""
ALIKE = 0.1
"""Relative difference of strokes and speeds of records whose clouds share their panels."""


class Family(NamedTuple):
    """Rows that are drawn together: their title, that of the legend, and name and colour of each."""

    title: str
    legend: str
    rows: list[Row]
    names: list[str]
    colours: list[str]


def loops(found: Characterisation) -> Figure:
    """Return the loops by current for each amplitude and frequency, by temperature where it varies, and clouds."""
    families, left_out = loop_families(found.rows)
    clouds = _clouds(found.rows)
    drawn = len(families) + len(clouds)
    names = [name for family in families for name in [*family.names, family.legend]]
    names += [f"{row.current:.2f} A" for group in clouds for row in group]
    right = max(1.3, 0.35 + SAMPLE + LETTER * max(map(len, names), default=0))
    note = "Mean of the steady cycles." if found.measured else "Last cycle of a sine test."
    note = note if families else "Records without steady cycles."
    note += f" {left_out} further settings are not shown." if left_out else ""
    grid = Grid(heights=(2.6,) * drawn, columns=2, right=right, top=0.35, gap=(0.35, 0.95))
    page = style.page(f"Loops: {labels.clean(found.name, labels.LONGEST_TITLE)}", note, grid)
    for panels, family in zip(page.rows, families, strict=False):
        _draw(panels, family)
    for panels, group in zip(page.rows[len(families) :], clouds, strict=True):
        _draw_clouds(panels, group)
    return page.figure


def loop_families(rows: Sequence[Row]) -> tuple[list[Family], int]:
    """Return the families of loops by current, then by temperature, and the number of settings left out."""
    groups = group_by_setting(rows)
    chosen = _spread(groups, MOST)
    families = [by_current(group) for group in chosen]
    warm = [group for group in chosen if _varied([row.temperature for row in strongest(group)], WARMER)]
    warm = [group for group in warm if _varied([row.current for row in group], SAME_CURRENT)]
    families += [by_temperature(group) for group in _spread(warm, MOST_WARM)]
    return families, len(groups) - len(chosen)


def by_current(group: Sequence[Row]) -> Family:
    """Return the loops of one setting in the order of the currents, at the lowest temperature where it varies.

    Where the current is always the same they are in the order of the temperatures; where neither tells them apart, of
    the records.
    """
    rows = coldest(group) if _varied([row.current for row in group], SAME_CURRENT) else list(group)
    rows = _spread(sorted(rows, key=lambda row: (row.current, row.temperature)), MOST_LINES)
    names = [f"{row.current:.3g} A" for row in rows]
    legend = "current"
    if len(set(names)) < len(rows):
        if all(np.diff([row.temperature for row in rows]) > WARMER):
            return by_temperature(group)
        legend, names = "record", [labels.clean(row.record.rsplit(",", 1)[0], LONGEST) for row in rows]
    at = f", {rows[0].temperature:.0f} °C" if np.isfinite(rows[0].temperature) and legend == "current" else ""
    return Family(setting(rows[0]) + at, legend, rows, names, style.scale("viridis", len(rows)))


def by_temperature(group: Sequence[Row]) -> Family:
    """Return the loops of one setting in the order of the temperatures, at the largest current."""
    rows = _spread(sorted(strongest(group), key=lambda row: row.temperature), MOST_LINES)
    names = [f"{row.temperature:.0f} °C" for row in rows]
    title = f"{setting(rows[0])}, {rows[0].current:.3g} A"
    return Family(title, "temperature", rows, names, style.scale("plasma", len(rows)))


def strongest(group: Sequence[Row]) -> list[Row]:
    """Return the rows at the largest current, within the noise of a measured one."""
    largest = max(row.current for row in group)
    return [row for row in group if row.current >= largest - SAME_CURRENT]


def coldest(group: Sequence[Row]) -> list[Row]:
    """Return the rows at the lowest temperature, or all where none was recorded."""
    lowest = min(row.temperature for row in group)
    return [row for row in group if not row.temperature > lowest + WARMER]


def setting(row: Row) -> str:
    """Return amplitude and frequency of a row as a picture states them."""
    return f"{1e3 * row.amplitude:.3g} mm, {row.frequency:.3g} Hz"


def _varied(values: Sequence[float], by: float) -> bool:
    known = [value for value in values if np.isfinite(value)]
    return len(known) > 1 and max(known) - min(known) > by


def _spread(items: Sequence[T], most: int) -> list[T]:
    """Return at most so many items, spread evenly, first and last included."""
    if len(items) <= most:
        return list(items)
    return [items[index * (len(items) - 1) // (most - 1)] for index in range(most)]


def _draw(panels: Sequence[Axes], family: Family) -> None:
    for row, name, colour in zip(family.rows, family.names, family.colours, strict=True):
        if row.loop is None:
            continue
        look = Entry(name, colour, width=1.5)
        middle = 0.5 * (np.max(row.loop.displacement) + np.min(row.loop.displacement))
        style.line(panels[0], row.loop.velocity, row.loop.force, look)
        style.line(panels[1], 1e3 * (row.loop.displacement - middle), row.loop.force, look)
    _label(panels, family.title, "displacement from mid-stroke [mm]")
    style.beside(panels[1], family.legend)


def _label(panels: Sequence[Axes], title: str, displacement: str) -> None:
    panels[0].set_title(title, loc="left", fontsize=10.5)
    panels[0].set_xlabel("velocity [m/s]")
    panels[1].set_xlabel(displacement)
    panels[0].set_ylabel("damper force [N]")
    panels[0].locator_params(axis="x", nbins=6)
    panels[1].set_ylim(panels[0].get_ylim())
    panels[1].tick_params(labelleft=False)


def _clouds(rows: Sequence[Row]) -> list[list[Row]]:
    """Return the records without cycles in groups of the same motion."""
    return group_rows([row for row in rows if row.cloud is not None], _alike)[:MOST_CLOUDS]


def _alike(a: Row, b: Row) -> bool:
    pairs = ((a.amplitude, b.amplitude), (a.peak_speed, b.peak_speed))
    return all(abs(p - q) <= ALIKE * p for p, q in pairs) and a.current != b.current


def _draw_clouds(panels: Sequence[Axes], group: Sequence[Row]) -> None:
    most = max(float(np.percentile(row.cloud.current, 99)) for row in group if row.cloud is not None)
    look: dict[str, Any] = {
        "cmap": colormaps["viridis"],
        "norm": Normalize(0.0, max(most, 1e-9) / 0.85),
        "linewidths": 0,
    }
    switched = False
    for row in sorted(group, key=lambda row: -row.current):
        if row.cloud is None:
            continue
        x, v, force, current = row.cloud
        switched |= float(np.ptp(current)) > 0.05 * most
        for axes, across in ((panels[0], v), (panels[1], 1e3 * x)):
            dots = axes.scatter(across, force, c=current, s=5, alpha=0.6, label=f"{row.current:.3g} A", **look)
    names = list(dict.fromkeys(row.record.split(",")[0] for row in group))
    title = names[0] if len(names) == 1 else f"{names[0]} and {len(names) - 1} more"
    _label(panels, f"{labels.clean(title, labels.LONGEST)}, not cyclic", "displacement [mm]")
    if switched:
        box = panels[1].get_position()
        beside = panels[1].figure.add_axes((box.x1 + 0.02, box.y0, 0.015, box.height))
        bar = panels[1].figure.colorbar(dots, cax=beside, label="current [A]")
        if bar.solids is not None:
            bar.solids.set_alpha(1.0)
        beside.set_ylim(0.0, most)
    else:
        legend = panels[1].legend(
            title="current", alignment="left", loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False,
            borderaxespad=0, markerscale=2.5, reverse=True,
        )  # fmt: skip
        for handle in legend.legend_handles:
            if handle is not None:
                handle.set_alpha(1.0)
