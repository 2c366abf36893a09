"""Loops of a damper's force: over its velocity and, beside, over its displacement, in the order of a quantity."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from matplotlib.figure import Figure

from seatsim.dampers.base import DAMPERS
from seatsim.plots import style
from seatsim.plots.style import Entry, Grid, clean_text
from seatsim.scenario.describe import name_model
from seatsim.simulation.damper_bench import SineTest, sine_test

SIGNS = "Positive: extension, and the force that opposes it."
"""What the axes of force, velocity and displacement count from rest."""
_AMPLITUDE, _FASTEST = 0.01, 2.0
"""m and Hz of a model's sine; the frequency is lower where the model does not hold up to the speed."""
_SHARES = (0.0, 0.5, 1.0)
"""Currents of a model's sines, as shares of the greatest for which it holds."""
_SETTLING = 3.0
"""Seconds that a model's sine runs at least before the cycle shown; models forget their start in that time."""


class Family(NamedTuple):
    """Loops that share their panels: title, that of the legend, named loops, and the colour map of their order."""

    title: str
    legend: str
    loops: Sequence[tuple[str, SineTest]]
    colours: str = "viridis"


def plot_families(title: str, note: str, families: Sequence[Family]) -> Figure:
    """Return a picture with a row of two panels for each family, on one scale of the force."""
    letters = [len(name) for family in families for name in (family.legend, *(name for name, _ in family.loops))]
    right = max(0.95, 0.55 + style.LETTER * max(letters, default=0))
    grid = Grid((2.0,) * len(families), 2, right=right, top=0.3, gap=(0.3, 0.85))
    page = style.make_page(title, f"{note} {SIGNS}".strip(), grid)
    for panels, family in zip(page.rows, families, strict=True):
        picked = style.sample_colours(family.colours, len(family.loops))
        for (name, loop), colour in zip(family.loops, picked, strict=True):
            for axes, across in zip(panels, (loop.velocity, 1e3 * loop.displacement), strict=True):
                style.draw_line(axes, across, loop.force, Entry(name, colour, width=1.5))
        panels[0].set_title(clean_text(family.title, 60), loc="left", fontsize=style.FONT)
        panels[0].set(xlabel="velocity [m/s]", ylabel="damper force [N]")
        panels[1].set(xlabel="displacement [mm]", ylim=panels[0].get_ylim())
        panels[1].tick_params(labelleft=False)
        if len(family.loops) > 1:
            panels[1].legend(
                title=family.legend, alignment="left", loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False,
                borderaxespad=0, fontsize=style.FONT, title_fontsize=style.FONT, handlelength=1.2, handletextpad=0.5,
                markerscale=3,
            )  # fmt: skip
    return style.name_coincident(page.figure)


def plot_model(name: str) -> Figure:
    """Return the loops of a damper model with the values of its record, at a few currents."""
    cls = DAMPERS.find(name)
    known = DAMPERS.specification_of(cls)
    frequency = min(_FASTEST, math.floor(100.0 * known.max_speed / (2.0 * math.pi * _AMPLITUDE)) / 100.0)
    currents = [share * known.max_current for share in _SHARES] if known.max_current else [0.0]
    cycles = max(3, math.ceil(_SETTLING * frequency) + 1)
    loops = [(f"{i:g} A", sine_test(cls(), _AMPLITUDE, frequency, i, 20.0, known.factors, cycles)) for i in currents]
    title = f"sine of {1e3 * _AMPLITUDE:g} mm at {frequency:g} Hz, 20 °C"
    return plot_families(name_model(name), "", [Family(title, "current", loops)])
