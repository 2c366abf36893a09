"""Channels over time: a run as a whole and close up, or several runs over each other close up."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.plots import style
from seatsim.plots.runs.looks import Shown
from seatsim.plots.style import COLOURS, DARK, WIDTH, Entry, Grid
from seatsim.plots.thinning import BINS, Window, find_loudest, thin_line
from seatsim.schema.printing import describe_channel
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.result import UNITS, Run

CLOSE_UP = 6.0
"""Length in s of the close-up: about nine swings of a seat suspension."""
RASTER = 0.1
"""Raster in s on which a close-up begins, the digits that its title has."""
LETTERS = 13
"""Letters of a line of a label beside a panel that is this low."""
NEAR = 0.2
"""Share of an end stop's distance that the motion must reach for the stop to be drawn; else it would look flat."""


CHANNELS = ("driver_acceleration", "suspension_displacement", "damper_force", "coil_current")
TEMPERATURE = "damper_temperature"
TARGETS = {"damper_force": "wanted_force", "coil_current": "current_command"}
"""Channels that others should follow."""
RUN = Entry("the run", COLOURS[0], width=1.1)
TARGET = Entry("wanted force, commanded current", COLOURS[5], "-", 2.0, 0.6)
LIMIT = Entry("end stop begins", DARK, ":")


def plot_time_histories(shown: Shown) -> Figure:
    """Return driver acceleration, suspension displacement, damper force, current, and a changing temperature.

    Close up is the window with the largest RMS of the first run's driver acceleration, within all runs. What
    was wanted and commanded is drawn for a single run only, which is shown as a whole, too.
    """
    first, single = shown.runs[0].history, len(shown.runs) == 1
    common = min(run.history["time"][-1] for run in shown.runs)
    window = find_loudest(first["driver_acceleration"][first["time"] <= common], first.step, CLOSE_UP, RASTER)
    whole = Window(0.0, float(common))
    note = f"{window}, where the driver's RMS acceleration is largest{' in the first run' * (not single)}."
    views = [window]
    if not np.any(first["driver_acceleration"]):
        views, note = [whole], "The whole run, at rest."
    elif window.end >= common:
        note = "The whole run."
    elif single:
        views, note = [whole, window], f"Left: whole run. Right (grey on the left): {note}"
    limits, warms = _find_limits(shown.runs), any(np.ptp(run.history[TEMPERATURE]) > 0 for run in shown.runs)
    channels = (*CHANNELS, TEMPERATURE) if warms else CHANNELS
    legend = [*([RUN, _name_target(shown.runs[0])] if single else shown.looks), *[LIMIT] * bool(limits)]
    grid = Grid((1.2,) * len(channels), len(views), left=1.12, gap=(0.4, 0.3))
    page = style.make_page(f"Time histories: {shown.title}", note + shown.omission, grid, legend)
    for row, channel in zip(page.rows, channels, strict=True):
        for axes, view in zip(row, views, strict=True):
            _draw_view(axes, shown, channel, view)
            for limit in limits if channel == "suspension_displacement" else ():
                axes.axhline(1e3 * limit, color=LIMIT.colour, linestyle=":", linewidth=LIMIT.width)
            axes.tick_params(labelbottom=row is page.rows[-1])
        row[0].set_ylabel(fill(describe_channel(channel, UNITS[channel]).axis, LETTERS))
        row[0].yaxis.set_label_coords(-0.5 / (row[0].get_position().width * WIDTH), 0.5)
        # The close-up has the scale of the whole run, on which it is marked.
        for close in row[1:]:
            row[0].axvspan(*window, color=style.AREA, zorder=0)
            close.set_ylim(row[0].get_ylim())
            close.tick_params(labelleft=False)
    for axes in page.rows[-1]:
        axes.set_xlabel("time [s]")
    return style.name_coincident(page.figure)


def _draw_view(axes: Axes, shown: Shown, channel: str, view: Window) -> None:
    """Draw a channel of some runs within a window; of a single one over the channel that it should follow."""
    lines = [(run, channel, look) for run, look in zip(shown.runs, shown.looks, strict=True)]
    if len(lines) == 1:
        [run] = shown.runs
        lines = [(run, channel, RUN)]
        if channel in TARGETS and np.isfinite(run.history[TARGETS[channel]]).any():
            lines.insert(0, (run, TARGETS[channel], _name_target(run)))
    for run, name, look in lines:
        part = view.part(run.history.step)
        values = describe_channel(name, UNITS[name]).factor * run.history[name][part]
        # The whole of a run has swings beside each other, with gaps between them where bins are wider than dots.
        bins = BINS * (2 if view.end - view.start > CLOSE_UP else 1)
        thinned = thin_line(run.history["time"][part], values, round(bins * axes.get_position().width))
        style.draw_line(axes, *thinned, look)
    axes.set_xlim(*view)


def _name_target(run: Run) -> Entry:
    """Return the entry of what should be followed: a law that states a current wants no force."""
    return TARGET if np.isfinite(run.history["wanted_force"]).any() else TARGET._replace(label="commanded current")


def _find_limits(runs: Sequence[Run]) -> list[float]:
    """Return the displacements in m of the end stops that the runs come near to."""
    peak = max(float(np.max(np.abs(run.history["suspension_displacement"]))) for run in runs)
    seats = (augment_plant(run.scenario.effects, run.scenario.plant) for run in runs if run.scenario.plant)
    stated = {limit for seat in seats for limit in seat.end_stops or ()}
    return sorted(limit for limit in stated if abs(limit) * NEAR <= peak)
