"""The damper of a run at work: the samples of a run between the loops of two sine tests."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from seatsim.plots import style
from seatsim.plots.loops import SIGNS
from seatsim.plots.style import COLOURS, Entry, Grid
from seatsim.rig.temperature import Thermal
from seatsim.simulation import naming
from seatsim.simulation.damper_bench import sine_test
from seatsim.simulation.result import Run

FREQUENCY = 1.5
"""Hz; near the resonance of a seat suspension, where its damper works most."""
_MOST_SAMPLES = 3000
"""Samples of a run that are drawn; more hide each other."""
_USUAL = 0.99
"""Share of a run for which the current is within the scale of its colours."""
_SLOWEST = 0.01
"""m/s; least peak velocity of the curves beside a run."""


def plot_force_velocity(runs: Sequence[Run]) -> Figure:
    """Return the delivered force of a run over damper velocity, coloured by the current, with limits.

    It is the run whose current varies the most, of equals the first. The limits are the damper's loops in a sine test
    at no and at the actuator's largest current, at the peak velocity of the run.

    Raises:
        RunError: a sine test cannot be carried to its end.
    """
    run = max(runs, key=lambda run: float(np.std(run.history["coil_current"])))
    damper, stated = run.scenario.damper, run.scenario.temperature
    temperature = stated.start if isinstance(stated, Thermal) else stated
    stroke_ratio = run.scenario.plant.damper_ratio if run.scenario.plant else 1.0
    velocity = stroke_ratio * run.history["suspension_velocity"]
    force, current = run.history["damper_force"], run.history["coil_current"]
    amplitude = max(_SLOWEST, float(np.max(np.abs(velocity)))) / (2 * math.pi * FREQUENCY)
    currents = {0.0: "0.5", run.scenario.coil.max_current: "black"}
    tests = [sine_test(damper.record, amplitude, FREQUENCY, i, temperature, damper.factors) for i in currents]
    looks = [Entry(f"sine test at {i:g} A, {temperature:.3g} °C", c, width=1.8) for i, c in currents.items()]
    changes = float(np.ptp(current)) > 0
    colour = style.sample_colours("viridis", 3)[1] if changes else COLOURS[0]
    warmth = dict.fromkeys(f"{end(run.history['damper_temperature']):.3g}" for end in (np.min, np.max))
    sample = Entry(f"run at {' to '.join(warmth)} °C{' (colour: current)' * changes}", colour, "none", mark="o")
    areas = Entry("the damper gives energy back", style.AREA, width=8)
    note = f"Sine tests: amplitude {1e3 * amplitude:.3g} mm, {FREQUENCY:g} Hz. {SIGNS}"
    note += f" One of {len(runs)} runs: the one whose current varies the most." * (len(runs) > 1 and changes)
    note += naming.explain_doubt([run])
    title = f"Damper at work: {naming.make_title([run])}"
    figure, [[axes]] = style.make_page(title, note, Grid((3.3,), right=1.0), [sample, *looks, areas])
    for look, test in zip(looks, tests, strict=True):
        style.draw_line(axes, test.velocity, test.force, look).set_zorder(0.9)
    part = np.arange(0, len(velocity), -(-len(velocity) // _MOST_SAMPLES))
    # Large currents on top.
    part = part[np.argsort(current[part], kind="stable")]
    drawn = axes.scatter(velocity[part], force[part], 6, color=COLOURS[0], linewidths=0, rasterized=True)
    if changes:
        drawn.set(array=current[part], cmap=style.shade("viridis"), clim=(0.0, np.quantile(current, _USUAL) or 1.0))
        style.add_colour_bar(axes, drawn, "coil current [A]", extend="max")
    # Where force and velocity differ in sign a damper can only return what it stored.
    right, top = (max(abs(end) for end in ends) for ends in (axes.get_xlim(), axes.get_ylim()))
    for corner in ((-right, 0.0), (0.0, -top)):
        axes.add_patch(Rectangle(corner, right, top, facecolor=style.AREA, zorder=0))
    axes.set(xlim=(-right, right), ylim=(-top, top), xlabel="damper velocity [m/s]", ylabel="damper force [N]")
    return style.name_coincident(figure)
