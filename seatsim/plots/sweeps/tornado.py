"""How far each key swings a metric, and which share of its variance it explains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes

from seatsim.plots.frame import FONT, WIDE, Picture, make_frame, name_rows
from seatsim.plots.labels import clean_text
from seatsim.plots.style import COLOURS, DARK, Entry, Grid
from seatsim.plots.sweeps.naming import describe_column, format_level
from seatsim.sweeps.statistics.inputs import SweepRows
from seatsim.sweeps.statistics.sensitivity import Sensitivity

ROW = 0.36
MOST = 14
"""Keys that are drawn, the strongest ones: more do not fit on a screen."""
LOW, HIGH = Entry("at the low value", COLOURS[0], width=5.0), Entry("at the high value", COLOURS[1], width=5.0)
FIRST, TOTAL = Entry("alone", COLOURS[2], width=5.0), Entry("with interactions", DARK, width=1.4)
LONGEST_VALUE = 12
BESIDE = 0.75
"""Margin on either side, as a share of the longest swing, that holds the longest value beside its bar."""
WORDS_WIDTH = 2.3
"""Inches for the names of keys."""


def plot_tornado(found: Sequence[Sensitivity], rows: SweepRows) -> Picture:
    """Return the swing of one metric and the Sobol indices of its keys, side by side, the strongest key on top."""
    shown, metric = found[:MOST], found[0].metric
    quantity = describe_column(metric, rows.units)
    legend = [LOW, HIGH, FIRST, TOTAL]
    page = make_frame(Grid((ROW * len(shown) + 0.2,), 2, left=WORDS_WIDTH, top=0.15, gap=(0.35, 0.0)), legend, WIDE)
    swing, shares = page.rows[0]
    middle = float(rows.usable[metric].mean())
    for number, row in enumerate(shown):
        _draw_swing(swing, number, row, quantity.factor, middle)
        shares.barh(number, row.first, height=0.6, color=FIRST.colour, zorder=2)
        shares.plot(
            [row.total_low, row.total_high], [number, number], color=TOTAL.colour, linewidth=TOTAL.width, zorder=3
        )
        shares.plot(row.total, number, "|", color=TOTAL.colour, markersize=9, zorder=4)
    swing.axvline(quantity.factor * middle, color=DARK, linewidth=0.9, zorder=3)
    name_rows(swing, [_name(row.key, rows.units) for row in shown])
    name_rows(shares, [""] * len(shown))
    swing.margins(x=BESIDE)
    swing.set_xlabel(quantity.axis)
    shares.set_xlim(0, 1.02)
    shares.set_xlabel("share of the variance [-]")
    cut = f" The {MOST} strongest of {len(found)} keys." if len(found) > MOST else ""
    caption = (
        "Left: mean at the 5 % and 95 % quantiles of each key (of a text: at its least and its greatest mean). Right:"
        f" Sobol indices of a polynomial chaos expansion, with 95 % intervals of the total ones.{cut}"
    )
    return Picture(f"What {quantity.words} hangs on", caption, page.figure)


def _name(key: str, units: Mapping[str, str]) -> str:
    """Return a key with its unit, in which its values stand beside the bars."""
    return f"{key} [{units[key]}]" if units.get(key, "-") not in ("", "-") else key


def _draw_swing(axes: Axes, number: int, row: Sensitivity, factor: float, middle: float) -> None:
    ends = [(row.at_low, row.low, LOW), (row.at_high, row.high, HIGH)]
    for at, _, look in sorted(ends, key=lambda end: -abs(end[0] - middle)):
        axes.barh(number, factor * (at - middle), left=factor * middle, height=0.6, color=look.colour, zorder=2)
    lower, higher = sorted(ends, key=lambda end: end[0])
    for (_, value, _), at, side in ((lower, min(lower[0], middle), -1), (higher, max(higher[0], middle), 1)):
        axes.annotate(
            clean_text(format_level(value), LONGEST_VALUE), (factor * at, number), xytext=(4 * side, 0),
            textcoords="offset points", va="center", ha="right" if side < 0 else "left", fontsize=FONT - 1.5,
        )  # fmt: skip
