"""The asymmetric part of the loops against current and temperature, and normalised loops."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.characterisation.summary import Characterisation, group_by_setting
from seatsim.plots import style
from seatsim.plots.bench.families import Family, measure_legend, order_by_current, order_by_temperature
from seatsim.plots.bench.trends import BY_TEMPERATURE, RowFigure, choose_abscissas, choose_looks, draw_trend
from seatsim.plots.style import Entry, Grid

_WHOLE = RowFigure("asymmetric part /\nRMS force [%]", lambda r: 100.0 * r.asymmetry)
_SHAPE = RowFigure("the same, less\nthe offset [%]", lambda r: 100.0 * r.asymmetry_of_shape)


def plot_asymmetry(found: Characterisation) -> Figure:
    """Return the asymmetric part over current and temperature, then normalised loops and the part over velocity."""
    rows = [row for row in found.rows if row.loop is not None]
    blocks = choose_abscissas(rows)
    looks, _ = choose_looks(blocks)
    group = max(reversed(group_by_setting(rows)), key=len)
    families = [order_by_current(group)]
    if any(across is BY_TEMPERATURE for across, _ in blocks) and len({row.current for row in group}) > 1:
        families.append(order_by_temperature(group))
    note = "Asymmetric part: difference from the centrosymmetric loop, (F(t) + F(t + T/2)) / 2; RMS over a cycle."
    heights = (1.8,) * (len(blocks) + len(families))
    grid = Grid(heights, columns=2, right=measure_legend(families), top=0.2, gap=(0.8, 0.8))
    page = style.make_page(f"Asymmetry: {found.name}", note, grid, list(looks.values()))
    for panels, (across, groups) in zip(page.rows, blocks, strict=False):
        for axes, figure in zip(panels, (_WHOLE, _SHAPE), strict=True):
            draw_trend(axes, across, figure, groups, looks)
            axes.set_ylim(0.0, max(1.0, axes.get_ylim()[1]))
    for panels, family in zip(page.rows[len(blocks) :], families, strict=True):
        _draw_normalised(panels, family)
    return page.figure


def _draw_normalised(panels: Sequence[Axes], family: Family) -> None:
    """Draw loops divided by their peak force, and their asymmetric parts in N, both over velocity / peak velocity."""
    size = 0.0
    for row, name, colour in zip(family.rows, family.names, family.colours, strict=True):
        if row.loop is None:
            continue
        look = Entry(name, colour, width=1.4)
        velocity = row.loop.velocity / np.max(np.abs(row.loop.velocity))
        style.draw_line(panels[0], velocity, row.loop.force / row.loop.peak_force, look)
        style.draw_line(panels[1], velocity, row.loop.asymmetric_part, look)
        size = max(size, row.asymmetry_peak)
    # The scale of a symmetric loop would show nothing but rounding.
    if size < 1.0:
        panels[1].set_ylim(-1.0, 1.0)
    panels[0].set_title(family.title, loc="left", fontsize=style.FONT)
    panels[0].set_ylabel("force / peak force [-]")
    panels[1].set_ylabel("asymmetric part [N]")
    for axes in panels:
        axes.set_xlabel("velocity / peak [-]")
    style.draw_legend_beside(panels[1], family.legend)
