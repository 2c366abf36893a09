"""Where in the operating range a channel is off: over velocity and current, travel, temperature, frequency, time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.ticker import LogLocator, NullLocator

from seatsim.diagnosis.result import Array, Diagnosis, Trace
from seatsim.plots import style
from seatsim.plots.diagnosis.bins import (
    FEWEST,
    Residual,
    binned_rms,
    by_band,
    edges,
    mapped_rms,
    residual,
    spectrum,
    step,
    varies,
    worst,
)  # fmt: skip
from seatsim.plots.diagnosis.frame import FONT, NOISE, NOMINAL, WIDE, Picture, Quantity, frame, quantity, short
from seatsim.plots.diagnosis.signals import LOWEST, SHORTEST, TICKS, after_look
from seatsim.plots.style import Entry, Grid

OVER = {
    "velocity": Quantity("velocity", "m/s"),
    "displacement": Quantity("travel", "mm", 1e3),
    "coil_current": Quantity("coil current", "A"),
    "damper_temperature": Quantity("damper temperature", "°C"),
}
"""How the measured motion is drawn."""
BINS = (22, 13)
PROFILE = 16
PER_OCTAVE = 2
EMPTY = "0.87"
"""Colour of bins with too few samples."""
STEEP = 30.0
"""Greatest over least level from which on a profile has a logarithmic scale."""
LEAST = 3.0
"""Least upper end of the scale of colours, in units of the noise."""


class Subject(NamedTuple):
    """The channel whose maps are drawn: what is left of it, in `unit`, and over what."""

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


def maps(diagnosis: Diagnosis) -> list[Picture]:
    """Return the maps of the channel with the largest gap, as far as its motion is known."""
    found = worst(diagnosis)
    if found is None:
        return []
    subject = _subject(*found, after_look(diagnosis))
    pictures = [_plane(subject)]
    pictures += [_over(subject, name) for name in ("displacement", "damper_temperature")]
    pictures += [_over_frequency(subject), _over_time(subject)]
    return [picture for picture in pictures if picture is not None]


def _subject(trace: Trace, motion: dict[str, Array], look: Entry) -> Subject:
    shown, left = quantity(trace.channel, trace.unit), residual(trace)
    noise = trace.noise_rms
    unit, scale = ("× noise", 1 / noise) if noise > 0 else (shown.unit, shown.factor)
    scaled = Residual(scale * left.before, scale * left.after)
    return Subject(trace, motion, scaled, unit, shown.words, (NOMINAL, look))


def _plane(subject: Subject) -> Picture | None:
    """Return the map over velocity and current, or displacement where the current is not known or constant."""
    motion = subject.motion
    other = next((name for name in ("coil_current", "displacement") if varies(motion.get(name))), "")
    if not other or not varies(motion.get("velocity")):
        return None
    axis_x, axis_y = OVER["velocity"], OVER[other]
    x, y = axis_x.factor * motion["velocity"], axis_y.factor * motion[other]
    borders = edges(x, BINS[0]), edges(y, BINS[1])
    cells = [mapped_rms(x, y, course, borders) for course in subject.left]
    if all(np.isnan(values).all() for values in cells):
        return None
    page = frame(Grid((2.7,), columns=2, left=0.75, right=1.0, top=0.4, bottom=0.55, gap=(0.2, 0.0)), width=WIDE)
    _fill(page.rows[0], cells, borders, subject)
    page.rows[0][0].set_ylabel(axis_y.axis, fontsize=FONT)
    for axes in page.rows[0]:
        axes.set_xlabel(axis_x.axis, fontsize=FONT)
    peaks = [float(np.nanmax(values)) for values in cells]
    title = (
        f"{subject.words[:1].upper()}{subject.words[1:]} over {axis_x.words} and {axis_y.words}:"
        f" up to {short(peaks[0])} {subject.unit} nominal, {short(peaks[1])} {subject.looks[1].label}"
    )
    caption = f"RMS of what is left in each bin, {subject.trace.run}. Grey: fewer than {FEWEST} samples."
    return Picture(title, caption, page.figure)


def _fill(row: Sequence[Axes], cells: list[Array], borders: tuple[Array, Array], subject: Subject) -> None:
    most = max(float(np.nanmax(values)) for values in cells)
    low = 1.0 if subject.unit == "× noise" else most / 30
    norm = LogNorm(low, max(most, LEAST * low))
    mesh: Any = None
    for axes, values, look in zip(row, cells, subject.looks, strict=True):
        axes.set_facecolor(EMPTY)
        axes.grid(False)
        # A bin below the noise takes the lowest colour: on a logarithmic scale it would be left empty.
        shown = np.ma.masked_invalid(np.maximum(values, low))
        mesh = axes.pcolormesh(*borders, shown, cmap=colormaps["viridis"], norm=norm)
        axes.set_title(look.label, fontsize=10.5, loc="left", fontweight="bold")
    row[1].tick_params(labelleft=False)
    box = row[1].get_position()
    beside = row[1].figure.add_axes((box.x1 + 0.02, box.y0, 0.02, box.height))
    bar = row[1].figure.colorbar(mesh, cax=beside)
    bar.ax.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.yaxis.set_minor_locator(NullLocator())
    bar.ax.tick_params(labelsize=FONT)
    bar.set_label(subject.level, fontsize=FONT)


def _over(subject: Subject, name: str) -> Picture | None:
    """Return the profile over a quantity of the measured motion, where it varies."""
    values, axis = subject.motion.get(name), OVER[name]
    if values is None or not varies(values):
        return None
    borders = edges(axis.factor * values, PROFILE)
    centres = 0.5 * (borders[1:] + borders[:-1])
    levels = [binned_rms(axis.factor * values, course, borders) for course in subject.left]
    return _profile(subject, axis, centres, levels)


def _over_time(subject: Subject) -> Picture | None:
    time = subject.trace.time
    borders = np.linspace(time[0], time[-1], max(2, min(25, round(time[-1] - time[0]))) + 1)
    levels = [binned_rms(time, course, borders) for course in subject.left]
    return _profile(subject, Quantity("time", "s"), 0.5 * (borders[1:] + borders[:-1]), levels)


def _over_frequency(subject: Subject) -> Picture | None:
    """Return the profile over bands of half an octave, each over the noise that falls into it."""
    time = subject.trace.time
    if len(time) < SHORTEST:
        return None
    centres, levels = np.empty(0), []
    for course in subject.left:
        frequency, power = spectrum(time, [course])
        centres, density, count = by_band(frequency, power, LOWEST, PER_OCTAVE)
        # White noise of unit RMS has a density of 2 dt: the ratio of the two in a band needs no widths.
        white = 2.0 * step(time) if subject.unit == "× noise" else 1.0 / ((frequency[1] - frequency[0]) * count)
        levels.append(np.sqrt(density / white))
    picture = _profile(subject, Quantity("frequency", "Hz"), centres, levels)
    if picture is not None:
        axes = picture.figure.axes[0]
        axes.set_xscale("log")
        ticks = [tick for tick in TICKS if tick <= centres[-1]]
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.xaxis.set_minor_locator(NullLocator())
    return picture


def _profile(subject: Subject, axis: Quantity, centres: Array, levels: list[Array]) -> Picture | None:
    known = np.isfinite(levels[0])
    if known.sum() < 2:
        return None
    against_noise = subject.unit == "× noise"
    page = frame(Grid((1.55,), left=0.8, right=0.25, top=0.1, bottom=0.5), [*subject.looks, *[NOISE] * against_noise])
    axes = page.rows[0][0]
    for level, look, marker in zip(levels, subject.looks, "os", strict=True):
        front = 3 if look is NOMINAL else 2
        style.line(axes, centres, level, look)
        axes.plot(centres, level, marker, markersize=4, color=look.colour, zorder=front)
    if against_noise:
        axes.axhline(1.0, color=NOISE.colour, linestyle=NOISE.dashes, linewidth=NOISE.width)
    _height(axes, levels)
    axes.set_xlabel(axis.axis, fontsize=FONT)
    axes.set_ylabel(subject.level, fontsize=FONT)
    peak = int(np.nanargmax(levels[0]))
    low, high = np.nanmin(levels[0]), np.nanmax(levels[0])
    place = f"{short(centres[peak])} {axis.unit}"
    title = f"Over {axis.words}: {short(low)} to {short(high)} {subject.unit}, most near {place}"
    return Picture(title, f"{subject.words[:1].upper()}{subject.words[1:]}, {subject.trace.run}.", page.figure)


def _height(axes: Axes, levels: list[Array]) -> None:
    """Scale a profile: from zero, or by decades where the levels differ too much for that."""
    known = np.concatenate([level[np.isfinite(level)] for level in levels])
    if known.min() > 0 and known.max() > STEEP * known.min():
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(numticks=5))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_major_formatter("{x:g}")
    else:
        axes.set_ylim(bottom=0.0)
