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
GRID = Grid(heights=(), left=1.06, gap=(0.3, 0.34))
HEIGHT = 1.2
OWN_AXIS = 0.4
"""Height of a panel, and room above one with an axis of time of its own, for the axis of the one above, in inches."""


def plot_time_histories(shown: Shown) -> Figure:
    """Return driver acceleration, suspension displacement, damper force, current, and a changing temperature.

    Close up is the window with the largest RMS of the first run's driver acceleration, within all runs. What
    was wanted and commanded is drawn for a single run only.
    """
    common = min(run.history["time"][-1] for run in shown.runs)
    first = shown.runs[0].history
    inside = first["time"] <= common
    window = find_loudest(first["driver_acceleration"][inside], first.step, CLOSE_UP, RASTER)
    return _plot_one(shown, window) if len(shown.runs) == 1 else _plot_several(shown, window)


def _plot_one(shown: Shown, window: Window) -> Figure:
    [run] = shown.runs
    channels = (*CHANNELS, TEMPERATURE) if _warms_up(run) else CHANNELS
    whole = Window(0.0, float(run.history["time"][-1]))
    views, note = [whole], ""
    if window.end - window.start < whole.end:
        views.append(window)
        note = f"Left: whole run. Right: {window}, where the driver's RMS acceleration is largest."
    page = _make_page(shown, note, len(channels), len(views))
    for row, channel in zip(page.rows, channels, strict=True):
        for axes, view in zip(row, views, strict=True):
            _draw_view(axes, run, channel, view)
        _label_panel(row[0], channel)
        _join_views(row, window)
    for column in range(len(views)):
        _label_time_axis([row[column] for row in page.rows])
    return page.figure


def _make_page(shown: Shown, note: str, rows: int, columns: int = 1, legend: Sequence[Entry] = ()) -> style.Page:
    grid = GRID._replace(heights=(HEIGHT,) * rows, columns=columns)
    return style.make_page(f"Time histories: {shown.title}", note, grid, legend)


def _draw_view(axes: Axes, run: Run, channel: _ChannelPanel, view: Window) -> None:
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
    for close in row[1:]:
        row[0].axvspan(*window, color="0.93", zorder=0)
        close.set_ylim(row[0].get_ylim())
        close.tick_params(labelleft=False)
    # matplotlib gives a line without a label one that begins with an underscore.
    named = [line for line in row[-1].lines if not str(line.get_label()).startswith("_")]
    if named:
        row[-1].legend(
            handles=named, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False, borderpad=0,
            borderaxespad=0.2, fontsize=style.FONT, handlelength=1.5,
        )  # fmt: skip


def _plot_several(shown: Shown, window: Window) -> Figure:
    warming, limits = any(_warms_up(run) for run in shown.runs), _find_limits(shown.runs)
    note = (
        f"{window}, where the RMS acceleration of the driver is largest in the first run."
        f"{' Temperature: whole run.' if warming else ''}{shown.omission}"
    )
    page = _make_page(shown, note, len(CHANNELS) + warming, 1, [*shown.looks, *([LIMIT] if limits else [])])
    panels = [row[0] for row in page.rows]
    for axes, channel in zip(panels, (*CHANNELS, TEMPERATURE), strict=False):
        for run, look in zip(shown.runs, shown.looks, strict=True):
            part = slice(None) if channel is TEMPERATURE else window.part(run.history.step)
            _draw_channel(axes, run, channel, channel.name, part, look)
        _label_panel(axes, channel)
        if channel is not TEMPERATURE:
            axes.set_xlim(*window)
    _draw_limits(panels[1], limits)
    _label_time_axis(panels[: len(CHANNELS)])
    for axes in panels[len(CHANNELS) :]:
        # A temperature changes over minutes: it has an axis of its own.
        left, bottom, width, height = axes.get_position().bounds
        axes.set_position((left, bottom, width, height * (1 - OWN_AXIS / HEIGHT)))
        axes.set_xlim(left=0)
        _label_time_axis([axes])
    return page.figure


def _draw_channel(axes: Axes, run: Run, channel: _ChannelPanel, name: str, part: slice, look: Entry) -> None:
    time, values = run.history["time"][part], run.history[name][part]
    style.draw_line(axes, *thin_line(time, channel.factor * values, round(BINS * axes.get_position().width)), look)


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


def _label_panel(axes: Axes, channel: _ChannelPanel) -> None:
    axes.set_ylabel(channel.axis)
    axes.yaxis.set_label_coords(-0.5 / (axes.get_position().width * WIDTH), 0.5)


def _label_time_axis(panels: Sequence[Axes]) -> None:
    for axes in panels[:-1]:
        axes.tick_params(labelbottom=False)
    panels[-1].set_xlabel("time [s]")


def _warms_up(run: Run) -> bool:
    return bool(np.ptp(run.history[TEMPERATURE.name]) > 0)
