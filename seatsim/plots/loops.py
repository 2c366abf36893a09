"""Loops of a damper's force: over its velocity and, beside, over its displacement, in the order of a quantity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection

from seatsim.plots import style
from seatsim.plots.style import Entry, Grid, Page, clean_text
from seatsim.schema.arrays import Array
from seatsim.simulation.damper_bench import SineTest

SIGNS = "Positive: extension, and the force that opposes it."
"""What the axes of force, velocity and displacement count from rest."""


class Family(NamedTuple):
    """Loops that share their panels: title, that of the legend, named loops, and the colour map of their order."""

    title: str
    legend: str
    loops: Sequence[tuple[str, SineTest]]
    colours: str = "viridis"


def make_loop_page(title: str, note: str, families: Sequence[Family], more: int = 0) -> Page:
    """Return a page with a row of two panels for each family, filled, and further rows that are empty."""
    letters = [len(name) for family in families for name in (family.legend, *(name for name, _ in family.loops))]
    right = max(0.95, 0.55 + style.LETTER * max(letters, default=0))
    grid = Grid((2.0,) * (len(families) + more), 2, right=right, top=0.3, gap=(0.3, 0.85))
    page = style.make_page(title, f"{note} {SIGNS}", grid)
    for panels, family in zip(page.rows, families, strict=False):
        picked = style.sample_colours(family.colours, len(family.loops))
        for (name, loop), colour in zip(family.loops, picked, strict=True):
            look = Entry(name, colour, width=1.5)
            style.draw_line(panels[0], loop.velocity, loop.force, look)
            style.draw_line(panels[1], 1e3 * loop.displacement, loop.force, look)
        label_panels(panels, family.title)
        if len(family.loops) > 1:
            panels[1].legend(
                title=family.legend, alignment="left", loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False,
                borderaxespad=0, fontsize=style.FONT, title_fontsize=style.FONT, handlelength=1.2, handletextpad=0.5,
            )  # fmt: skip
    return page


def draw_samples(axes: Axes, across: Array, force: Array, current: Array, most: float) -> PathCollection:
    """Draw samples of a force coloured by the current, from 0 to the most in A, large ones on top; return them."""
    colours, end, order = style.shade("viridis"), most or 1.0, np.argsort(current, kind="stable")
    return axes.scatter(
        across[order], force[order], 6, current[order], cmap=colours, vmin=0.0, vmax=end, linewidths=0, rasterized=True
    )


def label_panels(panels: Sequence[Axes], title: str) -> None:
    """Label two panels of one damper force, over velocity and over displacement, on one scale."""
    panels[0].set_title(clean_text(title, 60), loc="left", fontsize=style.FONT)
    panels[0].set(xlabel="velocity [m/s]", ylabel="damper force [N]")
    panels[1].set(xlabel="displacement [mm]", ylim=panels[0].get_ylim())
    panels[1].tick_params(labelleft=False)
