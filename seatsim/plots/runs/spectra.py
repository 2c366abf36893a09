"""Frequency content: power spectral densities, and the transmissibility from floor to driver."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.metrics.spectra import POWER, TRUSTED, estimate_density, trusted_gain
from seatsim.plots import style
from seatsim.plots.densities import draw_densities, find_first, find_problem, state_method
from seatsim.plots.runs.looks import Shown
from seatsim.plots.style import DASHES, GREY, Entry, Grid
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.simulation.naming import distinguish_runs
from seatsim.simulation.result import Run

HIGHEST = 50.0
"""Hz; what the seat can change, and more than the driver feels."""
SAME = Entry("driver moves as much as the floor", GREY, width=1.0)
NOTE = (
    f"Drawn where the floor has power ({POWER:g} of its highest density or more) and explains most of the driver's"
    f" motion (coherence {TRUSTED:g} or more)."
)


def plot_psd(shown: Shown) -> Figure:
    """Return the power spectral density of the driver's acceleration, run by run, with the floor's."""
    groups: dict[bytes, list[Run]] = {}
    for run in shown.runs:
        groups.setdefault(run.history["floor_acceleration"].tobytes(), []).append(run)
    names = [distinguish_runs(group, shown.runs)[0] for group in groups.values()] if len(groups) > 1 else [""]
    floors = [
        Entry(f"floor: {name}".removesuffix(": "), f"{0.7 - 0.5 * k / len(names):.2f}", dashes, 2.2)
        for k, (name, dashes) in enumerate(zip(names, cycle(DASHES), strict=False))
    ]
    drivers = shown.looks if len(shown.runs) > 1 else [shown.looks[0]._replace(label="driver")]
    found = [_estimate(group[0], "floor_acceleration") for group in groups.values()]
    found += [_estimate(run, "driver_acceleration") for run in shown.runs]
    first = find_first(found)
    legend = [] if find_problem(found, HIGHEST) else [*drivers, *floors]
    title = f"Driver acceleration over frequency: {shown.title}"
    figure, axes = _make_page(title, state_method(first) + shown.omission, legend, (first, HIGHEST))
    axes.set_ylabel("power density [(m/s²)²/Hz]")
    draw_densities(axes, found, [*floors, *drivers], HIGHEST)
    return style.name_coincident(figure)


def plot_transmissibility(shown: Shown) -> Figure:
    """Return the magnitude of the transmissibility from floor to driver where it can be trusted."""
    gains = [_estimate_gain(run) for run in shown.runs]
    places, values = (np.concatenate([each[k] for each in gains]) for k in (0, 1))
    inside = np.isfinite(values) & (values > 0)
    places, known = places[inside], values[inside]
    resolution = max((frequency[1] - frequency[0] for frequency, _, _ in gains if len(frequency)), default=np.inf)
    lines = f" Lines up to {resolution:.2g} Hz apart." * bool(known.size)
    looks = shown.looks if len(shown.runs) > 1 else [shown.looks[0]._replace(label="the run")]
    legend = [*looks, SAME] if known.size else []
    title = f"Transmissibility, floor to driver: {shown.title}"
    ends = (float(places.min()), min(HIGHEST, 1.1 * float(places.max()))) if known.size else (resolution, HIGHEST)
    figure, axes = _make_page(title, NOTE + lines + shown.omission, legend, ends)
    axes.set_ylabel("|driver / floor| [-]")
    if not known.size:
        style.explain_empty(axes, "; ".join(dict.fromkeys(problem for _, _, problem in gains)))
        return figure
    axes.axhline(1.0, color=SAME.colour, linewidth=SAME.width, zorder=1)
    axes.set_yscale("log")
    for (frequency, gain, _), look in zip(gains, looks, strict=True):
        style.draw_line(axes, frequency, gain, look)
    style.scale_log(axes, "y", min(0.5, float(known.min())) / 1.2, max(1.0, float(known.max())) * 1.2)
    return style.name_coincident(figure)


def _make_page(title: str, note: str, legend: Sequence[Entry], ends: tuple[float, float]) -> tuple[Figure, Axes]:
    figure, [[axes]] = style.make_page(title, note, Grid((2.9,)), legend)
    style.scale_frequency_axis(axes, *ends)
    return figure, axes


def _estimate(run: Run, channel: str) -> tuple[Array, Array]:
    return estimate_density(run.history.step, [run.history[channel]])


def _estimate_gain(run: Run) -> tuple[Array, Array, str]:
    """Return frequency and gain of a run, NaN where it cannot be trusted, and why that would be everywhere."""
    floor, driver = run.history["floor_acceleration"], run.history["driver_acceleration"]
    try:
        known = trusted_gain(floor, driver, 1 / run.history.step, HIGHEST)
    except InputError as error:
        return np.empty(0), np.empty(0), str(error)
    problem = f"the floor explains less than {TRUSTED:g} of the driver's motion" if np.any(floor) else "no floor motion"
    return *known, problem
