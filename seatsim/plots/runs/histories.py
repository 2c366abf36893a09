"""Channels over time: a run as a whole and close up, or several runs over each other close up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.plots import style
from seatsim.plots.runs import naming
from seatsim.plots.style import COLOURS, DARK, WIDTH, Entry, Grid
from seatsim.plots.thinning import Window, find_loudest, thin_line
from seatsim.schema.arrays import Array
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.result import Run

CLOSE_UP = 6.0
"""Length in s of the close-up: about nine swings of a seat suspension."""
STRIDE = 0.1
"""Raster in s on which a close-up begins, the digits that its title has."""
NEAR = 0.2
"""Share of an end stop's distance that the motion must reach for the stop to be drawn; else it would look flat."""


class ChannelPanel(NamedTuple):
    """A panel: channel, label of its axis, factor from SI to the unit shown, and the channel that it should follow.

    `words` name the two in the legend: what was delivered, what was asked for.
    """

    name: str
    axis: str
    factor: float = 1.0
    target: str = ""
    words: tuple[str, str] = ("", "")


CHANNELS = (
    ChannelPanel("driver_acceleration", "driver\nacceleration\n[m/s²]"),
    ChannelPanel("suspension_displacement", "suspension\ndisplacement\n[mm]", 1e3),
    ChannelPanel("damper_force", "damper force\n[N]", 1.0, "wanted_force", ("delivered", "wanted")),
    ChannelPanel("coil_current", "coil current\n[A]", 1.0, "current_command", ("flowing", "commanded")),
)
TEMPERATURE = ChannelPanel("damper_temperature", "damper\ntemperature\n[°C]")
LIMIT = Entry("travel limit", DARK, ":")
GRID = Grid(heights=(), left=1.15, gap=(0.35, 0.32))
HEIGHT = 1.75
"""Height of a panel of several runs in inches."""
OWN_AXIS = 0.35
"""Room in inches above a panel with an axis of time of its own, for the axis of the one above."""
LABEL = 0.55
"""Inches from a panel to the label of its axis, the same for all."""


def plot_time_histories(runs: Sequence[Run]) -> Figure:
    """Return driver acceleration, suspension displacement, damper force, current, and a changing temperature.

    Close up is the window with the largest RMS of the first run's driver acceleration, within all runs. What
    was wanted and commanded is drawn for a single run only.
    """
    common = min(run.history["time"][-1] for run in runs)
    first = runs[0].history
    inside = first["time"] <= common
    window = find_close_up(first["driver_acceleration"][inside], first.step)
    return _plot_one(runs[0], window) if len(runs) == 1 else _plot_several(runs, window)


def find_close_up(values: Array, step: float) -> Window:
    """Return the window of `CLOSE_UP` seconds in which the RMS is largest, or the whole of a shorter signal.

    values: shape (N,), sampled every `step` s from 0.
    """
    size = round(CLOSE_UP / step)
    if size >= len(values):
        return Window(0.0, (len(values) - 1) * step)
    start = find_loudest(values, size, max(1, round(STRIDE / step)))
    return Window(start * step, (start + size) * step)


def _plot_one(run: Run, window: Window) -> Figure:
    channels = (*CHANNELS, TEMPERATURE) if _warms_up(run) else CHANNELS
    whole = Window(0.0, float(run.history["time"][-1]))
    views, note = [whole], ""
    if window.end - window.start < whole.end:
        views.append(window)
        note = f"Left: whole run. Right: {window}, where the driver's RMS acceleration is largest."
    grid = GRID._replace(heights=(1.45,) * len(channels), columns=len(views))
    page = style.make_page(f"Time histories: {naming.make_title([run])}", note, grid)
    for row, channel in zip(page.rows, channels, strict=True):
        for axes, view in zip(row, views, strict=True):
            _draw_view(axes, run, channel, view)
        _label_panel(row[0], channel)
        _join_views(row, window)
    for column in range(len(views)):
        _label_time_axis([row[column] for row in page.rows])
    return page.figure


def _draw_view(axes: Axes, run: Run, channel: ChannelPanel, view: Window) -> None:
    """Draw a channel within a window, over the one that it should follow."""
    part = view.part(run.history.step)
    name = ""
    if channel.target and not np.all(np.isnan(run.history[channel.target])):
        name, wanted = channel.words
        _draw_channel(axes, run, channel, channel.target, part, Entry(wanted, COLOURS[5], width=2.0, alpha=0.6))
    _draw_channel(axes, run, channel, channel.name, part, Entry(name, COLOURS[0], width=1.1))
    if channel.name == "suspension_displacement":
        _draw_limits(axes, _find_limits([run]))
    axes.set_xlim(*view)


def _join_views(row: Sequence[Axes], window: Window) -> None:
    """Give the close-up the scale of the whole run, mark it there, and put one legend above the row."""
    # matplotlib gives a line without a label one that begins with an underscore.
    for close in row[1:]:
        row[0].axvspan(*window, color="0.93", zorder=0)
        close.set_ylim(row[0].get_ylim())
        close.tick_params(labelleft=False)
    named = [line for line in row[-1].lines if not str(line.get_label()).startswith("_")]
    if named:
        row[-1].legend(
            handles=named, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False, borderpad=0,
            borderaxespad=0.2,
        )  # fmt: skip


def _plot_several(runs: Sequence[Run], window: Window) -> Figure:
    chosen = naming.select_shown(runs)
    warming, limits = any(_warms_up(run) for run in chosen), _find_limits(chosen)
    note = (
        f"{window}, where the RMS acceleration of the driver is largest in the first run."
        f"{' Temperature: whole run.' if warming else ''}{naming.describe_omission(chosen, runs)}"
    )
    looks = style.make_entries(naming.label_runs(chosen))
    heights = (HEIGHT,) * len(CHANNELS) + (HEIGHT + OWN_AXIS,) * warming
    grid = GRID._replace(heights=heights)
    legend = [*looks, LIMIT] if limits else looks
    page = style.make_page(f"Time histories: {naming.make_title(runs)}", note, grid, legend)
    panels = [row[0] for row in page.rows]
    for axes, channel in zip(panels, CHANNELS, strict=False):
        for run, look in zip(chosen, looks, strict=True):
            _draw_channel(axes, run, channel, channel.name, window.part(run.history.step), look)
        _label_panel(axes, channel)
        axes.set_xlim(*window)
    _draw_limits(panels[1], limits)
    _label_time_axis(panels[: len(CHANNELS)])
    if warming:
        _draw_temperatures(panels[-1], chosen, looks)
    return page.figure


def _draw_temperatures(axes: Axes, runs: Sequence[Run], looks: Sequence[Entry]) -> None:
    """Draw the temperatures over whole runs, in the lower part of the panel's place.

    A temperature changes over minutes: a close-up of it would be a flat line.
    """
    left, bottom, width, height = axes.get_position().bounds
    axes.set_position((left, bottom, width, height * HEIGHT / (HEIGHT + OWN_AXIS)))
    for run, look in zip(runs, looks, strict=True):
        _draw_channel(axes, run, TEMPERATURE, TEMPERATURE.name, slice(None), look)
    _label_panel(axes, TEMPERATURE)
    axes.set_xlim(left=0)
    _label_time_axis([axes])


def _draw_channel(axes: Axes, run: Run, channel: ChannelPanel, name: str, part: slice, look: Entry) -> None:
    time, values = run.history["time"][part], run.history[name][part]
    style.draw_line(axes, *thin_line(time, channel.factor * values), look)


def _find_limits(runs: Sequence[Run]) -> list[float]:
    """Return the displacements in m of the end stops that the runs come near to."""
    peak = max(float(np.max(np.abs(run.history["suspension_displacement"]))) for run in runs)
    seats = (augment_plant(run.scenario.effects, run.scenario.plant) for run in runs if run.scenario.plant)
    stated = {limit for seat in seats for limit in seat.end_stops or ()}
    return sorted(limit for limit in stated if abs(limit) * NEAR <= peak)


def _draw_limits(axes: Axes, limits: Sequence[float]) -> None:
    for index, limit in enumerate(limits):
        label = "" if index else LIMIT.label
        axes.axhline(1e3 * limit, label=label, color=LIMIT.colour, linestyle=":", linewidth=LIMIT.width)


def _label_panel(axes: Axes, channel: ChannelPanel) -> None:
    axes.set_ylabel(channel.axis)
    axes.yaxis.set_label_coords(-LABEL / (axes.get_position().width * WIDTH), 0.5)


def _label_time_axis(panels: Sequence[Axes]) -> None:
    for axes in panels[:-1]:
        axes.tick_params(labelbottom=False)
    panels[-1].set_xlabel("time [s]")


def _warms_up(run: Run) -> bool:
    values: Array = run.history[TEMPERATURE.name]
    return bool(np.ptp(values) > 0)
