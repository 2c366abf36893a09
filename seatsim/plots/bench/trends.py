"""Peak force, energy and equivalent damping of a characterisation against current and temperature."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.characterisation.rows import WARMER, Row
from seatsim.characterisation.summary import Characterisation, group_by_setting
from seatsim.plots import style
from seatsim.plots.bench.families import describe_setting, select_largest_current, select_lowest_temperature
from seatsim.plots.style import Entry, Grid

MOST = 8
"""Most settings that lines of one panel can tell apart."""


class RowFigure(NamedTuple):
    """A figure of a row: the label of its axis, value, spread, and its values cycle by cycle where these are kept."""

    label: str
    value: Callable[[Row], float]
    spread: Callable[[Row], float] = lambda _: float("nan")
    cycles: Callable[[Row], Sequence[float]] = lambda _: ()


class Abscissa(NamedTuple):
    """What figures are drawn over: the label of the axis, its value, and the name of what a line holds fixed."""

    label: str
    value: Callable[[Row], float]
    fixed: Callable[[Row], str]


PEAKS = (
    RowFigure(
        "peak force\nin rebound [N]", lambda r: r.peak_rebound, lambda r: r.peak_rebound_sd,
        lambda r: (r.cycle_values or {}).get("peak_rebound", ()),
    ),
    RowFigure(
        "peak force in\ncompression [N]", lambda r: -r.peak_compression, lambda r: r.peak_compression_sd,
        lambda r: [-value for value in (r.cycle_values or {}).get("peak_compression", ())],
    ),
)  # fmt: skip
_ENERGY = RowFigure(
    "energy per cycle [J]", lambda r: r.energy, lambda r: r.energy_sd,
    lambda r: (r.cycle_values or {}).get("energy", ()),
)  # fmt: skip
DAMPING = RowFigure(
    "equivalent damping\n[kN·s/m]", lambda r: 1e-3 * r.damping, lambda r: 1e-3 * r.damping_sd,
    lambda r: [1e-3 * value for value in (r.cycle_values or {}).get("damping", ())],
)  # fmt: skip
BY_CURRENT = Abscissa("current [A]", lambda r: r.current, lambda r: f", {r.temperature:.0f} °C")
BY_TEMPERATURE = Abscissa("temperature [°C]", lambda r: r.temperature, lambda r: f", {r.current:.3g} A")
BY_FREQUENCY = Abscissa("frequency [Hz]", lambda r: r.frequency, lambda r: "")


def plot_energy(found: Characterisation) -> Figure:
    """Return peaks, energy and damping over the current, and over the temperature where it varies, line by setting."""
    rows = [row for row in found.rows if row.loop is not None]
    blocks = choose_abscissas(rows)
    looks, note = choose_looks(blocks)
    figures = [[PEAKS[0], PEAKS[1]], [_ENERGY, DAMPING]]
    grid = Grid(heights=(1.9,) * (2 * len(blocks)), columns=2, left=0.9, gap=(0.9, 0.65))
    title = f"Peak force, energy and damping: {found.name}"
    page = style.make_page(title, note, grid, list(looks.values()))
    for index, (across, groups) in enumerate(blocks):
        for panels, row in zip(page.rows[2 * index : 2 * index + 2], figures, strict=True):
            for axes, figure in zip(panels, row, strict=True):
                draw_trend(axes, across, figure, groups, looks)
                if min(figure.value(row) for group in groups for row in group) >= 0.0:
                    axes.set_ylim(bottom=0.0)
    return page.figure


def choose_abscissas(rows: Sequence[Row]) -> list[tuple[Abscissa, list[list[Row]]]]:
    """Return what figures are drawn over, with the groups of rows that make a line each.

    Over the current at the lowest temperature of each setting; over the temperature at its largest current; over the
    frequency where neither varies.
    """
    groups = group_by_setting(rows)
    currents = [select_lowest_temperature(group) for group in groups]
    blocks = []
    if any(len({row.current for row in group}) > 1 for group in currents):
        blocks.append((BY_CURRENT, currents))
    warmed = [select_largest_current(group) for group in groups]
    if _range([row.temperature for row in rows]) > WARMER or any(row.temperature_range > WARMER for row in rows):
        blocks.append((BY_TEMPERATURE, warmed))
    return blocks or [(BY_FREQUENCY, groups)]


def choose_looks(blocks: Sequence[tuple[Abscissa, list[list[Row]]]]) -> tuple[dict[str, Entry], str]:
    """Return the look of each setting, and a note on what is held fixed and what is left out."""
    names = list(dict.fromkeys(describe_setting(group[0]) for _, groups in blocks for group in groups))
    looks = {entry.label: entry for entry in style.make_entries(names[:MOST])}
    parts = []
    for across, groups in blocks:
        fixed = {across.fixed(group[0]).strip(", ") for group in groups}
        if len(fixed) == 1 and not fixed & {"", "nan °C"}:
            parts.append(f"over {across.label.split(' [')[0]} at {fixed.pop()}")
    note = f"{'; '.join(parts)}." if parts else "One line for each amplitude and frequency."
    note = note[0].upper() + note[1:]
    return looks, note + (f" {MOST} of {len(names)} settings are shown." if len(names) > MOST else "")


def draw_trend(
    axes: Axes, across: Abscissa, figure: RowFigure, groups: Sequence[Sequence[Row]], looks: dict[str, Entry]
) -> None:
    """Draw a figure of some groups of rows over a quantity: a line where no two rows are at the same place."""
    for group in groups:
        look = looks.get(describe_setting(group[0]))
        if look is None:
            continue
        ordered = sorted(group, key=across.value)
        x = np.array([across.value(row) for row in ordered])
        y = np.array([figure.value(row) for row in ordered])
        bars = np.nan_to_num([figure.spread(row) for row in ordered])
        apart = bool(np.all(np.diff(x) > (WARMER if across is BY_TEMPERATURE else 0.0)))
        axes.errorbar(
            x, y, bars if np.any(bars) else None, color=look.colour, linestyle=look.dashes if apart else "none",
            linewidth=1.4, marker="o", markersize=4.5, capsize=2.5, elinewidth=0.9,
        )  # fmt: skip
        if across is BY_TEMPERATURE:
            _draw_cycles(axes, ordered, figure, look)
    axes.set_xlabel(across.label)
    axes.set_ylabel(figure.label)


def _draw_cycles(axes: Axes, rows: Sequence[Row], figure: RowFigure, look: Entry) -> None:
    for row in rows:
        values = figure.cycles(row)
        if row.temperature_range > WARMER and len(values):
            warmth = (row.cycle_values or {})["temperature"]
            axes.plot(warmth, values, ".", color=look.colour, markersize=3, alpha=0.5, zorder=1)


def _range(values: Sequence[float]) -> float:
    known = [value for value in values if np.isfinite(value)]
    return max(known) - min(known) if known else 0.0
