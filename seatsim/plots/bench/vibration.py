"""Measured vibration of a person: its course, its spectrum, what each operation adds to a day; a seat's damping."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from seatsim.metrics.comfort import running_rms
from seatsim.metrics.exposure import Exposure, Operation
from seatsim.metrics.spectra import estimate_density
from seatsim.plots import style
from seatsim.plots.densities import draw_densities, find_first, state_method
from seatsim.plots.style import GREY, Entry, Grid
from seatsim.plots.thinning import spread_evenly, thin_line
from seatsim.standards.comfort import Comfort
from seatsim.standards.seat_rows import SeatTest

MOST = 4
"""Stretches, and axes, that have a panel of their own; more are chosen evenly."""
_RUNNING = (
    "RMS of the weighted acceleration over the last second, without multiplying factor. The first second, in which the"
    " window fills, is left out. The largest value of all stretches is MTVV."
)
HIGHEST = 100.0
"""Hz up to which a spectrum is drawn: above it no weighting of the body lets much through."""


def plot_vibration(found: Comfort) -> dict[str, Figure]:
    """Return the running RMS, the spectra, and the operations of a day where there are some."""
    axes = [axis for axis, each in found.axes.items() if each.direction.unit == "m/s^2"]
    figures = {"running_rms": _plot_running_rms(found, axes), "spectra": _plot_spectra(found, axes)} if axes else {}
    if found.exposure and found.operations:
        figures["operations"] = _plot_operations(found.exposure, found.operations)
    return figures


def _plot_running_rms(found: Comfort, axes: Sequence[str]) -> Figure:
    """Return the running RMS of each axis, a panel for each stretch."""
    highest = [found.axes[axis].dose.mtvv for axis in axes]
    looks = style.make_entries([f"{axis}, MTVV {value:.3g} m/s²" for axis, value in zip(axes, highest, strict=True)])
    chosen = spread_evenly(range(len(found.stretches[axes[0]])), MOST)
    page = style.make_page("Vibration over time", _RUNNING, Grid((1.5,) * len(chosen), top=0.3), looks)
    for panel, k in zip(page.list_panels(), chosen, strict=True):
        for axis, look in zip(axes, looks, strict=True):
            part = found.stretches[axis][k]
            values, filled = running_rms(part.weighted, part.sample_rate), round(part.sample_rate)
            time = np.arange(len(values)) / part.sample_rate
            style.draw_line(panel, *thin_line(time[filled:], values[filled:]), look)
        style.set_title(panel, found.stretches[axes[0]][k].run)
        panel.set(ylim=(0.0, 1.05 * max(highest) or 1.0), xlabel="time [s]", ylabel="a$_w$ over 1 s [m/s²]")
    return style.name_coincident(page.figure)


def _plot_spectra(found: Comfort, axes: Sequence[str]) -> Figure:
    """Return the power spectral densities, as recorded and weighted, a panel for each axis."""
    looks = [Entry("as recorded", GREY, width=2.0), Entry("weighted", style.COLOURS[0])]
    chosen, densities = spread_evenly(axes, MOST), []
    for stretches in (found.stretches[axis] for axis in chosen):
        signals = [part.acceleration for part in stretches], [part.weighted for part in stretches]
        densities.append([estimate_density(1.0 / stretches[0].sample_rate, each) for each in signals])
    first, grid = find_first(densities[0]), Grid((1.7,) * len(chosen), top=0.3)
    page = style.make_page("Vibration over frequency", state_method(first), grid, looks)
    for panel, axis, drawn in zip(page.list_panels(), chosen, densities, strict=True):
        style.scale_frequency_axis(panel, first, HIGHEST)
        panel.set_ylabel("density [(m/s²)²/Hz]")
        style.set_title(panel, f"{axis}, {found.axes[axis].direction.weighting}")
        draw_densities(panel, drawn, looks, HIGHEST)
    return style.name_coincident(page.figure)


def _plot_operations(day: Exposure, operations: Sequence[Operation]) -> Figure:
    """Return the partial exposure of each operation, and that of the day, along the axis that decides."""
    axis = day.a8_axis
    parts = [*((each.name, each.hours, each.a8[axis]) for each in operations), ("the whole day", day.hours, day.a8)]
    # A text at the end of a bar would stand in the way of the two values.
    names = [f"{name}, {lasts:g} h: {value:.2f}" for name, lasts, value in parts]
    levels = {"action value": day.action_value.a8, "limit value": day.limit_value.a8}
    styled = zip(levels.items(), style.DASHES, strict=False)
    looks = [Entry(f"{name}, {level:g} m/s²", style.DARK, dashes) for (name, level), dashes in styled]
    note = f"A(8) along {axis}, where the day's is largest; the squares of the parts add up to that of the day."
    figure, [panel] = style.make_rows("What each operation adds to the day", note, names, looks, [len(names) - 1])
    colours = [style.COLOURS[0]] * len(operations) + [style.COLOURS[1]]
    style.draw_bars(panel, [value for _, _, value in parts], colours, [""] * len(parts))
    for level, look in zip(levels.values(), looks, strict=True):
        panel.axvline(level, color=look.colour, linestyle=look.dashes, linewidth=1.2, zorder=3)
    panel.set_xlabel("A(8) [m/s²]")
    return figure


def plot_damping(found: SeatTest) -> dict[str, Figure]:
    """Return the transmissibility of the mass on the seat over the floor, where it was tested."""
    if not found.damping:
        return {}
    looks = [each._replace(mark=".", width=1.6) for each in style.make_entries(list(found.damping))]
    note = "Sines from half to twice the resonance that is expected of the seat."
    title = "Damping test: motion of the mass over that of the floor"
    figure, [[axes]] = style.make_page(title, note, Grid((2.6,)), looks)
    for look, test in zip(looks, found.damping.values(), strict=True):
        style.draw_line(axes, test.frequencies, test.transmissibilities, look)
    axes.set_ylim(bottom=0.0)
    axes.set(xlabel="frequency [Hz]", ylabel="transmissibility [-]")
    return {"damping": style.name_coincident(figure)}
