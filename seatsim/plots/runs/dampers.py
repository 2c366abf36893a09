"""Loops of the dampers of a result from sine tests, and the samples of a run between them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from seatsim.dampers.base import DamperSpecification
from seatsim.kernel.generic import DamperModel
from seatsim.metrics.motion import rms
from seatsim.plots import style
from seatsim.plots.loops import SIGNS, Family, draw_samples, make_loop_page
from seatsim.plots.runs.looks import name_variant
from seatsim.plots.style import COLOURS, Entry, Grid
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.schema.arrays import Array
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


class _InstalledDamper(NamedTuple):
    """A damper with its temperature factors, the actuator's largest current in A, and the runs that use it."""

    record: DamperModel
    factors: TemperatureFactors
    max_current: float
    runs: list[Run]

    def loop(self, amplitude: float, current: float, temperature: float) -> SineTest:
        """Return a cycle of a sine test at `FREQUENCY`; amplitude in m, current in A, temperature in degC.

        Raises:
            RunError: the damper's state runs away.
        """
        return sine_test(self.record, amplitude, FREQUENCY, current, temperature, self.factors)

    @property
    def name(self) -> str:
        """Name of the model."""
        return name_of("damper", type(self.record))


def plot_damper_loops(runs: Sequence[Run]) -> Figure:
    """Return the loops of each distinct damper by current, and by temperature, where these change its force."""
    dampers = find_dampers(runs)
    amplitude = choose_amplitude(runs)
    users = [_name_users(damper, runs) * (len(dampers) > 1) for damper in dampers[:MOST]]
    named = zip(dampers, users, strict=False)
    families = [family for damper, by in named for family in _make_families(damper, damper.name + by, amplitude)]
    note = f"Sine test, amplitude {1e3 * amplitude:g} mm, frequency {FREQUENCY:g} Hz."
    if len(dampers) > MOST:
        note += f" {MOST} of {len(dampers)} dampers are shown."
    names = ", ".join(dict.fromkeys(damper.name for damper in dampers))
    return make_loop_page(f"Damper loops: {names}", note, families).figure


def find_dampers(runs: Iterable[Run]) -> list[_InstalledDamper]:
    """Return the distinct dampers of some runs in their order; equal parameters make one damper of them."""
    found: dict[str, _InstalledDamper] = {}
    for run in runs:
        choice, current = run.scenario.damper, run.scenario.coil.max_current
        damper = _InstalledDamper(choice.record, choice.factors, current, [])
        # By text: equal values of two classes of dampers are equal tuples.
        found.setdefault(repr(damper), damper).runs.append(run)
    return list(found.values())


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
    run = runs[0]
    [damper], temperature = find_dampers([run]), _start_temperature(run)
    velocity = _stroke_ratio(run) * run.history["suspension_velocity"]
    amplitude = max(_SLOWEST, float(np.max(np.abs(velocity)))) / (2 * math.pi * FREQUENCY)
    currents = (0.0, damper.max_current)
    tests = _drop_equal((f"sine test at {i:g} A", damper.loop(amplitude, i, temperature)) for i in currents)
    changes = float(np.ptp(run.history["coil_current"])) > 0
    looks = [Entry(name, colour, width=1.8) for (name, _), colour in zip(tests, ("0.5", "black"), strict=False)]
    dots = Entry(
        "the run" + " (colour: current)" * changes,
        style.sample_colours("viridis", 3)[1] if changes else COLOURS[0],
        "none",
        mark="o",
    )
    areas = Entry("the damper gives energy back", style.AREA, width=8)
    note = f"Sine tests at {temperature:g} °C, amplitude {1e3 * amplitude:.3g} mm, {FREQUENCY:g} Hz. {SIGNS}"
    note += f" The first of {len(runs)} runs." * (len(runs) > 1)
    title = f"Damper at work: {naming.make_title([run])}"
    figure, [[axes]] = style.make_page(title, note, Grid((3.3,), right=1.0), [dots, *looks, areas])
    for look, (_, test) in zip(looks, tests, strict=True):
        style.draw_line(axes, test.velocity, test.force, look).set_zorder(0.9)
    _draw_samples(axes, velocity, run, changes)
    _shade_active_quadrants(axes)
    axes.set(xlabel="damper velocity [m/s]", ylabel="damper force [N]")
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


def _name_users(damper: _InstalledDamper, runs: Sequence[Run]) -> str:
    """Return in brackets what the runs with a damper share and others have not, or their variants."""
    shared, _ = naming.distinguish_runs(damper.runs, runs)
    return f" ({shared or name_some(list(dict.fromkeys(map(name_variant, damper.runs))), 1)})"


def _make_families(damper: _InstalledDamper, called: str, amplitude: float) -> Iterator[Family]:
    start, most, fades = _start_temperature(damper.runs[0]), damper.max_current, any(damper.factors[:3])
    currents = [share * most for share in SHARES]
    by_current = _drop_equal((f"{current:g} A", damper.loop(amplitude, current, start)) for current in currents)
    # Where no current changes it, the loops by temperature show all.
    if len(by_current) > 1 or not fades:
        yield Family(f"{called} at {start:g} °C", "current", by_current)
    if fades:
        temperatures = _choose_temperatures(damper)
        by_heat = _drop_equal((f"{value:g} °C", damper.loop(amplitude, most, value)) for value in temperatures)
        yield Family(f"{called} at {most:g} A" if len(by_current) > 1 else called, "temperature", by_heat, "plasma")


def _choose_temperatures(damper: _InstalledDamper) -> list[float]:
    """Return the temperatures of the runs where these differ, else those between which the model holds."""
    used = sorted({_start_temperature(run) for run in damper.runs})
    if len(used) > 1:
        return used
    specification: DamperSpecification = specification_of(type(damper.record))
    low, high = specification.temperatures
    return [low, 0.5 * (low + high), high]


def _draw_samples(axes: Axes, velocity: Array, run: Run, changes: bool) -> None:
    """Draw samples of a run, coloured by its current where that changes, up to what it seldom exceeds."""
    every = -(-len(velocity) // _MOST_SAMPLES)
    force, current = run.history["damper_force"][::every], run.history["coil_current"]
    if changes:
        drawn = draw_samples(axes, velocity[::every], force, current[::every], float(np.quantile(current, _USUAL)))
        style.add_colour_bar(axes, drawn, "coil current [A]", extend="max")
    else:
        axes.scatter(velocity[::every], force, s=6, color=COLOURS[0], linewidths=0, rasterized=True)


def _shade_active_quadrants(axes: Axes) -> None:
    """Shade where force and velocity differ in sign: there a damper can only return what it stored."""
    right, top = (max(abs(end) for end in ends) for ends in (axes.get_xlim(), axes.get_ylim()))
    axes.set(xlim=(-right, right), ylim=(-top, top))
    for corner in ((-right, 0.0), (0.0, -top)):
        axes.add_patch(Rectangle(corner, right, top, facecolor=style.AREA, zorder=0))
