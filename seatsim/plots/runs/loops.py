"""Force-velocity and force-displacement loops of the dampers of a result, from sine tests."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.dampers.base import DamperSpecification
from seatsim.metrics import rms
from seatsim.plots import labels, style
from seatsim.plots.style import Entry, Grid
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.schema.registry import name_of, specification_of
from seatsim.simulation.damper_bench import SineTest, sine_test
from seatsim.simulation.result import Run

FREQUENCY = 1.5
"""Hz; near the resonance of a seat suspension."""
SMALLEST = 0.001
"""m; least amplitude of a test."""
AT_REST = 0.01
"""m; amplitude of a test where nothing moves."""
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Currents of the loops over the actuator's largest."""
MOST = 4
"""Most dampers in one picture."""


class Specimen(NamedTuple):
    """A damper with its temperature factors, the largest current, and the runs that use it."""

    record: Any
    factors: TemperatureFactors
    max_current: float
    runs: list[Run]

    def loop(self, amplitude: float, current: float, temperature: float) -> SineTest:
        """Return a cycle at `FREQUENCY`."""
        return sine_test(self.record, amplitude, FREQUENCY, current, temperature, self.factors)

    @property
    def name(self) -> str:
        """Name of the model."""
        return name_of("damper", type(self.record))


def damper_loops(runs: Sequence[Run]) -> Figure:
    """Return the loops of each distinct damper by current, and by temperature where that plays a part."""
    dampers = specimens(runs)
    rows = [row for damper in dampers[:MOST] for row in _rows(damper, len(dampers) > 1)]
    amplitude = amplitude_of(runs)
    note = f"Sine test, amplitude {1e3 * amplitude:g} mm, frequency {FREQUENCY:g} Hz."
    if len(dampers) > MOST:
        note += f" {MOST} of {len(dampers)} dampers are shown."
    grid = Grid(heights=(2.9,) * len(rows), columns=2, right=1.35, top=0.35, gap=(0.35, 0.95))
    names = ", ".join(dict.fromkeys(damper.name for damper in dampers))
    page = style.page(f"Damper loops: {labels.clean(names, labels.LONGEST_TITLE)}", note, grid)
    for panels, row in zip(page.rows, rows, strict=True):
        _draw(panels, row, amplitude)
    return page.figure


def specimens(runs: Iterable[Run]) -> list[Specimen]:
    """Return the distinct dampers of some runs in their order."""
    found: dict[str, Specimen] = {}
    for run in runs:
        choice, current = run.scenario.damper, run.scenario.coil.max_current
        damper = Specimen(choice.record, choice.factors, current, [])
        found.setdefault(repr(damper), damper).runs.append(run)
    return list(found.values())


def amplitude_of(runs: Iterable[Run]) -> float:
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


def temperature_of(run: Run) -> float:
    """Return the temperature in degC at which a run begins."""
    stated = run.scenario.temperature
    return stated.start if isinstance(stated, Thermal) else stated


class _Row(NamedTuple):
    """Two panels: their title, that of the legend, and label, current, temperature, colour of each loop."""

    damper: Specimen
    title: str
    legend: str
    loops: list[tuple[str, float, float, str]]


def _rows(damper: Specimen, several: bool) -> list[_Row]:
    start = temperature_of(damper.runs[0])
    called = f"{damper.name} ({labels.labels(damper.runs)[0]})" if several else damper.name
    currents = [share * damper.max_current for share in SHARES]
    by_current = [
        (f"{current:g} A", current, start, colour)
        for current, colour in zip(currents, style.scale("viridis", len(currents)), strict=True)
    ]
    rows = [_Row(damper, f"{called} at {start:g} °C", "current", by_current)]
    if any(damper.factors[:3]):
        temperatures = _temperatures(damper)
        by_temperature = [
            (f"{value:g} °C", damper.max_current, value, colour)
            for value, colour in zip(temperatures, style.scale("plasma", len(temperatures)), strict=True)
        ]
        rows.append(_Row(damper, f"{called} at {damper.max_current:g} A", "temperature", by_temperature))
    return rows


def _temperatures(damper: Specimen) -> list[float]:
    """Return the temperatures of the runs where these differ, else those between which the model holds."""
    used = sorted({temperature_of(run) for run in damper.runs})
    if len(used) > 1:
        return used
    specification: DamperSpecification = specification_of(type(damper.record))
    low, high = specification.temperatures
    return [low, 0.5 * (low + high), high]


def _draw(panels: Sequence[Axes], row: _Row, amplitude: float) -> None:
    for name, current, temperature, colour in row.loops:
        test = row.damper.loop(amplitude, current, temperature)
        look = Entry(name, colour, width=1.6)
        style.line(panels[0], test.velocity, test.force, look)
        style.line(panels[1], 1e3 * test.displacement, test.force, look)
    panels[0].set_title(row.title, loc="left", fontsize=10.5)
    panels[0].set_xlabel("velocity [m/s]")
    panels[1].set_xlabel("displacement [mm]")
    panels[0].set_ylabel("damper force [N]")
    panels[1].set_ylim(panels[0].get_ylim())
    panels[1].tick_params(labelleft=False)
    style.beside(panels[1], row.legend)
