"""All figures of a characterisation but its loops: force, energy and damping over current and temperature.

And the response of the force to steps of the current.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.characterisation.rows import WARMER, Row
from seatsim.characterisation.sheet import StepResponse
from seatsim.characterisation.steps import Response
from seatsim.characterisation.summary import Characterisation, group_by_setting
from seatsim.plots import style
from seatsim.plots.bench.loops import describe_setting, plot_loops, select_largest_current, select_lowest_temperature
from seatsim.plots.style import GREY, Entry, Grid
from seatsim.plots.thinning import spread_evenly

_MOST_STEPS = 6
"""Most responses in a panel."""
SHOWN = 3.6
"""Length of a panel over the longest time to 90 %."""
_TIMES = (("t10", 0.1), ("t63", 1.0 - math.exp(-1.0)), ("t90", 0.9))
"""Times that are marked, with the shares of the change that they are of."""
MOST = 8
"""Most settings that lines of one panel can tell apart."""


def plot_characterisation(found: Characterisation) -> dict[str, Figure]:
    """Return the figures of a characterisation by name.

    `loops` and `energy` are there where there are cycles, `steps` where a response was determined.
    """
    is_cyclic = any(row.loop is not None for row in found.rows)
    plots = {
        "loops": (plot_loops, is_cyclic),
        "energy": (_plot_energy, is_cyclic),
        "steps": (_plot_steps, any(answer.share is not None for answer in found.responses)),
    }
    return {name: plot(found) for name, (plot, is_known) in plots.items() if is_known}


def _plot_steps(found: Characterisation) -> Figure:
    """Return the share of the change that the force has covered over time, rise and fall of the current apart."""
    answers = [answer for answer in found.responses if answer.share is not None]
    known = list(zip(answers, found.sheet.response, strict=True))
    speeds = {f"{answer.speed:.3g} m/s" for answer in answers if math.isfinite(answer.speed)}
    at = f", at {speeds.pop()}" if len(speeds) == 1 else ""
    starts = ("the commanded step", "the current's own 10 %")
    start = " or ".join(starts[own] for own in sorted({math.isfinite(each.current_t10) for each in answers}))
    note = f"Share of the force's change that is covered{at}. Time counts from {start}."
    shown = [spread_evenly([pair for pair in known if pair[0].rises == rises], _MOST_STEPS) for rises in (True, False)]
    if (count := sum(map(len, shown))) < len(known):
        note += f" {count} of {len(known)} steps are shown."
    # The legends stand below the panels, where they cover nothing.
    room = 0.75 + style.LINE * max(map(len, shown))
    grid = Grid((3.0,), columns=2, top=0.3, bottom=room, gap=(0.3, 0.0))
    figure, [[left, right]] = style.make_page(f"Response to steps of current: {found.name}", note, grid)
    for axes, words, pairs in zip((left, right), ("rises", "falls"), shown, strict=True):
        _draw_responses(axes, pairs)
        style.set_title(axes, f"current {words}")
    left.set_ylabel("share of the change [-]")
    right.tick_params(labelleft=False)
    return style.name_coincident(figure)


def _draw_responses(axes: Axes, shown: list[tuple[Response, StepResponse]]) -> None:
    if not shown:
        return style.explain_empty(axes, "none determined")
    end, top = SHOWN * max((row.t90 for _, row in shown if math.isfinite(row.t90)), default=0.05), 1.2
    for (answer, row), colour in zip(shown, style.sample_colours("viridis", len(shown)), strict=True):
        assert answer.time is not None and answer.share is not None
        start = answer.current_t10 if math.isfinite(answer.current_t10) else 0.0
        name = f"{round(answer.before, 2):g} to {round(answer.after, 2):g} A"
        style.draw_line(axes, 1e3 * (answer.time - start), answer.share, Entry(name, colour, width=1.7))
        for time, share in _TIMES:
            axes.plot(1e3 * getattr(row, time), share, "o", color=colour, markersize=4)
        top = max(top, float(np.max(answer.share)) + 0.05)
    for _, share in _TIMES:
        axes.axhline(share, color=GREY, linewidth=0.7, linestyle=(0.0, (1.0, 2.0)))
    axes.set(xlabel="time [ms]", xlim=(-0.08e3 * end, 1e3 * end), ylim=(-0.15, top))
    axes.set_yticks([0, *(share for _, share in _TIMES)], ["0", *(f"{share:.2g}" for _, share in _TIMES)])
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.17), fontsize=style.FONT, frameon=False, borderaxespad=0)


class _Figure(NamedTuple):
    """A figure of a row: the label of its axis, its name, factor from SI to the unit shown."""

    label: str
    name: str
    factor: float = 1.0

    def read(self, row: Row) -> tuple[float, float]:
        """Return value and spread over the cycles."""
        return self.factor * getattr(row, self.name), abs(self.factor) * getattr(row, f"{self.name}_sd", np.nan)


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
_BY_CURRENT = Abscissa("current [A]", lambda r: r.current, lambda r: f"{r.temperature:.0f} °C")
_BY_TEMPERATURE = Abscissa("temperature [°C]", lambda r: r.temperature, lambda r: f"{r.current:.3g} A")
_BY_FREQUENCY = Abscissa("frequency [Hz]", lambda r: r.frequency, lambda r: "")


def _plot_energy(found: Characterisation) -> Figure:
    """Return peaks, energy and damping over the current, and over the temperature where it varies, line by setting."""
    rows = [row for row in found.rows if row.loop is not None]
    blocks = _choose_abscissas(rows)
    looks, note = choose_looks(blocks)
    if any(np.isfinite(getattr(row, f"{figure.name}_sd", np.nan)) for row in rows for figure in _ENERGY):
        note += " Error bars, where larger than a dot: standard deviation over the cycles."
    grid = Grid((1.9,) * (len(_ENERGY) // 2 * len(blocks)), columns=2, gap=(0.9, 0.65))
    page = style.make_page(f"Peak force, energy and damping: {found.name}", note, grid, list(looks.values()))
    for axes, (block, figure) in zip(page.list_panels(), product(blocks, _ENERGY), strict=True):
        _draw_trend(axes, *block, figure, looks)
    return style.name_coincident(page.figure)


def _choose_abscissas(rows: Sequence[Row]) -> list[tuple[Abscissa, list[list[Row]]]]:
    """Return what figures are drawn over, with the groups of rows that make a line each.

    Over the current at the lowest temperature of each setting; over the temperature at its largest current; over the
    frequency where neither varies.
    """
    groups = group_by_setting(rows)
    currents, warmed = (list(map(select, groups)) for select in (select_lowest_temperature, select_largest_current))
    blocks = []
    if any(len({row.current for row in group}) > 1 for group in currents):
        blocks.append((_BY_CURRENT, currents))
    known = [row.temperature for row in rows if np.isfinite(row.temperature)]
    if (known and max(known) - min(known) > WARMER) or any(row.temperature_range > WARMER for row in rows):
        blocks.append((_BY_TEMPERATURE, warmed))
    return blocks or [(_BY_FREQUENCY, groups)]


def choose_looks(blocks: Sequence[tuple[Abscissa, list[list[Row]]]]) -> tuple[dict[str, Entry], str]:
    """Return the look of each setting, and a note on what is held fixed and what is left out."""
    names = list(dict.fromkeys(describe_setting(group[0]) for _, groups in blocks for group in groups))
    looks = {entry.label: entry._replace(mark="o") for entry in style.make_entries(names[:MOST])}
    parts = []
    for across, groups in blocks:
        fixed = {across.fixed(group[0]) for group in groups}
        if len(fixed) == 1 and not fixed & {"", "nan °C"}:
            parts.append(f"over {across.label.split(' [')[0]} at {fixed.pop()}")
    note = f"{'; '.join(parts)}." if parts else "One line for each amplitude and frequency."
    more = f" {MOST} of {len(names)} settings are shown." if len(names) > MOST else ""
    return looks, f"{note[0].upper()}{note[1:]}{more}"


def _draw_trend(
    axes: Axes, across: Abscissa, groups: Sequence[Sequence[Row]], figure: _Figure, looks: dict[str, Entry]
) -> None:
    """Draw a figure of some groups of rows over a quantity: a line where no two rows are at the same place."""
    shown = [(group, looks[name]) for group in groups if (name := describe_setting(group[0])) in looks]
    for group, look in shown:
        ordered = sorted(group, key=across.value)
        places = [across.value(row) for row in ordered]
        values, spreads = zip(*map(figure.read, ordered), strict=True)
        apart = bool(np.all(np.diff(places) > (WARMER if across is _BY_TEMPERATURE else 0.0)))
        style.draw_line(axes, places, values, look if apart else look._replace(dashes="none"))
        ends = np.nan_to_num(spreads)
        axes.errorbar(places, values, ends, fmt="none", ecolor=look.colour, capsize=2.5, elinewidth=0.9)
    low, high = axes.get_ylim()
    # A marker at the top is whole although the axis begins at 0, far from the lowest.
    high = max(high, 1.05 * axes.dataLim.y1)
    axes.set(xlabel=across.label, ylabel=figure.label, ylim=(min(0.0, low), high))
