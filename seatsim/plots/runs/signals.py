"""Channels of runs over time, close up, and over frequency: densities, transmissibility."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from textwrap import fill

import numpy as np
from matplotlib.figure import Figure

from seatsim.metrics.spectra import PER_OCTAVE, POWER, TRUSTED, estimate_density, trusted_gain
from seatsim.plots import style
from seatsim.plots.densities import draw_densities, find_first, find_problem, state_method
from seatsim.plots.runs.looks import Shown, choose_extremes
from seatsim.plots.style import COLOURS, DARK, DASHES, GREY, Entry, Grid
from seatsim.plots.thinning import Window, find_loudest, spread_evenly, thin_line
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.printing import describe_channel
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.naming import distinguish_runs
from seatsim.simulation.result import UNITS, Run

CLOSE_UP = 6.0
"""Length in s of the window: about nine swings of a seat suspension."""
RASTER = 0.1
"""Raster in s on which the window begins, the digits that the note has."""
LETTERS = 13
"""Letters of a line of a label beside a panel that is this low."""
NEAR = 0.2
"""Share of an end stop's distance that the motion must reach for the stop to be drawn; else it would look flat."""
CHANNELS = ("driver_acceleration", "suspension_displacement", "damper_force", "coil_current")
_TARGETS = {"damper_force": "wanted_force", "coil_current": "current_command"}
"""Channels that others should follow."""
_UPON_EACH_OTHER = ((3.2, 0.5), (2.1, 0.75), (1.1, 1.0))
"""Widths and opacities of runs that agree for much of the time, the lowest first, so that all are seen."""
RUN = Entry("the run", COLOURS[0], width=1.1)
_TARGET = Entry("wanted force, commanded current", COLOURS[5], "-", 2.0, 0.6)
LIMIT = Entry("end stop begins", DARK, ":")
HIGHEST = 50.0
"""Hz; what the seat can change, and more than the driver feels."""
GRID = Grid((2.9,))
SAME = Entry("driver moves as much as the floor", GREY, width=1.0)
NOTE = (
    f"Drawn where the floor has power ({POWER:g} of its highest density or more) and explains most of the driver's"
    f" motion (coherence {TRUSTED:g} or more); a line ends where this fails."
)


def plot_time_histories(shown: Shown) -> Figure:
    """Return driver acceleration, suspension displacement, damper force and current in one window.

    It is that with the largest RMS of the driver's acceleration in the first run that moves, within all runs. What was
    wanted and commanded is drawn for a single run only; of many runs those at the ends are drawn.
    """
    single, shown = len(shown.runs) == 1, choose_extremes(shown)
    k = int(np.argmax([np.any(run.history["driver_acceleration"]) for run in shown.runs]))
    first, name, ends = shown.runs[k].history, shown.looks[k].label, [run.history["time"][-1] for run in shown.runs]
    window = find_loudest(first["driver_acceleration"][first["time"] <= min(ends)], first.step, CLOSE_UP, RASTER)
    note = f"{window}, where the driver's RMS acceleration is largest{f' in “{name}”' * (not single)}."
    if window.start == 0.0 and window.end >= max(ends):
        note = "The whole run."
    if not np.any(first["driver_acceleration"]):
        window, note = Window(0.0, min(*ends, CLOSE_UP)), "At rest."
    # A law that states a current wants no force.
    target = _TARGET if np.isfinite(first["wanted_force"]).any() else _TARGET._replace(label="commanded current")
    limits, looks = _find_limits(shown.runs), [RUN] if single else _lay_upon_each_other(shown.looks)
    legend = [*looks, *[target] * single, *[LIMIT] * bool(limits)]
    grid = Grid((1.3,) * len(CHANNELS), left=1.12, gap=(0.0, 0.3))
    page = style.make_page(f"Time histories: {shown.title}", note + shown.omission, grid, legend)
    for [axes], channel in zip(page.rows, CHANNELS, strict=True):
        lines = [(run, channel, look) for run, look in zip(shown.runs, looks, strict=True)]
        if single and channel in _TARGETS and np.isfinite(first[_TARGETS[channel]]).any():
            lines.insert(0, (shown.runs[0], _TARGETS[channel], target))
        for run, name, look in lines:
            part, factor = window.part(run.history.step), describe_channel(name, UNITS[name]).factor
            style.draw_line(axes, *thin_line(run.history["time"][part], factor * run.history[name][part]), look)
        for limit in limits if channel == "suspension_displacement" else ():
            axes.axhline(1e3 * limit, color=LIMIT.colour, linestyle=":", linewidth=LIMIT.width)
        axes.set(xlim=window, ylabel=fill(describe_channel(channel, UNITS[channel]).axis, LETTERS))
        axes.yaxis.set_label_coords(-0.5 / grid.width, 0.5)
        axes.tick_params(labelbottom=axes is page.rows[-1][0])
    axes.set_xlabel("time [s]")
    return style.name_coincident(page.figure)


def _lay_upon_each_other(looks: Sequence[Entry]) -> list[Entry]:
    """Return looks of which the thin upper ones leave the wide lower ones to be seen."""
    ways = spread_evenly(_UPON_EACH_OTHER, len(looks))
    return [look._replace(dashes="-", width=way[0], alpha=way[1]) for look, way in zip(looks, ways, strict=True)]


def _find_limits(runs: Sequence[Run]) -> list[float]:
    """Return the displacements in m of the end stops that the runs come near to."""
    peak = max(float(np.max(np.abs(run.history["suspension_displacement"]))) for run in runs)
    seats = (augment_plant(run.scenario.effects, run.scenario.plant) for run in runs if run.scenario.plant)
    stated = {limit for seat in seats for limit in seat.end_stops or ()}
    return sorted(limit for limit in stated if abs(limit) * NEAR <= peak)


def plot_psd(shown: Shown) -> Figure:
    """Return the power spectral density of the driver's acceleration, run by run, with the floor's."""
    groups: dict[bytes, list[Run]] = {}
    for run in shown.runs:
        groups.setdefault(run.history["floor_acceleration"].tobytes(), []).append(run)
    names = [f"floor: {distinguish_runs(group, shown.runs)[0]}" for group in groups.values()]
    floors = [Entry("floor", "0.7", width=2.2)]
    if len(names) > 1:
        floors = [Entry(name, GREY, dashes, 2.2) for name, dashes in zip(names, cycle(DASHES), strict=False)]
    drivers = shown.looks if len(shown.runs) > 1 else [shown.looks[0]._replace(label="driver")]
    signals = [(group[0].history, "floor_acceleration") for group in groups.values()]
    signals += [(run.history, "driver_acceleration") for run in shown.runs]
    found = [estimate_density(history.step, [history[channel]]) for history, channel in signals]
    first, legend = find_first(found), [] if find_problem(found, HIGHEST) else [*drivers, *floors]
    note = (state_method(first) if legend else "There is no density to show.") + shown.omission
    figure, [[axes]] = style.make_page(f"Driver acceleration over frequency: {shown.title}", note, GRID, legend)
    style.scale_frequency_axis(axes, first, HIGHEST)
    axes.set_ylabel("power density [(m/s²)²/Hz]")
    draw_densities(axes, found, [*floors, *drivers], HIGHEST)
    return style.name_coincident(figure)


def plot_transmissibility(shown: Shown) -> Figure:
    """Return the magnitude of the transmissibility from floor to driver where it can be trusted."""
    gains = [_estimate_gain(run) for run in shown.runs]
    places, values = (np.concatenate([each[k] for each in gains]) for k in (0, 1))
    places, known = (each[np.isfinite(values) & (values > 0)] for each in (places, values))
    resolution = max((frequency[1] - frequency[0] for frequency, _, _ in gains if len(frequency)), default=np.inf)
    looks = shown.looks if len(shown.runs) > 1 else [shown.looks[0]._replace(label="the run")]
    lines = f" Lines up to {resolution:.2g} Hz apart, averaged over 1/{PER_OCTAVE} octave." * bool(known.size)
    title, note = f"Transmissibility, floor to driver: {shown.title}", NOTE + lines + shown.omission
    figure, [[axes]] = style.make_page(title, note, GRID, [*looks, SAME] if known.size else [])
    axes.set_ylabel("|driver / floor| [-]")
    if not known.size:
        style.scale_frequency_axis(axes, resolution, HIGHEST)
        style.explain_empty(axes, "; ".join(dict.fromkeys(problem for _, _, problem in gains)))
        return figure
    style.scale_frequency_axis(axes, float(places.min()), min(HIGHEST, 1.1 * float(places.max())))
    axes.axhline(1.0, color=SAME.colour, linewidth=SAME.width, zorder=1)
    axes.set_yscale("log")
    for (frequency, gain, _), look in zip(gains, looks, strict=True):
        style.draw_line(axes, frequency, gain, look)
    # A curve lies between numbers of the axis, from which it is read.
    top = next((tick for tick in (1, 2, 5, 10, 20, 50) if tick >= known.max()), float(known.max()))
    low = next((tick for tick in (0.5, 0.2, 0.1, 0.05, 0.02) if tick <= known.min()), float(known.min()))
    style.scale_log(axes, "y", low / 1.2, 1.1 * top)
    return style.name_coincident(figure)


def _estimate_gain(run: Run) -> tuple[Array, Array, str]:
    """Return frequency and gain of a run, NaN where it cannot be trusted, and why that would be everywhere."""
    floor, driver = run.history["floor_acceleration"], run.history["driver_acceleration"]
    try:
        known = trusted_gain(floor, driver, 1 / run.history.step, HIGHEST)
    except InputError as error:
        return np.empty(0), np.empty(0), str(error)
    problem = f"the floor explains less than {TRUSTED:g} of the driver's motion" if np.any(floor) else "no floor motion"
    return *known, problem
