"""Channels over time: a run as a whole and close up, or several runs over each other close up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.plots import style
from seatsim.plots.runs.naming import Shown
from seatsim.plots.style import COLOURS, DARK, WIDTH, Entry, Grid
from seatsim.plots.thinning import BINS, Window, find_loudest, thin_line
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.result import Run

CLOSE_UP = 6.0
"""Length in s of the close-up: about nine swings of a seat suspension."""
RASTER = 0.1
"""Raster in s on which a close-up begins, the digits that its title has."""
NEAR = 0.2
"""Share of an end stop's distance that the motion must reach for the stop to be drawn; else it would look flat."""


class _ChannelPanel(NamedTuple):
    """A panel: channel, label of its axis, factor from SI to the unit shown, and the channel that it should follow.

    `words` name the two in the legend: what was delivered, what was asked for.
    """

    name: str
    axis: str
    factor: float = 1.0
    target: str = ""
    words: tuple[str, str] = ("", "")


CHANNELS = (
    _ChannelPanel("driver_acceleration", "driver\nacceleration\n[m/s²]"),
    _ChannelPanel("suspension_displacement", "suspension\ndisplacement\n[mm]", 1e3),
    _ChannelPanel("damper_force", "damper force\n[N]", 1.0, "wanted_force", ("delivered", "wanted")),
    _ChannelPanel("coil_current", "coil current\n[A]", 1.0, "current_command", ("flowing", "commanded")),
)
TEMPERATURE = _ChannelPanel("damper_temperature", "damper\ntemperature\n[°C]")
LIMIT = Entry("travel limit", DARK, ":")


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
    limits, warms = _find_limits(shown.runs), any(np.ptp(run.history[TEMPERATURE.name]) > 0 for run in shown.runs)
    channels = (*CHANNELS, TEMPERATURE) if warms else CHANNELS
    legend = [] if single else [*shown.looks, *[LIMIT] * bool(limits)]
    grid = Grid((1.2,) * len(channels), len(views), left=1.06, gap=(0.3, 0.34))
    page = style.make_page(f"Time histories: {shown.title}", note + shown.omission, grid, legend)
    for row, channel in zip(page.rows, channels, strict=True):
        for axes, view in zip(row, views, strict=True):
            _draw_view(axes, shown, channel, view)
            for limit in limits if channel.name == "suspension_displacement" else ():
                label = LIMIT.label if single and limit == limits[-1] else ""
                axes.axhline(1e3 * limit, label=label, color=LIMIT.colour, linestyle=":", linewidth=LIMIT.width)
        row[0].set_ylabel(channel.axis)
        row[0].yaxis.set_label_coords(-0.5 / (row[0].get_position().width * WIDTH), 0.5)
        _join_views(row, window, single)
    for axes in [axes for row in page.rows[:-1] for axes in row]:
        axes.tick_params(labelbottom=False)
    for axes in page.rows[-1]:
        axes.set_xlabel("time [s]")
    return style.name_coincident(page.figure)


def _draw_view(axes: Axes, shown: Shown, channel: _ChannelPanel, view: Window) -> None:
    """Draw a channel of some runs within a window; of a single one over the channel that it should follow."""
    if len(shown.runs) > 1:
        lines = [(run, channel.name, look) for run, look in zip(shown.runs, shown.looks, strict=True)]
    else:
        [run] = shown.runs
        follows = channel.target and not np.all(np.isnan(run.history[channel.target]))
        name, wanted = channel.words if follows else ("", "")
        lines = [(run, channel.target, Entry(wanted, COLOURS[5], width=2.0, alpha=0.6))] if follows else []
        lines.append((run, channel.name, Entry(name, COLOURS[0], width=1.1)))
    for run, name, look in lines:
        part = view.part(run.history.step)
        time, values = run.history["time"][part], channel.factor * run.history[name][part]
        style.draw_line(axes, *thin_line(time, values, round(BINS * axes.get_position().width)), look)
    axes.set_xlim(*view)


def _join_views(row: Sequence[Axes], window: Window, single: bool) -> None:
    """Give the close-up the scale of the whole run, mark it there; put the legend of a single run above the row."""
    for close in row[1:]:
        row[0].axvspan(*window, color=style.AREA, zorder=0)
        close.set_ylim(row[0].get_ylim())
        close.tick_params(labelleft=False)
    # matplotlib gives lines of its own a label that begins with an underscore.
    named = [line for line in row[-1].lines if str(line.get_label()).strip("_") and str(line.get_label())[0] != "_"]
    if single and named:
        row[-1].legend(
            handles=named, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False, borderpad=0,
            borderaxespad=0.2, fontsize=style.FONT, handlelength=1.5,
        )  # fmt: skip


def _find_limits(runs: Sequence[Run]) -> list[float]:
    """Return the displacements in m of the end stops that the runs come near to."""
    peak = max(float(np.max(np.abs(run.history["suspension_displacement"]))) for run in runs)
    seats = (augment_plant(run.scenario.effects, run.scenario.plant) for run in runs if run.scenario.plant)
    stated = {limit for seat in seats for limit in seat.end_stops or ()}
    return sorted(limit for limit in stated if abs(limit) * NEAR <= peak)
