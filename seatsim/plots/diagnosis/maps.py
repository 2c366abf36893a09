"""Over which motion and current the simulation is wrong: maps of the error, and the signal that it lacks."""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from seatsim.diagnosis.residuals import FEWEST, bin_edges, find_worst, map_rms, varies
from seatsim.diagnosis.result import Diagnosis
from seatsim.plots import style
from seatsim.plots.diagnosis.answer import find_last
from seatsim.plots.style import COLOURS, Entry, Grid
from seatsim.plots.thinning import thin_line
from seatsim.schema.printing import describe_channel, format_number

BINS = (22, 13)
"""Bins of a map over velocity and over the other quantity."""
DOTS = 2500


UNITS = {"velocity": "m/s", "displacement": "m", "coil_current": "A", "damper_temperature": "degC"}
MOTIONS = {name: describe_channel(name, unit) for name, unit in UNITS.items()}
"""How measured motion, of a suspension or a damper, is shown."""


def plot_maps(diagnosis: Diagnosis) -> Figure | None:
    """Return maps of what is left of the worst channel over velocity and current (or travel), before and after."""
    found = find_worst(diagnosis)
    if found is None:
        return None
    trace, motion = found
    other = next((name for name in ("coil_current", "displacement") if varies(motion.get(name))), "")
    if not other or not varies(motion.get("velocity")):
        return None
    x, y = (MOTIONS[name].factor * motion[name] for name in ("velocity", other))
    borders = bin_edges(x, BINS[0]), bin_edges(y, BINS[1])
    shown = describe_channel(trace.channel, trace.unit)
    left = (trace.measured - trace.nominal, trace.measured - trace.after)
    cells = [shown.factor * map_rms(x, y, signal, borders) for signal in left]
    known = np.concatenate([each[np.isfinite(each)] for each in cells])
    if not known.size or not known.max() > 0:
        return None
    title = f"Error of the {shown.words} over velocity and {MOTIONS[other].words}"
    note = f"RMS of measured less simulated on {trace.run}; cells of fewer than {FEWEST} samples stay empty."
    low, high = max(float(known.min()), float(known.max()) / 100), float(known.max())
    note += f" The darkest cells: {format_number(low)} {shown.unit} or less." if known.min() < low else ""
    figure, [panels] = style.make_page(title, note, Grid((2.2,), 2, right=0.95, top=0.3, gap=(0.15, 0.0)))
    norm = LogNorm(low, high)
    for axes, name, values in zip(panels, ("nominal", find_last(diagnosis).label), cells, strict=True):
        mesh = axes.pcolormesh(*borders, values, norm=norm, cmap=colormaps["viridis"], rasterized=True)
        axes.set_xlabel(MOTIONS["velocity"].axis)
        style.set_title(axes, name)
    panels[0].set_ylabel(MOTIONS[other].axis)
    panels[1].tick_params(labelleft=False)
    style.scale_log(style.add_colour_bar(panels[1], mesh, f"error [{shown.unit}], logarithmic"), "y", low, high)
    return figure


def plot_discrepancy(diagnosis: Diagnosis) -> Figure | None:
    """Return the signal that would close the gap, over time and over what may drive it."""
    found = diagnosis.evidence.discrepancy
    if found is None or len(found.values) < 2:
        return None
    shown = describe_channel(found.quantity, found.unit)
    known = {name: values for name, values in diagnosis.evidence.motion.items() if name in MOTIONS and varies(values)}
    motion = {name: values for name, values in known.items() if len(values) == len(found.values)}
    grid = Grid((1.6,) * (1 + len(motion) // 2), columns=2, gap=(0.75, 0.6))
    title = f"The missing {shown.words} of the {found.block}"
    note = "What the simulation lacks to agree with the held-out run: over time, then over what moves or changes."
    page = style.make_page(title, note, grid)
    first, *panels = page.list_panels(1 + len(motion))
    style.draw_line(first, *thin_line(found.time, shown.factor * found.values), Entry("", COLOURS[6], width=1.0))
    first.set(xlabel="time [s]", ylabel=shown.axis)
    every = max(1, len(found.values) // DOTS)
    for axes, (name, values) in zip(panels, motion.items(), strict=True):
        places, lacking = MOTIONS[name].factor * values[::every], shown.factor * found.values[::every]
        axes.scatter(places, lacking, s=3, color=COLOURS[6], linewidths=0, rasterized=True)
        axes.set(xlabel=MOTIONS[name].axis, ylabel=shown.axis)
    return page.figure
