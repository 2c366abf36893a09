"""Figures of a diagnosis and of a gap.

The gaps from nominal to noise floor, maps of the error over motion and current, the signal that the simulation lacks,
each compared channel over time and frequency, which shows a gap, with one simulation, and a diagnosis, with two.
"""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import TypeAlias

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from seatsim.diagnosis import residuals
from seatsim.diagnosis.result import Diagnosis, Trace
from seatsim.metrics.motion import rms
from seatsim.metrics.spectra import estimate_density
from seatsim.plots import style
from seatsim.plots.densities import draw_densities, find_first, state_method
from seatsim.plots.loops import SIGNS
from seatsim.plots.style import COLOURS, MEASURED, Entry, Grid
from seatsim.plots.thinning import Window, find_loudest, thin_line
from seatsim.recordings.gap import Gap
from seatsim.schema.arrays import Array
from seatsim.schema.printing import Quantity, describe_channel, format_number

BINS = (22, 13)
"""Bins of a map over velocity and over the other quantity."""
_DOTS = 2500
SMALLEST = 1e-4
"""Gap below which none is drawn: a logarithmic scale has no zero."""
UNITS = {"velocity": "m/s", "displacement": "m", "coil_current": "A", "damper_temperature": "degC"}
"""Units of the motion, current and temperature over which an error is drawn."""
SECONDS, RASTER = 2.0, 0.1
"""Length in s of the window that is shown, and the raster on which it begins."""
_SHADED = 2.0
"""Standard deviations of the noise that are shaded."""
DECADES = 9.0
"""Decades below the highest density that a spectrum shows: down to the noise of a good sensor."""
NOMINAL = Entry("nominal", "#ECB78C", width=2.2)
"""A pale `COLOURS[1]`, wide upon the measured signal, and the last simulation thin upon both, so that all are seen."""
_REFITTED, AUGMENTED = Entry("refitted", COLOURS[2], width=1.0), Entry("with effects", COLOURS[0], width=1.0)
_SIMULATED = Entry("simulated", COLOURS[1], width=1.0)
NOISE = Entry("sensor noise", "black", ":", width=1.3)
_BAND = Entry(f"±{_SHADED:g} RMS of the noise", style.AREA, width=8)
_POSITIVE = {"cushion": "pushes driver and frame apart", "driver": "lifts the driver", "sensor": "shows too much"}
"""What a signal that lacks in a block does where it is positive; in others than these and the damper a force lifts."""
GRID = Grid((1.5, 1.0, 1.3), left=1.04, gap=(0.0, 0.5))
_Looks: TypeAlias = dict[str, Entry]
"""Looks of simulations that are compared with a measurement, by their names in a trace."""
_SIZES = (12, 9, 6)
"""Sizes of the marks of a gap, the nominal one first: those that coincide are seen around each other."""
LETTERS = 19
"""Letters of a label beside a panel that is this low."""


def plot_diagnosis(diagnosis: Diagnosis) -> dict[str, Figure]:
    """Return the figures of a diagnosis by name; without a gap there is no evidence for causes to be drawn.

    After the others a picture of each held-out channel, the channel with the largest nominal gap first.
    """
    plots = {"gaps": _plot_gaps(diagnosis)}
    if diagnosis.verdict != "none":
        plots |= {"discrepancy": _plot_discrepancy(diagnosis), "maps": _plot_maps(diagnosis)}
    found = {name: figure for name, figure in plots.items() if figure is not None}
    looks = {"nominal": NOMINAL, "after": find_last(diagnosis)}
    return found | _plot_channels(diagnosis.evidence.traces, looks)


def plot_all_of_gap(found: Gap) -> dict[str, Figure]:
    """Return a figure of each channel of a gap by name, the one with the largest gap first."""
    return _plot_channels(residuals.list_traces(found), {"nominal": _SIMULATED})


def find_last(diagnosis: Diagnosis) -> Entry:
    """Return the look of the simulation of `augmented.yaml`; without effects it is the refitted one."""
    return AUGMENTED if diagnosis.selected else _REFITTED


def _plot_gaps(diagnosis: Diagnosis) -> Figure | None:
    """Return the gap of each channel on its way from the nominal simulation to the noise floor."""
    gap, last = diagnosis.gap, find_last(diagnosis)
    names = ["overall", *gap.before.channels]
    stages = [(gap.before, NOMINAL._replace(mark="o"))]
    stages += [(gap.calibrated, _REFITTED._replace(mark="D"))] if last is AUGMENTED else []
    stages += [(gap.after, last._replace(mark="s")), (gap.floor, NOISE._replace(label="noise floor", mark="|"))]
    looks = [look._replace(dashes="none") for _, look in stages]
    rows = [[({**gaps.channels, "overall": gaps.overall}).get(name) or 0.0 for gaps, _ in stages] for name in names]
    seen = [100 * value for row in rows for value in row if np.isfinite(value) and value > SMALLEST]
    if len(names) == 1 or not seen:
        return None
    shown = [name.replace("_", " ") for name in names]
    which, left = "held-out" if diagnosis.held_out else "all", style.measure_names(shown)
    note = f"RMS of measured less simulated over the spread of the signal, of {which} runs; further left is better."
    grid = Grid((0.27 * len(names) + 0.1,), left=left, right=0.5)
    figure, [[axes]] = style.make_page("Gap of each channel, before and after", note, grid, looks)
    axes.set(ylim=(len(names) - 0.4, -0.6), yticks=range(len(names)), yticklabels=shown, xlabel="gap [%]")
    style.scale_log(axes, "x", min(seen) / 1.4, max(seen) * 1.4)
    sizes = (*_SIZES[: len(looks) - 1], 15)
    for row, values in enumerate(rows):
        seen = [100 * value for value in values if value > SMALLEST]
        axes.plot(seen, [row] * len(seen), color="0.8", linewidth=1.5, zorder=1)
        for value, look, size in zip(values, looks, sizes, strict=True):
            style.draw_line(axes, [100 * value], [row], look).set(markersize=size, zorder=3, visible=value > SMALLEST)
    return figure


def _describe_motion(diagnosis: Diagnosis, name: str) -> Quantity:
    """Return how motion is shown: of the suspension, or on a bench, whose scenario has no plant, of the damper."""
    holder = "suspension" if "plant" in diagnosis.augmented else "damper"
    return describe_channel(f"{holder}_{name}" if name in ("velocity", "displacement") else name, UNITS[name])


def _plot_maps(diagnosis: Diagnosis) -> Figure | None:
    """Return maps of what is left of the worst channel over velocity and current (or travel), before and after."""
    found = residuals.find_worst(diagnosis)
    if found is None:
        return None
    trace, motion = found
    other = next((name for name in ("coil_current", "displacement") if residuals.varies(motion.get(name))), "")
    if not other or not residuals.varies(motion.get("velocity")):
        return None
    across, up = (_describe_motion(diagnosis, name) for name in ("velocity", other))
    x, y = across.factor * motion["velocity"], up.factor * motion[other]
    borders = residuals.bin_edges(x, BINS[0]), residuals.bin_edges(y, BINS[1])
    shown = describe_channel(trace.channel, trace.unit)
    left = (trace.measured - trace.nominal, trace.measured - trace.after)
    cells = [shown.factor * residuals.map_rms(x, y, signal, borders) for signal in left]
    known = np.concatenate([each[np.isfinite(each)] for each in cells])
    if np.max(known, initial=0.0) <= 0:
        return None
    title = f"Error of the {shown.words} over {across.words} and {up.words}"
    note = f"RMS of measured less simulated on {trace.run}; cells of fewer than {residuals.FEWEST} samples stay empty."
    low, high = max(float(known.min()), float(known.max()) / 100), float(known.max())
    note += f" The darkest cells: {format_number(low)} {shown.unit} or less." if known.min() < low else ""
    figure, [panels] = style.make_page(title, note, Grid((2.2,), 2, right=0.95, top=0.3, gap=(0.45, 0.0)))
    norm = LogNorm(low, high)
    for axes, name, values in zip(panels, ("nominal", find_last(diagnosis).label), cells, strict=True):
        mesh = axes.pcolormesh(*borders, values, norm=norm, cmap=colormaps["viridis"], rasterized=True)
        axes.set_xlabel(across.axis)
        style.set_title(axes, name)
    panels[0].set_ylabel(up.axis)
    panels[1].tick_params(labelleft=False)
    style.scale_log(style.add_colour_bar(panels[1], mesh, f"error [{shown.unit}], logarithmic"), "y", low, high)
    return figure


def _plot_discrepancy(diagnosis: Diagnosis) -> Figure | None:
    """Return the signal that would close the gap, over time and over what may drive it."""
    found = diagnosis.evidence.discrepancy
    if found is None or len(found.values) < 2:
        return None
    shown = describe_channel(found.quantity, found.unit)
    known = {name: values for name, values in diagnosis.evidence.motion.items() if len(values) == len(found.values)}
    motion = {name: values for name, values in known.items() if name in UNITS and residuals.varies(values)}
    grid = Grid((1.6,) * (1 + len(motion) // 2), columns=2, gap=(0.75, 0.6))
    run = diagnosis.evidence.traces[0].run if diagnosis.evidence.traces else "the held-out run"
    note = f"On {run}, over time{', then over what moves or changes' * bool(motion)}. "
    positive = _POSITIVE.get(found.block, "lifts the frame" if found.unit == "N" else "more than is simulated")
    note += SIGNS if found.block == "damper" else f"Positive: {positive}."
    page = style.make_page(f"{found.words[:1].upper()}{found.words[1:]}", note, grid)
    first, *panels = page.list_panels(1 + len(motion))
    style.draw_line(first, *thin_line(found.time, shown.factor * found.values), Entry("", COLOURS[6], width=1.0))
    first.set(xlabel="time [s]", ylabel=fill(shown.axis, LETTERS))
    every = max(1, len(found.values) // _DOTS)
    for axes, (name, values) in zip(panels, motion.items(), strict=True):
        own = _describe_motion(diagnosis, name)
        places, lacking = own.factor * values[::every], shown.factor * found.values[::every]
        axes.scatter(places, lacking, s=3, color=COLOURS[6], linewidths=0, rasterized=True)
        axes.set(xlabel=own.axis, ylabel=fill(shown.axis, LETTERS))
    return page.figure


def _plot_channels(traces: Sequence[Trace], looks: _Looks) -> dict[str, Figure]:
    """Return a picture of each channel by name, the channel with the largest nominal gap first."""
    groups = residuals.group_by_channel(traces).values()
    worst = [(max(group, key=lambda each: rms(_subtract(each, "nominal"))), group) for group in groups]
    ordered = sorted(worst, key=lambda pair: -residuals.nominal_gap(pair[0]))
    return {f"signal_{trace.channel}": _plot_channel(trace, group, looks) for trace, group in ordered}


def _plot_channel(trace: Trace, group: Sequence[Trace], looks: _Looks) -> Figure:
    """Return a picture of a channel: of its worst run over time, and of all of its runs over frequency."""
    shown = describe_channel(trace.channel, trace.unit)
    step, noise = (trace.time[-1] - trace.time[0]) / (len(trace.time) - 1), shown.factor * trace.noise_rms
    loudest = find_loudest(_subtract(trace, "nominal"), step, SECONDS, RASTER)
    window = Window(*(end + trace.time[0] for end in loudest))
    left_over = [[_subtract(each, name) for each in group] for name in looks]
    density = [estimate_density(step, signals) for signals in ([each.measured for each in group], *left_over)]
    first = find_first(density)
    note = f"{window} of {trace.run}, where the difference has most energy; RMS over the whole run."
    note += " A thin line lies upon the wide ones with which it agrees. Middle panel: measured less simulated."
    legend, grid = [MEASURED, *looks.values(), *[NOISE, _BAND] * bool(noise)], GRID
    if np.isfinite(first):
        note += f" Lowest panel: power densities of the measured signal and of what differs. {state_method(first)}"
    else:
        grid, legend = GRID._replace(heights=GRID.heights[:2]), [entry for entry in legend if entry is not NOISE]
    sizes = [(look.label, rms(_subtract(trace, name))) for name, look in looks.items()]
    sizes += [("noise", trace.noise_rms)] * (trace.noise_rms > 0)
    figures = [f"{name} {format_number(shown.factor * x)} {shown.unit}".replace(" ", "\u00a0") for name, x in sizes]
    title = f"{shown.words[:1].upper()}{shown.words[1:]}, RMS difference: {', '.join(figures)}"
    figure, [[upper], [lower], *spectra] = style.make_page(title, note, grid, legend)
    inside = (trace.time >= window.start) & (trace.time <= window.end)
    drawn = [(upper, trace.measured, MEASURED)]
    for name, look in looks.items():
        drawn += [(upper, getattr(trace, name), look), (lower, _subtract(trace, name), look)]
    for axes, values, look in drawn:
        style.draw_line(axes, *thin_line(trace.time[inside], shown.factor * values[inside]), look)
    lower.axhline(0.0, color="0.6", linewidth=0.8, zorder=0.5)
    upper.set_ylabel(fill(f"{shown.words} [{shown.unit}]", LETTERS))
    lower.set_ylabel(f"difference\n[{shown.unit}]")
    for axes in (upper, lower):
        axes.set_xlim(*window)
        axes.set_xlabel("time [s]", labelpad=1)
    densities = [(places, shown.factor**2 * power) for places, power in density]
    if noise:
        lower.axhspan(-_SHADED * noise, _SHADED * noise, color=style.AREA, linewidth=0, zorder=0)
        # Its edges stand before the lines, which hide a band that they fill.
        lower.hlines((-_SHADED * noise, _SHADED * noise), *window, colors="black", linestyles=":", zorder=3)
        # The one-sided density of white noise of RMS s is 2 s^2 dt.
        densities.append((density[0][0], np.full(len(density[0][0]), 2 * noise**2 * step)))
    # Differences that no gap counts, such as those of rounding, look like none.
    least, (low, high) = SMALLEST * shown.factor * float(np.ptp(trace.measured)), lower.get_ylim()
    lower.set_ylim(min(-least, low), max(least, high))
    for [axes] in spectra:
        draw_densities(axes, densities, [MEASURED, *looks.values(), NOISE][: len(densities)], decades=DECADES)
        style.scale_frequency_axis(axes, first, 0.5 / step)
        axes.set_ylabel(f"power density\n[{shown.square}/Hz]")
    for axes in figure.axes:
        axes.yaxis.set_label_coords(-0.125, 0.5)
    return style.name_coincident(figure)


def _subtract(trace: Trace, name: str) -> Array:
    return np.asarray(trace.measured - getattr(trace, name))
