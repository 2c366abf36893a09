"""What the pictures of a diagnosis share: how the compared signals look, and axes of frequency."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator

from seatsim.diagnosis.result import Diagnosis
from seatsim.plots.style import COLOURS, Entry

MEASURED = Entry("measured", "black", width=2.0)
NOMINAL = Entry("nominal", COLOURS[1], (0.0, (5.0, 1.5)), width=1.3)
AFTER = Entry("with effects", COLOURS[0], width=1.1)
NOISE = Entry("noise", "0.55", ":", width=1.8)
TICKS = (0.3, 1, 3, 10, 30, 100, 300, 1000, 3000)
"""Frequencies in Hz that an axis names."""


def choose_after_look(diagnosis: Diagnosis) -> Entry:
    """Return what the simulation of `augmented.yaml` is called: without effects it is the refitted nominal one."""
    if not diagnosis.selected:
        return AFTER._replace(label="refitted", colour=COLOURS[2], width=2.6)
    return AFTER._replace(label="with effect" if len(diagnosis.selected) == 1 else "with effects")


def scale_frequency_axis(axes: Axes, lowest: float, highest: float) -> None:
    """Make the lower axis of a panel logarithmic, with the `TICKS` between two frequencies in Hz."""
    axes.set_xscale("log")
    ticks = [tick for tick in TICKS if lowest <= tick <= highest]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.xaxis.set_minor_locator(NullLocator())
