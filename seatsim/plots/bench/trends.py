"""Peak force, energy, damping and asymmetry of a characterisation against current and temperature; its warm-up."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.characterisation.rows import WARMER, Row
from seatsim.characterisation.sheet import WarmUp
from seatsim.characterisation.summary import Characterisation, group_by_setting
from seatsim.plots import style
from seatsim.plots.bench.loops import describe_setting, select_largest_current, select_lowest_temperature
from seatsim.plots.style import Entry, Grid
from seatsim.plots.thinning import spread_evenly
from seatsim.schema.arrays import Array

MOST = 8
"""Most settings that lines of one panel can tell apart."""


class _Figure(NamedTuple):
    """A figure of a row: the label of its axis, its name, factor from SI to the unit shown, least end of the axis."""

    label: str
    name: str
    factor: float = 1.0
    least: float = 0.0

    def read(self, row: Row) -> tuple[float, float, Array]:
        """Return value, spread over the cycles, and the values of these where they are kept."""
        spread = getattr(row, f"{self.name}_sd", np.nan)
        cycles = np.array((row.cycle_values or {}).get(self.name, ()))
        return self.factor * getattr(row, self.name), abs(self.factor) * spread, self.factor * cycles


class Abscissa(NamedTuple):
    """What figures are drawn over: the label of the axis, its value, and the name of what a line holds fixed."""

    label: str
    value: Callable[[Row], float]
    fixed: Callable[[Row], str]


_ENERGY = (
    _Figure("peak force\nin rebound [N]", "peak_rebound"),
    _Figure("peak force in\ncompression [N]", "peak_compression", -1.0),
    _Figure("energy per cycle [J]", "energy"),
    _Figure("equivalent damping\n[kN·s/m]", "damping", 1e-3),
)
_ASYMMETRY = (
    _Figure("asymmetric part /\nRMS force [%]", "asymmetry", 100.0, 2.0),
    _Figure("asymmetry without the\nmean force [%]", "asymmetry_of_shape", 100.0, 2.0),
)
BY_CURRENT = Abscissa("current [A]", lambda r: r.current, lambda r: f", {r.temperature:.0f} °C")
BY_TEMPERATURE = Abscissa("temperature [°C]", lambda r: r.temperature, lambda r: f", {r.current:.3g} A")
BY_FREQUENCY = Abscissa("frequency [Hz]", lambda r: r.frequency, lambda r: "")


def plot_energy(found: Characterisation) -> Figure:
    """Return peaks, energy and damping over the current, and over the temperature where it varies, line by setting."""
    return _plot_trends(f"Peak force, energy and damping: {found.name}", "", found, _ENERGY)


def plot_asymmetry(found: Characterisation) -> Figure:
    """Return the asymmetric part of the loops over the same."""
    formula = "½ (F(t) + F(t + T/2))".replace(" ", "\u00a0")
    note = f"Asymmetric part: difference from the centrosymmetric loop, {formula}; RMS over a cycle. "
    return _plot_trends(f"Asymmetry: {found.name}", note, found, _ASYMMETRY)


def plot_warm_up(found: Characterisation) -> Figure:
    """Return the force of each cycle, over that of the first, against the energy that the damper absorbed before it."""
    records = dict[str, list[WarmUp]]()
    for cycle in found.sheet.warm_up:
        records.setdefault(cycle.record, []).append(cycle)
    shown = spread_evenly([*records.values()], MOST)
    looks = style.make_entries([_name_warm_up(cycles) for cycles in shown])
    note = "Force at the peak speed of each cycle. The number at the end of a line is the damper's last temperature."
    title = f"Fade as the damper warms up: {found.name}"
    figure, [[panel]] = style.make_page(title, note, Grid((2.8,), right=0.6), looks)
    for cycles, look in zip(shown, looks, strict=True):
        energy, share = [1e-3 * each.absorbed for each in cycles], [each.relative_force for each in cycles]
        style.draw_line(panel, energy, share, look)
        if np.isfinite(cycles[-1].temperature):
            panel.text(energy[-1], share[-1], f" {cycles[-1].temperature:.0f} °C", fontsize=style.FONT, va="center")
    panel.set(xlabel="absorbed energy [kJ]", ylabel="force / that of the first cycle [-]")
    return style.name_coincident(figure)


def _name_warm_up(cycles: Sequence[WarmUp]) -> str:
    first = cycles[0]
    since = f", from {first.temperature:.0f} °C" if np.isfinite(first.temperature) else ""
    return f"{first.record}, {first.current:.3g} A{since}"


def _plot_trends(title: str, note: str, found: Characterisation, figures: Sequence[_Figure]) -> Figure:
    rows = [row for row in found.rows if row.loop is not None]
    blocks = choose_abscissas(rows)
    looks, fixed = choose_looks(blocks)
    if any(np.isfinite(getattr(row, f"{figure.name}_sd", np.nan)) for row in rows for figure in figures):
        fixed += " Error bars, where larger than a dot: standard deviation over the cycles."
    if any(row.temperature_range > WARMER and row.cycle_values for row in rows):
        fixed += " Small dots: each cycle."
    grid = Grid((1.9,) * (len(figures) // 2 * len(blocks)), columns=2, gap=(0.9, 0.65))
    page = style.make_page(title, note + fixed, grid, list(looks.values()))
    panels = iter(page.list_panels())
    for across, groups in blocks:
        for figure in figures:
            _draw_trend(next(panels), across, figure, groups, looks)
    return style.name_coincident(page.figure)


def choose_abscissas(rows: Sequence[Row]) -> list[tuple[Abscissa, list[list[Row]]]]:
    """Return what figures are drawn over, with the groups of rows that make a line each.

    Over the current at the lowest temperature of each setting; over the temperature at its largest current; over the
    frequency where neither varies.
    """
    groups = group_by_setting(rows)
    currents, warmed = (list(map(select, groups)) for select in (select_lowest_temperature, select_largest_current))
    blocks = []
    if any(len({row.current for row in group}) > 1 for group in currents):
        blocks.append((BY_CURRENT, currents))
    known = [row.temperature for row in rows if np.isfinite(row.temperature)]
    if (known and max(known) - min(known) > WARMER) or any(row.temperature_range > WARMER for row in rows):
        blocks.append((BY_TEMPERATURE, warmed))
    return blocks or [(BY_FREQUENCY, groups)]


def choose_looks(blocks: Sequence[tuple[Abscissa, list[list[Row]]]]) -> tuple[dict[str, Entry], str]:
    """Return the look of each setting, and a note on what is held fixed and what is left out."""
    names = list(dict.fromkeys(describe_setting(group[0]) for _, groups in blocks for group in groups))
    looks = {entry.label: entry._replace(mark="o") for entry in style.make_entries(names[:MOST])}
    parts = []
    for across, groups in blocks:
        fixed = {across.fixed(group[0]).strip(", ") for group in groups}
        if len(fixed) == 1 and not fixed & {"", "nan °C"}:
            parts.append(f"over {across.label.split(' [')[0]} at {fixed.pop()}")
    note = f"{'; '.join(parts)}." if parts else "One line for each amplitude and frequency."
    note = note[0].upper() + note[1:]
    return looks, note + (f" {MOST} of {len(names)} settings are shown." if len(names) > MOST else "")


def _draw_trend(
    axes: Axes, across: Abscissa, figure: _Figure, groups: Sequence[Sequence[Row]], looks: dict[str, Entry]
) -> None:
    """Draw a figure of some groups of rows over a quantity: a line where no two rows are at the same place."""
    for group in groups:
        look = looks.get(describe_setting(group[0]))
        if look is None:
            continue
        ordered = sorted(group, key=across.value)
        places = [across.value(row) for row in ordered]
        values, spreads, cycles = zip(*map(figure.read, ordered), strict=True)
        apart = bool(np.all(np.diff(places) > (WARMER if across is BY_TEMPERATURE else 0.0)))
        drawn = look if apart else look._replace(dashes="none")
        style.draw_line(axes, places, values, drawn)
        axes.errorbar(
            places, values, np.nan_to_num(spreads), fmt="none", ecolor=look.colour, capsize=2.5, elinewidth=0.9
        )
        for row, each in zip(ordered, cycles, strict=True):
            if across is BY_TEMPERATURE and row.temperature_range > WARMER and len(each):
                warmth = (row.cycle_values or {})["temperature"]
                axes.plot(warmth, each, ".", color=look.colour, markersize=3, alpha=0.5, zorder=1)
    low, high = axes.get_ylim()
    # A marker at the top is whole although the axis begins at 0, far from the lowest.
    high = max(high, 1.05 * axes.dataLim.y1, figure.least)
    axes.set(xlabel=across.label, ylabel=figure.label, ylim=(min(0.0, low), high))
