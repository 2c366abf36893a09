"""Frequency content: power spectral densities, and the transmissibility from floor to driver."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from seatsim.metrics.spectra import AVERAGES, LONGEST, power_spectral_density, transmissibility
from seatsim.plots import style
from seatsim.plots.runs import naming
from seatsim.plots.style import GREY, Entry, Grid
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.simulation.result import Run

BAND = (0.3, 30.0)
"""Hz; what the seat can change, and more than the driver feels."""
TICKS = (0.3, 0.5, 1, 2, 3, 5, 10, 20, 30)
PER_OCTAVE = 12
"""Bands in an octave over which a density is averaged, finer than the resonance of a seat is wide."""
DECADES = 6.0
"""Decades below the highest density that are shown."""
TRUSTED = 0.5
"""Least coherence of a transmissibility drawn in full; below it most of the driver's motion is not the floor's."""
FADED = 0.25
"""Share of its opacity with which the rest is drawn."""
GRID = Grid(heights=(4.4,))


class Density(NamedTuple):
    """Power spectral density in m^2/s^3 over frequency in Hz, within `BAND`."""

    frequency: Array
    power: Array


def plot_psd(runs: Sequence[Run]) -> Figure:
    """Return the power spectral density of the driver's acceleration in m^2/s^3, run by run, with the floor's."""
    chosen = naming.select_shown(runs)
    looks = style.make_entries(naming.label_runs(chosen))
    floor = Entry("floor", GREY, width=2.2)
    note = f"Welch's method, averaged over 1/{PER_OCTAVE} octave.{naming.describe_omission(chosen, runs)}"
    title = f"Driver acceleration over frequency: {naming.make_title(runs)}"
    page = style.make_page(title, note, GRID, [*looks, floor])
    axes = page.rows[0][0]
    lines = [(_estimate_density(run, "floor_acceleration"), floor) for run in _find_distinct_floors(chosen)]
    lines += [(_estimate_density(run, "driver_acceleration"), look) for run, look in zip(chosen, looks, strict=True)]
    _scale_frequency_axis(axes)
    axes.set_ylabel("power spectral density [m²/s³]")
    highest = max(float(np.max(density.power, initial=0.0)) for density, _ in lines)
    if highest == 0.0:
        style.explain_empty(axes, "at rest, or too short a run for a spectrum")
        return page.figure
    axes.set_yscale("log")
    for density, look in lines:
        style.draw_line(axes, *density, look)
    axes.set_ylim(bottom=max(axes.get_ylim()[0], highest / 10**DECADES))
    return page.figure


def plot_transmissibility(runs: Sequence[Run]) -> Figure:
    """Return the magnitude of the transmissibility from floor to driver, faded where the coherence is low."""
    chosen = naming.select_shown(runs)
    looks = style.make_entries(naming.label_runs(chosen))
    note = f"Faded where the floor explains less than half of the driver's motion (coherence below {TRUSTED:g})."
    title = f"Transmissibility, floor to driver: {naming.make_title(runs)}"
    page = style.make_page(title, note + naming.describe_omission(chosen, runs), GRID, looks)
    axes = page.rows[0][0]
    _scale_frequency_axis(axes)
    axes.set_ylabel("|driver / floor| [-]")
    drawn = [_draw_gain(axes, run, look) for run, look in zip(chosen, looks, strict=True)]
    if not any(drawn):
        style.explain_empty(axes, "no floor motion, no coherence with it, or too short a run")
        return page.figure
    axes.axhline(1.0, color=GREY, linewidth=1.0, zorder=1)
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    return page.figure


def _find_distinct_floors(runs: Sequence[Run]) -> list[Run]:
    """Return the runs less those whose floor moves as that of one before."""
    found: list[Run] = []
    for run in runs:
        floor = run.history["floor_acceleration"]
        if not any(np.array_equal(floor, other.history["floor_acceleration"]) for other in found):
            found.append(run)
    return found


def _estimate_density(run: Run, channel: str) -> Density:
    values, rate = run.history[channel], 1 / run.history.step
    length = max(1, min(round(LONGEST * rate), 2 * len(values) // (AVERAGES + 1)))
    frequency, power = power_spectral_density(values, rate, length)
    return _average_bands(frequency, power)


def _average_bands(frequency: Array, power: Array) -> Density:
    """Return means over bands of equal width on a logarithmic axis; lines further apart than a band stay as they are.

    Otherwise the many lines of the high decades would make the drawn line thick and noisy.
    """
    inside = (frequency >= BAND[0]) & (frequency <= BAND[1])
    frequency, power = frequency[inside], power[inside]
    bins = np.floor(PER_OCTAVE * np.log2(frequency / BAND[0])).astype(int)
    _, index = np.unique(bins, return_inverse=True)
    count = np.bincount(index)
    return Density(np.bincount(index, frequency) / count, np.bincount(index, power) / count)


def _draw_gain(axes: Axes, run: Run, look: Entry) -> bool:
    """Draw the transmissibility of a run; return whether any of it can be trusted."""
    floor, driver = run.history["floor_acceleration"], run.history["driver_acceleration"]
    try:
        found = transmissibility(floor, driver, 1 / run.history.step)
    except InputError:
        return False
    inside = (found.frequency >= BAND[0]) & (found.frequency <= BAND[1])
    trusted = inside & (found.coherence >= TRUSTED)
    if not trusted.any():
        return False
    faded = look._replace(alpha=FADED * look.alpha)
    style.draw_line(axes, found.frequency[inside], found.gain[inside], faded)
    style.draw_line(axes, found.frequency[inside], np.where(trusted, found.gain, np.nan)[inside], look)
    return True


def _scale_frequency_axis(axes: Axes) -> None:
    axes.set_xscale("log")
    axes.set_xlim(*BAND)
    axes.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("frequency [Hz]")
