"""Residual of a channel over the operating range: velocity and current, travel, temperature, frequency, time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.ticker import LogLocator

from seatsim.diagnosis.result import Diagnosis, Trace
from seatsim.plots import style
from seatsim.plots.diagnosis.bins import (
    FEWEST,
    LOWEST,
    SHORTEST,
    Residual,
    average_bands,
    bin_edges,
    bin_rms,
    compute_residual,
    estimate_spectrum,
    find_worst,
    map_rms,
    sample_step,
    varies,
)  # fmt: skip
from seatsim.plots.diagnosis.frame import NOISE, NOMINAL, choose_after_look, scale_frequency_axis
from seatsim.plots.frame import FONT, WIDE, Picture, Quantity, describe_quantity, format_number, make_frame
from seatsim.plots.style import Entry, Grid
from seatsim.plots.thinning import Array

OVER = {
    "velocity": Quantity("velocity", "m/s"),
    "displacement": Quantity("travel", "mm", 1e3),
    "coil_current": Quantity("coil current", "A"),
    "damper_temperature": Quantity("damper temperature", "°C"),
}
"""How the measured motion is drawn."""
BINS = (22, 13)
"""Bins of a map over velocity and over the other quantity."""
PROFILE = 16
"""Bins of a profile over one quantity."""
PER_OCTAVE = 2
"""Bands in an octave of a profile over frequency."""
EMPTY = "0.87"
"""Colour of bins with too few samples."""
STEEP = 30.0
"""Greatest over least level from which on a profile has a logarithmic scale."""
LEAST = 3.0
"""Least upper end of the scale of colours, in units of the noise."""


class Subject(NamedTuple):
    """The channel whose maps are drawn: its residuals before and after in `unit`, and the motion under them."""

    trace: Trace
    motion: dict[str, Array]
    left: Residual
    unit: str
    words: str
    looks: tuple[Entry, Entry]

    @property
    def level(self) -> str:
        """The label of an axis over the RMS of the residual."""
        return f"RMS residual [{self.unit}]"


def plot_maps(diagnosis: Diagnosis) -> list[Picture]:
    """Return the maps of the channel with the largest gap, as far as its motion is known."""
    found = find_worst(diagnosis)
    if found is None:
        return []
    subject = _make_subject(*found, choose_after_look(diagnosis))
    pictures = [_plot_plane(subject)]
    pictures += [_plot_over(subject, name) for name in ("displacement", "damper_temperature")]
    pictures += [_plot_over_frequency(subject), _plot_over_time(subject)]
    return [picture for picture in pictures if picture is not None]


def _make_subject(trace: Trace, motion: dict[str, Array], look: Entry) -> Subject:
    shown, left = describe_quantity(trace.channel, trace.unit), compute_residual(trace)
    noise = trace.noise_rms
    unit, scale = ("× noise", 1 / noise) if noise > 0 else (shown.unit, shown.factor)
    scaled = Residual(scale * left.before, scale * left.after)
    return Subject(trace, motion, scaled, unit, shown.words, (NOMINAL, look))


def _plot_plane(subject: Subject) -> Picture | None:
    """Return the map over velocity and current, or displacement where the current is not known or constant."""
    motion = subject.motion
    other = next((name for name in ("coil_current", "displacement") if varies(motion.get(name))), "")
    if not other or not varies(motion.get("velocity")):
        return None
    axis_x, axis_y = OVER["velocity"], OVER[other]
    x, y = axis_x.factor * motion["velocity"], axis_y.factor * motion[other]
    borders = bin_edges(x, BINS[0]), bin_edges(y, BINS[1])
    cells = [map_rms(x, y, signal, borders) for signal in subject.left]
    if all(np.isnan(values).all() for values in cells):
        return None
    page = make_frame(Grid((2.7,), columns=2, left=0.75, right=1.0, top=0.4, bottom=0.55, gap=(0.2, 0.0)), width=WIDE)
    _draw_cells(page.rows[0], cells, borders, subject)
    page.rows[0][0].set_ylabel(axis_y.axis, fontsize=FONT)
    for axes in page.rows[0]:
        axes.set_xlabel(axis_x.axis, fontsize=FONT)
    peaks = [float(np.nanmax(values)) for values in cells]
    title = (
        f"{subject.words[:1].upper()}{subject.words[1:]} over {axis_x.words} and {axis_y.words}:"
        f" up to {format_number(peaks[0])} {subject.unit} nominal, {format_number(peaks[1])} {subject.looks[1].label}"
    )
    caption = f"RMS of what is left in each bin, {subject.trace.run}. Grey: fewer than {FEWEST} samples."
    return Picture(title, caption, page.figure)


def _draw_cells(row: Sequence[Axes], cells: list[Array], borders: tuple[Array, Array], subject: Subject) -> None:
    # One scale for both panels, from the noise where that is known, else over a factor of 30.
    most = max(float(np.nanmax(values)) for values in cells)
    low = 1.0 if subject.unit == "× noise" else most / 30
    norm = LogNorm(low, max(most, LEAST * low))
    meshes = []
    for axes, values, look in zip(row, cells, subject.looks, strict=True):
        axes.set_facecolor(EMPTY)
        axes.grid(False)
        # A bin below the noise takes the lowest colour: on a logarithmic scale it would be left empty.
        shown = np.ma.masked_invalid(np.maximum(values, low))
        meshes.append(axes.pcolormesh(*borders, shown, cmap=colormaps["viridis"], norm=norm))
        axes.set_title(look.label, fontsize=10.5, loc="left", fontweight="bold")
    row[1].tick_params(labelleft=False)
    bar = row[1].figure.colorbar(meshes[-1], cax=style.add_axes_beside(row[1], 0.02, 0.02))
    style.set_plain_log_ticks(bar.ax.yaxis, LogLocator(subs=(1, 2, 5)))
    bar.ax.tick_params(labelsize=FONT)
    bar.set_label(subject.level, fontsize=FONT)


def _plot_over(subject: Subject, name: str) -> Picture | None:
    """Return the profile over a quantity of the measured motion, where it varies."""
    values, axis = subject.motion.get(name), OVER[name]
    if values is None or not varies(values):
        return None
    borders = bin_edges(axis.factor * values, PROFILE)
    centres = 0.5 * (borders[1:] + borders[:-1])
    levels = [bin_rms(axis.factor * values, signal, borders) for signal in subject.left]
    return _plot_profile(subject, axis, centres, levels)


def _plot_over_time(subject: Subject) -> Picture | None:
    time = subject.trace.time
    borders = np.linspace(time[0], time[-1], max(2, min(25, round(time[-1] - time[0]))) + 1)
    levels = [bin_rms(time, signal, borders) for signal in subject.left]
    return _plot_profile(subject, Quantity("time", "s"), 0.5 * (borders[1:] + borders[:-1]), levels)


def _plot_over_frequency(subject: Subject) -> Picture | None:
    """Return the profile over bands of half an octave, each over the noise that falls into it."""
    time = subject.trace.time
    if len(time) < SHORTEST:
        return None
    centres, levels = np.empty(0), []
    for signal in subject.left:
        frequency, power = estimate_spectrum(time, [signal])
        centres, density, count = average_bands(frequency, power, LOWEST, PER_OCTAVE)
        # White noise of unit RMS has a density of 2 dt: the ratio of the two in a band needs no widths.
        white = 2.0 * sample_step(time) if subject.unit == "× noise" else 1.0 / ((frequency[1] - frequency[0]) * count)
        levels.append(np.sqrt(density / white))
    picture = _plot_profile(subject, Quantity("frequency", "Hz"), centres, levels)
    if picture is not None:
        scale_frequency_axis(picture.figure.axes[0], 0.0, float(centres[-1]))
    return picture


def _plot_profile(subject: Subject, axis: Quantity, centres: Array, levels: list[Array]) -> Picture | None:
    known = np.isfinite(levels[0])
    if known.sum() < 2:
        return None
    against_noise = subject.unit == "× noise"
    page = make_frame(
        Grid((1.55,), left=0.8, right=0.25, top=0.1, bottom=0.5), [*subject.looks, *[NOISE] * against_noise]
    )
    axes = page.rows[0][0]
    for level, look, marker in zip(levels, subject.looks, "os", strict=True):
        front = 3 if look is NOMINAL else 2
        style.draw_line(axes, centres, level, look)
        axes.plot(centres, level, marker, markersize=4, color=look.colour, zorder=front)
    if against_noise:
        axes.axhline(1.0, color=NOISE.colour, linestyle=NOISE.dashes, linewidth=NOISE.width)
    _scale_height(axes, levels)
    axes.set_xlabel(axis.axis, fontsize=FONT)
    axes.set_ylabel(subject.level, fontsize=FONT)
    peak = int(np.nanargmax(levels[0]))
    low, high = np.nanmin(levels[0]), np.nanmax(levels[0])
    place = f"{format_number(centres[peak])} {axis.unit}"
    title = f"Over {axis.words}: {format_number(low)} to {format_number(high)} {subject.unit}, most near {place}"
    return Picture(title, f"{subject.words[:1].upper()}{subject.words[1:]}, {subject.trace.run}.", page.figure)


def _scale_height(axes: Axes, levels: list[Array]) -> None:
    """Scale a profile: from zero, or by decades where the levels differ too much for that."""
    known = np.concatenate([level[np.isfinite(level)] for level in levels])
    if known.min() > 0 and known.max() > STEEP * known.min():
        axes.set_yscale("log")
        style.set_plain_log_ticks(axes.yaxis, LogLocator(numticks=5))
    else:
        axes.set_ylim(bottom=0.0)
