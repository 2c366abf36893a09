"""Measured vibration of a person: its course and its spectrum; a seat's damping."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.figure import Figure

from seatsim.metrics.comfort import running_rms
from seatsim.metrics.spectra import estimate_density
from seatsim.plots import style
from seatsim.plots.densities import draw_densities, find_first, state_method
from seatsim.plots.style import GREY, Entry, Grid
from seatsim.plots.thinning import spread_evenly, thin_line
from seatsim.schema.text import join_names
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
    """Return the running RMS and the spectra of the axes along which something was measured."""
    axes = [axis for axis, each in found.axes.items() if each.direction.unit == "m/s^2"]
    return {"running_rms": _plot_running_rms(found, axes), "spectra": _plot_spectra(found, axes)} if axes else {}


def _plot_running_rms(found: Comfort, axes: Sequence[str]) -> Figure:
    """Return the running RMS of each axis, a panel for each stretch."""
    highest = [found.axes[axis].dose.mtvv for axis in axes]
    looks = style.make_entries([f"{axis}, MTVV {value:.3g} m/s²" for axis, value in zip(axes, highest, strict=True)])
    count = len(found.stretches[axes[0]])
    chosen = spread_evenly(range(count), MOST)
    note = f"{_RUNNING}{f' {MOST} of {count} stretches are shown.' * (count > MOST)}"
    page = style.make_page("Vibration over time", note, Grid((1.5,) * len(chosen), top=0.3), looks)
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
    note = f"{state_method(first)}{f' {MOST} of {len(axes)} axes are shown.' * (len(axes) > MOST)}"
    page = style.make_page("Vibration over frequency", note, grid, looks)
    for panel, axis, drawn in zip(page.list_panels(), chosen, densities, strict=True):
        style.scale_frequency_axis(panel, first, HIGHEST)
        panel.set_ylabel("power density\n[(m/s²)²/Hz]")
        style.set_title(panel, f"{axis} axis, weighted by {found.axes[axis].direction.weighting}")
        draw_densities(panel, drawn, looks, HIGHEST)
    return style.name_coincident(page.figure)


def plot_damping(found: SeatTest) -> dict[str, Figure]:
    """Return the transmissibility of the mass on the seat over the floor, with its limits, where it was tested."""
    if not found.damping:
        return {}
    looks = [each._replace(mark=".", width=1.6) for each in style.make_entries(list(found.damping))]
    classes = dict[float, list[str]]()
    for row in found.damping_rows:
        classes.setdefault(row.limit, []).append(row.spectral_class)
    named = [f"limit of {join_names(dict.fromkeys(names))}" for names in classes.values()]
    limits = [Entry(name, style.DARK, dashes) for name, dashes in zip(named, cycle(style.DASHES), strict=False)]
    failed = dict.fromkeys(f"“{row.run}”" for row in found.damping_rows if not row.passed)
    verdict = f"of {join_names(failed)} exceeds a limit" if failed else "of each line keeps to its limits"
    note = f"Sines from half to twice the resonance that is expected of the seat. The largest value {verdict}."
    title = "Damping test: motion of the mass over that of the floor"
    figure, [[axes]] = style.make_page(title, note, Grid((2.6,)), [*looks, *limits])
    for look, test in zip(looks, found.damping.values(), strict=True):
        style.draw_line(axes, test.frequencies, test.transmissibilities, look)
    for limit, look in zip(classes, limits, strict=True):
        axes.axhline(limit, color=look.colour, linestyle=look.dashes, linewidth=look.width)
    axes.set(xlabel="frequency [Hz]", ylabel="transmissibility [-]", ylim=(0.0, 1.05 * axes.get_ylim()[1]))
    return {"damping": style.name_coincident(figure)}
