"""The asymmetric part of the loops against current and temperature, and normalised loops."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.characterisation.summary import Characterisation, group_by_setting
from seatsim.plots import labels, style
from seatsim.plots.bench.loops import Family, by_current, by_temperature
from seatsim.plots.bench.trends import BY_TEMPERATURE, Figured, blocks_of, looks_of, trend
from seatsim.plots.style import Entry, Grid

WHOLE = Figured("asymmetric part / RMS force [%]", lambda r: 100.0 * r.asymmetry)
SHAPE = Figured("the same, less the offset [%]", lambda r: 100.0 * r.asymmetry_of_shape)


def asymmetry(found: Characterisation) -> Figure:
    """Return the asymmetric part over current and temperature, then normalised loops and the part over velocity."""
    rows = [row for row in found.rows if row.loop is not None]
    blocks = blocks_of(rows)
    looks, _ = looks_of(blocks)
    group = max(reversed(group_by_setting(rows)), key=len)
    families = [by_current(group)]
    if any(across is BY_TEMPERATURE for across, _ in blocks) and len({row.current for row in group}) > 1:
        families.append(by_temperature(group))
    note = "Asymmetric part: difference from the centrosymmetric loop, (F(t) + F(t + T/2)) / 2; RMS over a cycle."
    heights = (2.6,) * (len(blocks) + len(families))
    widest = max(len(name) for family in families for name in [*family.names, family.legend])
    grid = Grid(heights, columns=2, right=0.3 + style.SAMPLE + style.LETTER * widest, gap=(0.95, 0.85))
    title = f"Asymmetry: {labels.clean(found.name, labels.LONGEST_TITLE)}"
    page = style.page(title, note, grid, list(looks.values()))
    for panels, (across, groups) in zip(page.rows, blocks, strict=False):
        for axes, figured in zip(panels, (WHOLE, SHAPE), strict=True):
            trend(axes, across, figured, groups, looks)
            axes.set_ylim(0.0, max(1.0, axes.get_ylim()[1]))
    for panels, family in zip(page.rows[len(blocks) :], families, strict=True):
        _normalised(panels, family)
    return page.figure


def _normalised(panels: Sequence[Axes], family: Family) -> None:
    """Draw loops over their peaks, and their asymmetric parts in N, both over the velocity over its peak."""
    size = 0.0
    for row, name, colour in zip(family.rows, family.names, family.colours, strict=True):
        if row.loop is None:
            continue
        look = Entry(name, colour, width=1.4)
        velocity = row.loop.velocity / np.max(np.abs(row.loop.velocity))
        style.line(panels[0], velocity, row.loop.force / row.loop.peak_force, look)
        style.line(panels[1], velocity, row.loop.asymmetric_part, look)
        size = max(size, row.asymmetry_peak)
    if size < 1.0:
        panels[1].set_ylim(-1.0, 1.0)
    panels[0].set_title(f"{family.title}: normalised loops", loc="left", fontsize=10.5)
    panels[1].set_title("their asymmetric part", loc="left", fontsize=10.5)
    panels[0].set_ylabel("force / peak force [-]")
    panels[1].set_ylabel("asymmetric part [N]")
    for axes in panels:
        axes.set_xlabel("velocity / peak velocity [-]")
    style.beside(panels[1], family.legend)
