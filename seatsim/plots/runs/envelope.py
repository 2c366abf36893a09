"""The damper's working points in a run: force over velocity, between its curves at no and at full current."""

from __future__ import annotations

import math

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from seatsim.plots import style
from seatsim.plots.runs import naming
from seatsim.plots.runs.loops import FREQUENCY, find_dampers, start_temperature, stroke_ratio
from seatsim.plots.style import Entry, Grid
from seatsim.schema.arrays import Array
from seatsim.simulation.result import Run

MOST_SAMPLES = 6000
"""Samples that are drawn; more hide each other, and take seconds to draw."""
SLOWEST = 0.01
"""m/s; least peak velocity of the damper's curves."""


def plot_force_velocity(run: Run) -> Figure:
    """Return delivered force over damper velocity, coloured by coil current, with the damper's own limits.

    The limits are the damper's loops in a sine test at no and at the actuator's largest current, at the peak velocity
    of the run.

    Raises:
        RunError: a sine test cannot be carried to its end.
    """
    [damper], temperature = find_dampers([run]), start_temperature(run)
    most = damper.max_current
    off, on = Entry("damper at 0 A", "0.45", width=1.8), Entry(f"damper at {most:g} A", "black", width=1.8)
    velocity = stroke_ratio(run) * run.history["suspension_velocity"]
    amplitude = max(SLOWEST, float(np.max(np.abs(velocity)))) / (2 * math.pi * FREQUENCY)
    note = (
        f"Dots: the run. Curves: sine test at {temperature:g} °C, amplitude {1e3 * amplitude:.3g} mm,"
        f" frequency {FREQUENCY:g} Hz. Shaded: the damper gives energy back."
    )
    page = style.make_page(f"Damper at work: {naming.make_title([run])}", note, Grid((4.8,), right=1.3), [off, on])
    axes = page.rows[0][0]
    _draw_samples(axes, velocity, run)
    for look, current in ((off, 0.0), (on, most)):
        test = damper.loop(amplitude, current, temperature)
        style.draw_line(axes, test.velocity, test.force, look)
    _shade_active_quadrants(axes)
    axes.set_xlabel("damper velocity [m/s]")
    axes.set_ylabel("damper force [N]")
    return page.figure


def _draw_samples(axes: Axes, velocity: Array, run: Run) -> None:
    every = -(-len(velocity) // MOST_SAMPLES)
    force, current = run.history["damper_force"][::every], run.history["coil_current"][::every]
    dots = axes.scatter(
        velocity[::every], force, c=current, s=7, linewidths=0, cmap=colormaps["viridis"], vmin=0.0,
        vmax=run.scenario.coil.max_current,
    )  # fmt: skip
    axes.figure.colorbar(dots, cax=style.add_axes_beside(axes, 0.03, 0.02), label="coil current [A]")


def _shade_active_quadrants(axes: Axes) -> None:
    """Shade where force and velocity differ in sign: there a damper can only return what it stored."""
    right, top = (max(abs(end) for end in ends) for ends in (axes.get_xlim(), axes.get_ylim()))
    axes.set_xlim(-right, right)
    axes.set_ylim(-top, top)
    for corner in ((-right, 0.0), (0.0, -top)):
        axes.add_patch(Rectangle(corner, right, top, facecolor="0.95", zorder=0))
