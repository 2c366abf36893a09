"""Channels over time: a run as a whole and close up, or several runs over each other close up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.plots import labels, style
from seatsim.plots.style import COLOURS, DARK, Entry, Grid
from seatsim.plots.thinning import Array, Window, eventful, thinned
from seatsim.result import Run

NEAR = 0.2
"""Part of the way to a travel limit from which on the limit is drawn; before, it would only flatten the motion."""
WIDEST = 1.0
"""Travel limits in m from which on they are none."""


class Channel(NamedTuple):
    """A panel: channel, label of its axis, factor to the unit shown, and the channel that it should follow."""

    name: str
    axis: str
    factor: float = 1.0
    target: str = ""
    words: tuple[str, str] = ("", "")


CHANNELS = (
    Channel("driver_acceleration", "driver\nacceleration\n[m/s²]"),
    Channel("suspension_displacement", "suspension\ndisplacement\n[mm]", 1e3),
    Channel("damper_force", "damper force\n[N]", 1.0, "wanted_force", ("delivered", "wanted")),
    Channel("coil_current", "coil current\n[A]", 1.0, "current_command", ("flowing", "commanded")),
)
TEMPERATURE = Channel("damper_temperature", "damper\ntemperature\n[°C]")
GRID = Grid(heights=(), left=1.05, gap=(0.35, 0.32))


def time_histories(runs: Sequence[Run]) -> Figure:
    """Return driver acceleration, suspension displacement, damper force, coil current and a changing temperature.

    Close up is the window with the largest RMS of the first run's driver acceleration, within all runs.
    """
    common = min(run.history["time"][-1] for run in runs)
    first = runs[0].history
    inside = first["time"] <= common
    window = eventful(first["driver_acceleration"][inside], first.step)
    return _one(runs[0], window) if len(runs) == 1 else _several(runs, window)


def _one(run: Run, window: Window) -> Figure:
    channels = (*CHANNELS, TEMPERATURE) if _warms(run) else CHANNELS
    note = f"Left: whole run. Right: {window}, where the driver's RMS acceleration is largest."
    grid = GRID._replace(heights=(1.45,) * len(channels), columns=2)
    page = style.page(f"Time histories: {labels.title([run])}", note, grid)
    for (whole, close), channel in zip(page.rows, channels, strict=True):
        for axes, part in ((whole, slice(None)), (close, window.part(run.history.step))):
            _panel_of_one(axes, run, channel, part)
        whole.axvspan(*window, color="0.93", zorder=0)
        whole.set_ylabel(channel.axis)
        close.set_ylim(whole.get_ylim())
        close.tick_params(labelleft=False)
        close.set_xlim(*window)
        whole.set_xlim(0, run.history["time"][-1])
    for column in (0, 1):
        _time_axis([row[column] for row in page.rows])
    return page.figure


def _panel_of_one(axes: Axes, run: Run, channel: Channel, part: slice) -> None:
    delivered, wanted = channel.words
    if channel.target and not np.all(np.isnan(run.history[channel.target])):
        _trace(axes, run, channel, channel.target, part, Entry(wanted, COLOURS[5], width=1.0, alpha=0.75))
    _trace(axes, run, channel, channel.name, part, Entry(delivered, COLOURS[0], width=1.1))
    limited = channel.name == "suspension_displacement" and _travel(axes, [run])
    if part.start is not None and (limited or len(axes.lines) > 1):
        axes.legend(
            ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False, borderpad=0, borderaxespad=0.2
        )


def _several(runs: Sequence[Run], window: Window) -> Figure:
    chosen = labels.shown(runs)
    warming = any(_warms(run) for run in chosen)
    note = (
        f"{window}, where the RMS acceleration of the driver is largest in the first run."
        f"{' The temperature is that of the whole run.' if warming else ''}{labels.which(chosen, runs)}"
    )
    looks = style.entries(labels.labels(chosen))
    grid = GRID._replace(heights=(1.75,) * (len(CHANNELS) + warming))
    page = style.page(f"Time histories: {labels.title(runs)}", note, grid, looks)
    panels = [row[0] for row in page.rows]
    for axes, channel in zip(panels, CHANNELS, strict=False):
        for run, look in zip(chosen, looks, strict=True):
            _trace(axes, run, channel, channel.name, window.part(run.history.step), look)
        axes.set_ylabel(channel.axis)
        axes.set_xlim(*window)
    _travel(panels[1], chosen)
    _time_axis(panels[: len(CHANNELS)])
    if warming:
        _temperatures(panels[-1], chosen, looks)
    return page.figure


def _temperatures(axes: Axes, runs: Sequence[Run], looks: Sequence[Entry]) -> None:
    for run, look in zip(runs, looks, strict=True):
        _trace(axes, run, TEMPERATURE, TEMPERATURE.name, slice(None), look)
    axes.set_ylabel(TEMPERATURE.axis)
    axes.set_xlim(left=0)
    _time_axis([axes])


def _trace(axes: Axes, run: Run, channel: Channel, name: str, part: slice, look: Entry) -> None:
    time, values = run.history["time"][part], run.history[name][part]
    style.line(axes, *thinned(time, channel.factor * values), look)


def _travel(axes: Axes, runs: Sequence[Run]) -> bool:
    """Draw the travel limits that the motion comes near to, note the others; tell whether any was drawn."""
    peak = max(float(np.max(np.abs(run.history["suspension_displacement"]))) for run in runs)
    limits = sorted({limit for run in runs if run.scenario.plant for limit in run.scenario.plant.travel})
    near = [limit for limit in limits if abs(limit) < WIDEST and abs(limit) * NEAR <= peak]
    for index, limit in enumerate(near):
        axes.axhline(1e3 * limit, color=DARK, linestyle=":", linewidth=1.3, label="" if index else "travel limit")
    return bool(near)


def _time_axis(panels: Sequence[Axes]) -> None:
    for axes in panels[:-1]:
        axes.tick_params(labelbottom=False)
    panels[-1].set_xlabel("time [s]")


def _warms(run: Run) -> bool:
    values: Array = run.history[TEMPERATURE.name]
    return bool(np.ptp(values) > 0)
