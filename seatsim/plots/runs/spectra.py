"""Frequency content: power spectral densities, and what the seat passes on to the driver."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from seatsim import metrics
from seatsim.metrics.transmissibility import AVERAGES, LONGEST
from seatsim.plots import labels, style
from seatsim.plots.style import GREY, Entry, Grid
from seatsim.plots.thinning import Array
from seatsim.schema.errors import InputError
from seatsim.simulation.result import Run

BAND = (0.3, 30.0)
"""Hz; what the seat can change, and more than the driver feels."""
TICKS = (0.3, 0.5, 1, 2, 3, 5, 10, 20, 30)
PER_OCTAVE = 12
DECADES = 6.0
"""Decades below the highest density that are shown."""
TRUSTED = 0.5
"""Least coherence with which a transmissibility is drawn: below it is chance."""
GRID = Grid(heights=(4.4,))


class Density(NamedTuple):
    """Power spectral density in m^2/s^3 over frequency in Hz, within `BAND`."""

    frequency: Array
    power: Array


def psd(runs: Sequence[Run]) -> Figure:
    """Return the power spectral density of the driver's acceleration, run by run, with the floor's."""
    chosen = labels.shown(runs)
    looks = style.entries(labels.labels(chosen))
    floor = Entry("floor", GREY, width=2.2)
    note = f"Welch's method, averaged over 1/{PER_OCTAVE} octave.{labels.which(chosen, runs)}"
    title = f"Driver acceleration over frequency: {labels.title(runs)}"
    page = style.page(title, note, GRID, [*looks, floor])
    axes = page.rows[0][0]
    lines = [(_density(run, "floor_acceleration"), floor) for run in _floors(chosen)]
    lines += [(_density(run, "driver_acceleration"), look) for run, look in zip(chosen, looks, strict=True)]
    _frequency_axis(axes)
    axes.set_ylabel("power spectral density [m²/s³]")
    highest = max(float(np.max(density.power, initial=0.0)) for density, _ in lines)
    if highest == 0.0:
        style.say(axes, "at rest, or too short a run for a spectrum")
        return page.figure
    axes.set_yscale("log")
    for density, look in lines:
        style.line(axes, *density, look)
    axes.set_ylim(bottom=max(axes.get_ylim()[0], highest / 10**DECADES))
    return page.figure


def transmissibility(runs: Sequence[Run]) -> Figure:
    """Return the magnitude of the transmissibility from floor to driver, where the coherence is high."""
    chosen = labels.shown(runs)
    looks = style.entries(labels.labels(chosen))
    note = f"Drawn where the floor explains the driver's motion (coherence of {TRUSTED:g} or more)."
    title = f"Transmissibility, floor to driver: {labels.title(runs)}"
    page = style.page(title, note + labels.which(chosen, runs), GRID, looks)
    axes = page.rows[0][0]
    _frequency_axis(axes)
    axes.set_ylabel("|driver / floor| [-]")
    drawn = [_gain(axes, run, look) for run, look in zip(chosen, looks, strict=True)]
    if not any(drawn):
        style.say(axes, "no floor motion, no coherence with it, or too short a run")
        return page.figure
    axes.axhline(1.0, color=GREY, linewidth=1.0, zorder=1)
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    return page.figure


def _floors(runs: Sequence[Run]) -> list[Run]:
    """Return the runs less those whose floor moves as that of one before."""
    found: list[Run] = []
    for run in runs:
        floor = run.history["floor_acceleration"]
        if not any(np.array_equal(floor, other.history["floor_acceleration"]) for other in found):
            found.append(run)
    return found


def _density(run: Run, channel: str) -> Density:
    values, rate = run.history[channel], 1 / run.history.step
    length = max(1, min(round(LONGEST * rate), 2 * len(values) // (AVERAGES + 1)))
    frequency, power = metrics.power_spectral_density(values, rate, length)
    return _averaged(frequency, power)


def _averaged(frequency: Array, power: Array) -> Density:
    """Average over bins of equal width on a logarithmic axis; lines further apart stay as they are."""
    inside = (frequency >= BAND[0]) & (frequency <= BAND[1])
    frequency, power = frequency[inside], power[inside]
    bins = np.floor(PER_OCTAVE * np.log2(frequency / BAND[0])).astype(int)
    _, index = np.unique(bins, return_inverse=True)
    count = np.bincount(index)
    return Density(np.bincount(index, frequency) / count, np.bincount(index, power) / count)


def _gain(axes: Axes, run: Run, look: Entry) -> bool:
    """Draw the transmissibility of a run; tell whether it has one."""
    floor, driver = run.history["floor_acceleration"], run.history["driver_acceleration"]
    try:
        found = metrics.transmissibility(floor, driver, 1 / run.history.step)
    except InputError:
        return False
    inside = (found.frequency >= BAND[0]) & (found.frequency <= BAND[1])
    trusted = inside & (found.coherence >= TRUSTED)
    style.line(axes, found.frequency[inside], np.where(trusted, found.gain, np.nan)[inside], look)
    return bool(trusted.any())


def _frequency_axis(axes: Axes) -> None:
    axes.set_xscale("log")
    axes.set_xlim(*BAND)
    axes.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("frequency [Hz]")
