"""Each compared channel: measured and simulated, what is left of it beside the sensor's noise, over time and frequency.

The same picture shows a gap, with one simulation, and a diagnosis, with two.
"""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.diagnosis.residuals import group_by_channel, list_traces, nominal_gap
from seatsim.diagnosis.result import Diagnosis, Trace
from seatsim.metrics.motion import rms
from seatsim.metrics.spectra import estimate_density
from seatsim.plots import style
from seatsim.plots.densities import draw_densities, find_first, state_method
from seatsim.plots.diagnosis.answer import find_last
from seatsim.plots.style import COLOURS, DASHES, MEASURED, Entry, Grid
from seatsim.plots.thinning import BINS, Window, find_loudest, thin_line
from seatsim.recordings.gap import Gap
from seatsim.schema.arrays import Array
from seatsim.schema.printing import Quantity, describe_channel, format_number

SECONDS, RASTER = 2.0, 0.05
"""Length in s of the window that is shown, and the raster on which it begins."""
BAND = 2.0
"""Standard deviations of the noise that are shaded."""
DECADES = 9.0
"""Decades below the highest density that a spectrum shows: down to the noise of a good sensor."""
NOMINAL = Entry("nominal", COLOURS[1], DASHES[1], width=1.3)
NOISE = Entry("sensor noise", "black", ":", width=1.3)
_BAND = Entry(f"±{BAND:g} RMS of the noise", style.AREA, width=8)
GRID = Grid((1.5, 1.0, 1.3), left=1.04, gap=(0.0, 0.5))
Looks: TypeAlias = dict[str, Entry]
"""Looks of simulations that are compared with a measurement, by their names in a trace."""
LETTERS = 19
"""Letters of a label beside a panel that is this low."""


def plot_signals(diagnosis: Diagnosis) -> dict[str, Figure]:
    """Return a picture of each held-out channel, the channel with the largest nominal gap first."""
    last = find_last(diagnosis)
    after = Entry(last.label, last.colour, width=1.1)
    return _plot_channels(diagnosis.evidence.traces, {"nominal": NOMINAL, "after": after})


def plot_gap_signals(found: Gap) -> dict[str, Figure]:
    """Return a picture of each channel of a gap, the channel with the largest gap first."""
    return _plot_channels(list_traces(found), {"nominal": NOMINAL._replace(label="simulated")})


def _plot_channels(traces: Sequence[Trace], looks: Looks) -> dict[str, Figure]:
    groups = group_by_channel(traces).values()
    worst = [(max(group, key=lambda each: rms(each.measured - each.nominal)), group) for group in groups]
    ordered = sorted(worst, key=lambda pair: -nominal_gap(pair[0]))
    return {f"signal_{trace.channel}": _plot_channel(trace, group, looks) for trace, group in ordered}


def _plot_channel(trace: Trace, group: Sequence[Trace], looks: Looks) -> Figure:
    """Return a picture of a channel: of its worst run over time, and of all of its runs over frequency."""
    shown, left = describe_channel(trace.channel, trace.unit), _subtract(trace, next(iter(looks)))
    step = (trace.time[-1] - trace.time[0]) / (len(trace.time) - 1)
    window = find_loudest(left, step, SECONDS, RASTER)
    window = Window(window.start + trace.time[0], window.end + trace.time[0])
    noise = shown.factor * trace.noise_rms
    left_over = [[_subtract(each, name) for each in group] for name in reversed(looks)]
    density = [estimate_density(step, signals) for signals in ([each.measured for each in group], *left_over)]
    first = find_first(density)
    has_spectrum = bool(np.isfinite(first))
    note = f"{window} of {trace.run}, where the difference has most energy; RMS over the whole run."
    spectrum = f" Lowest panel: power densities of the measured signal and of what differs. {state_method(first)}"
    note += spectrum * has_spectrum
    grid = GRID if has_spectrum else GRID._replace(heights=GRID.heights[:2])
    below = [look._replace(label=f"{look.label} (below: difference)") for look in looks.values()]
    legend = [MEASURED, *below, *[NOISE] * bool(noise and has_spectrum), *[_BAND] * bool(noise)]
    figure, [[upper], [lower], *spectra] = style.make_page(_make_title(trace, shown, looks), note, grid, legend)
    _draw_time(upper, lower, trace, window, shown, looks)
    if noise:
        lower.axhspan(-BAND * noise, BAND * noise, color=style.AREA, linewidth=0, zorder=0)
        # Its edges stand before the lines, which hide a band that they fill.
        lower.axhspan(-BAND * noise, BAND * noise, facecolor="none", edgecolor="black", linestyle=":", zorder=3)
    for [axes] in spectra:
        drawn = [(places, shown.factor**2 * power) for places, power in density]
        if noise:
            # The one-sided density of white noise of RMS s is 2 s^2 dt.
            drawn.append((density[0][0], np.full(len(density[0][0]), 2 * noise**2 * step)))
        entries = [MEASURED, *reversed(looks.values()), NOISE][: len(drawn)]
        draw_densities(axes, drawn, entries, decades=DECADES)
        style.scale_frequency_axis(axes, first, 0.5 / step)
        axes.set_ylabel(f"power density\n[{shown.square}/Hz]")
        axes.yaxis.set_label_coords(-0.125, 0.5)
    return style.name_coincident(figure)


def _draw_time(upper: Axes, lower: Axes, trace: Trace, window: Window, shown: Quantity, looks: Looks) -> None:
    inside = (trace.time >= window.start) & (trace.time <= window.end)

    def draw(axes: Axes, values: Array, look: Entry) -> None:
        style.draw_line(axes, *thin_line(trace.time[inside], shown.factor * values[inside], BINS), look)

    draw(upper, trace.measured, MEASURED)
    # The first one, which is dashed, last: where two agree, both are seen.
    for name, look in reversed(looks.items()):
        draw(upper, getattr(trace, name), look)
        draw(lower, _subtract(trace, name), look)
    lower.axhline(0.0, color="0.6", linewidth=0.8, zorder=0.5)
    upper.set_ylabel(fill(f"{shown.words} [{shown.unit}]", LETTERS))
    lower.set_ylabel(f"difference\n[{shown.unit}]")
    lower.yaxis.set_offset_position("right")
    for axes in (upper, lower):
        axes.set_xlim(*window)
        axes.set_xlabel("time [s]", labelpad=1)
        axes.yaxis.set_label_coords(-0.125, 0.5)


def _subtract(trace: Trace, name: str) -> Array:
    left: Array = trace.measured - getattr(trace, name)
    return left


def _make_title(trace: Trace, shown: Quantity, looks: Looks) -> str:
    sizes = {look.label if len(looks) > 1 else "": rms(_subtract(trace, name)) for name, look in looks.items()}
    sizes |= {"noise": trace.noise_rms} if trace.noise_rms > 0 else {}
    words = shown.words[:1].upper() + shown.words[1:]
    figures = [f"{name} {format_number(shown.factor * size)}\u00a0{shown.unit}".strip() for name, size in sizes.items()]
    return f"{words}, RMS difference: {', '.join(figures)}"
