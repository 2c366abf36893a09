"""Force-velocity and force-displacement loops of the dampers of a result, from sine tests."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.dampers.base import DamperSpecification
from seatsim.kernel.generic import DamperModel
from seatsim.metrics.motion import rms
from seatsim.plots import labels, style
from seatsim.plots.runs import naming
from seatsim.plots.style import Entry, Grid
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.schema.registry import name_of, specification_of
from seatsim.simulation.damper_bench import SineTest, sine_test
from seatsim.simulation.result import Run

FREQUENCY = 1.5
"""Hz; near the resonance of a seat suspension, where its damper works most."""
SMALLEST = 0.001
"""m; least amplitude of a test."""
AT_REST = 0.01
"""m; amplitude of a test where nothing moves."""
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Currents of the loops over the actuator's largest."""
MOST = 4
"""Most dampers in one picture."""


class InstalledDamper(NamedTuple):
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
    """Return the loops of each distinct damper by current, and by temperature where that plays a part."""
    dampers = find_dampers(runs)
    rows = [row for damper in dampers[:MOST] for row in _make_rows(damper, len(dampers) > 1)]
    amplitude = choose_amplitude(runs)
    note = f"Sine test, amplitude {1e3 * amplitude:g} mm, frequency {FREQUENCY:g} Hz."
    if len(dampers) > MOST:
        note += f" {MOST} of {len(dampers)} dampers are shown."
    grid = Grid(heights=(2.9,) * len(rows), columns=2, right=1.35, top=0.35, gap=(0.35, 0.95))
    names = ", ".join(dict.fromkeys(damper.name for damper in dampers))
    page = style.make_page(f"Damper loops: {labels.clean_text(names, labels.LONGEST_TITLE)}", note, grid)
    for panels, row in zip(page.rows, rows, strict=True):
        _draw_row(panels, row, amplitude)
    return page.figure


def find_dampers(runs: Iterable[Run]) -> list[InstalledDamper]:
    """Return the distinct dampers of some runs in their order; equal parameters make one damper of them."""
    found: dict[str, InstalledDamper] = {}
    for run in runs:
        choice, current = run.scenario.damper, run.scenario.coil.max_current
        damper = InstalledDamper(choice.record, choice.factors, current, [])
        # By text: equal values of two classes of dampers are equal tuples.
        found.setdefault(repr(damper), damper).runs.append(run)
    return list(found.values())


def choose_amplitude(runs: Iterable[Run]) -> float:
    """Return the amplitude in m of the sine with the largest RMS damper stroke of the runs, to one digit."""
    strokes = [stroke_ratio(run) * rms(run.history["suspension_displacement"]) for run in runs]
    amplitude = math.sqrt(2) * max(strokes)
    if amplitude == 0.0:
        return AT_REST
    digit = 10.0 ** math.floor(math.log10(amplitude))
    return max(SMALLEST, round(amplitude / digit) * digit)


def stroke_ratio(run: Run) -> float:
    """Return the damper's stroke over the suspension's displacement."""
    return run.scenario.plant.damper_ratio if run.scenario.plant else 1.0


def start_temperature(run: Run) -> float:
    """Return the temperature in degC at which a run begins."""
    stated = run.scenario.temperature
    return stated.start if isinstance(stated, Thermal) else stated


class _LoopRow(NamedTuple):
    """Two panels: their title, that of the legend, and label, current, temperature, colour of each loop."""

    damper: InstalledDamper
    title: str
    legend: str
    loops: list[tuple[str, float, float, str]]


def _make_rows(damper: InstalledDamper, several: bool) -> list[_LoopRow]:
    start = start_temperature(damper.runs[0])
    called = f"{damper.name} ({naming.label_runs(damper.runs)[0]})" if several else damper.name
    currents = [share * damper.max_current for share in SHARES]
    by_current = [
        (f"{current:g} A", current, start, colour)
        for current, colour in zip(currents, style.sample_colours("viridis", len(currents)), strict=True)
    ]
    rows = [_LoopRow(damper, f"{called} at {start:g} °C", "current", by_current)]
    if any(damper.factors[:3]):
        temperatures = _choose_temperatures(damper)
        by_temperature = [
            (f"{value:g} °C", damper.max_current, value, colour)
            for value, colour in zip(temperatures, style.sample_colours("plasma", len(temperatures)), strict=True)
        ]
        rows.append(_LoopRow(damper, f"{called} at {damper.max_current:g} A", "temperature", by_temperature))
    return rows


def _choose_temperatures(damper: InstalledDamper) -> list[float]:
    """Return the temperatures of the runs where these differ, else those between which the model holds."""
    used = sorted({start_temperature(run) for run in damper.runs})
    if len(used) > 1:
        return used
    specification: DamperSpecification = specification_of(type(damper.record))
    low, high = specification.temperatures
    return [low, 0.5 * (low + high), high]


def _draw_row(panels: Sequence[Axes], row: _LoopRow, amplitude: float) -> None:
    for name, current, temperature, colour in row.loops:
        test = row.damper.loop(amplitude, current, temperature)
        look = Entry(name, colour, width=1.6)
        style.draw_line(panels[0], test.velocity, test.force, look)
        style.draw_line(panels[1], 1e3 * test.displacement, test.force, look)
    panels[0].set_title(row.title, loc="left", fontsize=10.5)
    panels[0].set_xlabel("velocity [m/s]")
    panels[1].set_xlabel("displacement [mm]")
    panels[0].set_ylabel("damper force [N]")
    panels[1].set_ylim(panels[0].get_ylim())
    panels[1].tick_params(labelleft=False)
    style.draw_legend_beside(panels[1], row.legend)
