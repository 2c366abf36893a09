"""Loops of the dampers of a result from sine tests, and the samples of a run between them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from seatsim.metrics.motion import rms
from seatsim.plots import style
from seatsim.plots.loops import SIGNS, Family, draw_samples, make_loop_page
from seatsim.plots.runs.looks import name_variant
from seatsim.plots.style import COLOURS, Entry, Grid
from seatsim.rig.temperature import Thermal
from seatsim.schema.registry import name_of, specification_of
from seatsim.schema.text import name_some
from seatsim.simulation import naming
from seatsim.simulation.damper_bench import SineTest, sine_test
from seatsim.simulation.result import Run

FREQUENCY = 1.5
"""Hz; near the resonance of a seat suspension, where its damper works most."""
SMALLEST, AT_REST = 0.001, 0.01
"""m; least amplitude of a test, and that where nothing moves."""
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Currents of the loops over the actuator's largest."""
MOST = 4
"""Most dampers in one picture."""
_MOST_SAMPLES = 3000
"""Samples of a run that are drawn; more hide each other."""
_USUAL = 0.99
"""Share of a run for which the current is within the scale of its colours."""
_SLOWEST = 0.01
"""m/s; least peak velocity of the curves beside a run."""


def plot_damper_loops(runs: Sequence[Run]) -> Figure:
    """Return the loops of each distinct damper by current, and by temperature, where these change its force."""
    groups, amplitude, families = group_by_damper(runs), choose_amplitude(runs), list[Family]()
    for group in groups[:MOST]:
        by = ""
        if len(groups) > 1:
            # What the runs with a damper share and others have not, or their variants.
            shared, _ = naming.distinguish_runs(group, runs)
            by = f" ({shared or name_some(list(dict.fromkeys(map(name_variant, group))), 1)})"
        families += _make_families(group, _name_model(group[0]) + by, amplitude)
    note = f"Sine test, amplitude {1e3 * amplitude:g} mm, frequency {FREQUENCY:g} Hz."
    note += f" {MOST} of {len(groups)} dampers are shown." if len(groups) > MOST else ""
    names = ", ".join(dict.fromkeys(_name_model(group[0]) for group in groups))
    return make_loop_page(f"Damper loops: {names}", note, families).figure


def group_by_damper(runs: Iterable[Run]) -> list[list[Run]]:
    """Return the runs of each distinct damper in their order; equal parameters make one damper of several."""
    found: dict[str, list[Run]] = {}
    for run in runs:
        choice, current = run.scenario.damper, run.scenario.coil.max_current
        # By text: equal values of two classes of dampers are equal tuples.
        found.setdefault(repr((choice.record, choice.factors, current)), []).append(run)
    return list(found.values())


def _name_model(run: Run) -> str:
    return name_of("damper", type(run.scenario.damper.record))


def _test(run: Run, amplitude: float, current: float, temperature: float) -> SineTest:
    """Return a cycle of a sine test of the damper of a run at `FREQUENCY`; amplitude in m, current in A, degC.

    Raises:
        RunError: the damper's state runs away.
    """
    damper = run.scenario.damper
    return sine_test(damper.record, amplitude, FREQUENCY, current, temperature, damper.factors)


def choose_amplitude(runs: Iterable[Run]) -> float:
    """Return the amplitude in m of the sine with the largest RMS damper stroke of the runs, to one digit."""
    strokes = [_stroke_ratio(run) * rms(run.history["suspension_displacement"]) for run in runs]
    amplitude = math.sqrt(2) * max(strokes)
    if amplitude == 0.0:
        return AT_REST
    digit = 10.0 ** math.floor(math.log10(amplitude))
    return max(SMALLEST, round(amplitude / digit) * digit)


def plot_force_velocity(runs: Sequence[Run]) -> Figure:
    """Return the first run's delivered force over damper velocity, coloured by a current that changes, with limits.

    The limits are the damper's loops in a sine test at no and at the actuator's largest current, at the peak velocity
    of the run.

    Raises:
        RunError: a sine test cannot be carried to its end.
    """
    run, most, temperature = runs[0], runs[0].scenario.coil.max_current, _start_temperature(runs[0])
    velocity = _stroke_ratio(run) * run.history["suspension_velocity"]
    force, current = run.history["damper_force"], run.history["coil_current"]
    amplitude = max(_SLOWEST, float(np.max(np.abs(velocity)))) / (2 * math.pi * FREQUENCY)
    tests = _drop_equal((f"sine test at {i:g} A", _test(run, amplitude, i, temperature)) for i in (0.0, most))
    looks = [Entry(name, colour, width=1.8) for (name, _), colour in zip(tests, ("0.5", "black"), strict=False)]
    changes = float(np.ptp(current)) > 0
    colour = style.sample_colours("viridis", 3)[1] if changes else COLOURS[0]
    dots = Entry("the run" + " (colour: current)" * changes, colour, "none", mark="o")
    areas = Entry("the damper gives energy back", style.AREA, width=8)
    note = f"Sine tests at {temperature:g} °C, amplitude {1e3 * amplitude:.3g} mm, {FREQUENCY:g} Hz. {SIGNS}"
    note += f" The first of {len(runs)} runs." * (len(runs) > 1)
    title = f"Damper at work: {naming.make_title([run])}"
    figure, [[axes]] = style.make_page(title, note, Grid((3.3,), right=1.0), [dots, *looks, areas])
    for look, (_, test) in zip(looks, tests, strict=True):
        style.draw_line(axes, test.velocity, test.force, look).set_zorder(0.9)
    part = slice(None, None, -(-len(velocity) // _MOST_SAMPLES))
    if changes:
        drawn = draw_samples(axes, velocity[part], force[part], current[part], float(np.quantile(current, _USUAL)))
        style.add_colour_bar(axes, drawn, "coil current [A]", extend="max")
    else:
        axes.scatter(velocity[part], force[part], s=6, color=COLOURS[0], linewidths=0, rasterized=True)
    # Where force and velocity differ in sign a damper can only return what it stored.
    right, top = (max(abs(end) for end in ends) for ends in (axes.get_xlim(), axes.get_ylim()))
    for corner in ((-right, 0.0), (0.0, -top)):
        axes.add_patch(Rectangle(corner, right, top, facecolor=style.AREA, zorder=0))
    axes.set(xlim=(-right, right), ylim=(-top, top), xlabel="damper velocity [m/s]", ylabel="damper force [N]")
    return figure


def _drop_equal(tests: Iterable[tuple[str, SineTest]]) -> list[tuple[str, SineTest]]:
    """Return named loops without those that repeat the first, as where no current changes a damper's force."""
    first, *rest = tests
    return [first, *(each for each in rest if not np.allclose(each[1].force, first[1].force))]


def _stroke_ratio(run: Run) -> float:
    """Return the damper's stroke over the suspension's displacement."""
    return run.scenario.plant.damper_ratio if run.scenario.plant else 1.0


def _start_temperature(run: Run) -> float:
    """Return the temperature in degC at which a run begins."""
    stated = run.scenario.temperature
    return stated.start if isinstance(stated, Thermal) else stated


def _make_families(group: Sequence[Run], called: str, amplitude: float) -> Iterator[Family]:
    """Yield the loops of the damper of some runs by current, and by temperature."""
    first, damper, most = group[0], group[0].scenario.damper, group[0].scenario.coil.max_current
    start, fades = _start_temperature(first), any(damper.factors[:3])
    currents = [share * most for share in SHARES]
    by_current = _drop_equal((f"{current:g} A", _test(first, amplitude, current, start)) for current in currents)
    # Where no current changes it, the loops by temperature show all.
    if len(by_current) > 1 or not fades:
        yield Family(f"{called} at {start:g} °C", "current", by_current)
    if fades:
        # The temperatures of the runs where these differ, else those between which the model holds.
        used = sorted({_start_temperature(run) for run in group})
        low, high = specification_of(type(damper.record)).temperatures
        temperatures = used if len(used) > 1 else [low, 0.5 * (low + high), high]
        by_heat = _drop_equal((f"{value:g} °C", _test(first, amplitude, most, value)) for value in temperatures)
        yield Family(f"{called} at {most:g} A" if len(by_current) > 1 else called, "temperature", by_heat, "plasma")
