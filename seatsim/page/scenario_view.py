"""A scenario on the page: driver mass, temperature, road and controller are moved, and the run follows.

What can be moved on the page are numbers, choices, and effects that are switched on and off.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from seatsim.metrics.table import SHORT
from seatsim.plots.runs.looks import Shown
from seatsim.plots.runs.signals import plot_psd, plot_transmissibility
from seatsim.plots.style import make_entries
from seatsim.report.blocks import Block, Signals, Table, show_pictures
from seatsim.report.formatting import format_quantity
from seatsim.report.headline import describe_run
from seatsim.report.packing import QUICK
from seatsim.report.runs import show_signals
from seatsim.scenario.loading import load, read_scenario
from seatsim.scenario.scenario import Scenario
from seatsim.schema.content import plain
from seatsim.schema.errors import InputError
from seatsim.schema.fields import FieldSpecification, bounds, describe
from seatsim.schema.printing import describe_channel
from seatsim.schema.validation import is_finite_number
from seatsim.simulation.result import Run
from seatsim.simulation.runs import run_one


class Slider(NamedTuple):
    """A number: its name in a request, what it is called, its unit, its range and where it starts, in that unit.

    `factor` leads from SI units to the unit shown.
    """

    name: str
    label: str
    unit: str
    low: float
    high: float
    value: float
    factor: float = 1.0


class Choice(NamedTuple):
    """One of several: its name in a request, what it is called, values with their words; the first is chosen."""

    name: str
    label: str
    options: Sequence[tuple[str, str]]


class Switch(NamedTuple):
    """Something that is on or off, with numbers that matter only while it is on."""

    name: str
    label: str
    meaning: str
    sliders: Sequence[Slider]


def make_slider(field: FieldSpecification, low: float, high: float, start: float, reach: float) -> Slider:
    """Return the slider of a number in SI units: within its bounds, from off to some times where it starts."""
    shown, size = describe_channel(field.meaning, field.unit), reach * abs(start) or 1.0
    ends = (min(start, max(low, -size if low < 0 else 0.0)), max(start, min(high, size)))
    low, high, start = (shown.factor * value for value in (*ends, start))
    return Slider(field.name, shown.words, shown.unit, low, high, start, shown.factor)


def read_number(request: Mapping[str, object], slider: Slider) -> float:
    """Return the value of a slider in a request in SI units, that at which it starts where the request has none.

    Raises:
        InputError: it is no number, or outside the range.
    """
    value = request.get(slider.name, slider.value)
    if not is_finite_number(value) or not slider.low <= value <= slider.high:
        raise InputError(f"{slider.label}: {value!r} is not permitted; {slider.low:g} to {slider.high:g} {slider.unit}")
    return float(value) / slider.factor


def _read_choice(request: Mapping[str, object], choice: Choice) -> str:
    """Return the chosen value of a request, the first one where the request has none.

    Raises:
        InputError: there is no such value.
    """
    known = [value for value, _ in choice.options]
    value = request.get(choice.name, known[0])
    if value not in known:
        raise InputError(f"{choice.label}: {value!r} is not permitted; one of {', '.join(map(repr, known))}")
    return str(value)


OWN = "file"
LAWS = (
    "skyhook", "on_off_skyhook", "no_jerk_skyhook", "groundhook", "hybrid", "skyhook_add", "acceleration_driven",
    "power_driven",
)  # fmt: skip
"""Laws that need no design before they run, so that a change is seen at once."""
_ROADS = "ABCDEF"
REACH = 3.0
"""How far a number of a law can be moved, over its value."""
SPEED, DURATION = 10.0, 20.0
"""m/s and s of a road that is chosen on the page."""


class View(NamedTuple):
    """What the page shows: a sentence, tables, the pictures, the numbers of the law at work, and what was fitted."""

    answer: str
    tables: list[Block]
    signals: Signals
    gains: Sequence[Slider] = ()
    fitted: Mapping[str, Mapping[str, float]] = {}


class ScenarioView:
    """One scenario file and what of it can be moved."""

    def __init__(self, path: Path) -> None:
        """Read a scenario file; of one with several runs, the first is shown until another is chosen.

        Raises:
            InputError: the file is wrong, or holds a damper bench, which has neither driver nor road.
        """
        self.path, scenarios = path, load(path)
        first = scenarios[0]
        if first.plant is None:
            raise InputError(f"{path}: is a damper bench; seatsim characterise shows it")
        self.name, mass = first.name, first.plant.driver_mass
        roads = [(OWN, "as in the file"), *((road, f"ISO 8608 class {road}, {SPEED:g} m/s") for road in _ROADS)]
        laws = [(OWN, "as in the file"), ("off", "no current"), *((law, law.replace("_", " ")) for law in LAWS)]
        self.sliders = [Slider("mass", "Driver mass", "kg", min(30.0, mass), max(150.0, mass), mass)]
        if any(any(scenario.damper.factors[:3]) for scenario in scenarios):
            start = float(first.temperature) if isinstance(first.temperature, int | float) else 20.0
            self.sliders.append(Slider("temperature", "Damper temperature", "°C", -20.0, 100.0, start))
        numbered = [(str(k), str(scenario.title)) for k, scenario in enumerate(scenarios)]
        self.choices = [Choice("run", "Run of the file", numbered)] if len(numbered) > 1 else []
        self.choices += [Choice("road", "Road", roads), Choice("law", "Controller", laws)]

    def show(self, request: Mapping[str, object]) -> View:
        """Return the run of a request.

        Raises:
            InputError: a value is not permitted.
            RunError: the run cannot be carried to its end.
        """
        base = self.choose({**request, "gains": {}})
        run, own = run_one(self.choose(request) if request.get("gains") else base), self._own
        shown = Shown("", run.scenario.name, [own, run], make_entries(["as in the file", "as set"]), "")
        figures = {"transmissibility": plot_transmissibility(shown), "psd": plot_psd(shown)}
        rows = [
            [words, *(format_quantity(each.metrics[name].value, each.metrics[name].unit) for each in (own, run))]
            for name, words in SHORT.items()
            if name in own.metrics and name in run.metrics
        ]
        table = Table("First run of the file, and the run as set", ["figure", "as in the file", "as set"], rows)
        blocks = [table, *show_pictures(figures, "transmissibility", "psd")]
        return View(describe_run(run), blocks, show_signals([shown], QUICK), _list_gains(base))

    def choose(self, request: Mapping[str, object]) -> Scenario:
        """Return the scenario that a request describes."""
        chosen = {choice.name: _read_choice(request, choice) for choice in self.choices}
        base, road, law = load(self.path)[int(chosen.get("run", "0"))], chosen["road"], chosen["law"]
        numbers = [(slider, read_number(request, slider)) for slider in self.sliders]
        keys, label = {"mass": "plant.driver_mass", "temperature": "temperature"}, dict(base.label)
        settings: dict[str, object] = {keys[own.name]: value for own, value in numbers if value != own.value}
        if road != OWN:
            settings["excitation"] = {"kind": "road", "road_class": road, "speed": SPEED, "duration": DURATION}
        if law != OWN:
            settings["controller"] = _state_law(base, law)
            label["variant"] = law.replace("_", " ")
        found = _reload(base, settings, label) if settings else base
        if not (gains := request.get("gains")):
            return found
        if not isinstance(gains, dict):
            raise InputError("gains: a mapping of numbers of the law to their values")
        moved = {f"controller.{slider.name}": read_number(gains, slider) for slider in _list_gains(found)}
        return _reload(base, settings | moved, label)

    def encode(self, request: Mapping[str, object]) -> dict[str, object]:
        """Return the scenario of a request as the content of a file."""
        source = self.choose(request).source
        assert source is not None
        content = plain(dict(source.data))
        assert isinstance(content, dict)
        return content

    @cached_property
    def _own(self) -> Run:
        """The first run as the file has it."""
        return run_one(load(self.path)[0])


def _state_law(base: Scenario, law: str) -> dict[str, object]:
    """Return the section of a law, with what the scenario states of sensors and sampling."""
    assert base.source is not None
    stated = base.source.data.get("controller", {})
    shared = ("sample_time", "sensors", "inverse")
    kept = {key: stated[key] for key in shared if isinstance(stated, dict) and key in stated}
    return {"law": "constant", "current": 0.0} if law == "off" else {"law": law, **kept}


def _reload(base: Scenario, settings: Mapping[str, object], label: Mapping[str, object]) -> Scenario:
    """Return a run of the file with some values replaced, whatever its variant states."""
    assert base.source is not None
    source = base.source.with_changes()
    for key, value in settings.items():
        source.put(key, value, f"the page, {key}")
    return read_scenario(source, label)


def _list_gains(scenario: Scenario) -> list[Slider]:
    """Return the numbers of the law of a scenario, each to be moved from its least to three times its value."""
    if scenario.control is None:
        return []
    record, found = scenario.control.law, []
    for field in describe(type(record)):
        value = getattr(record, field.name)
        if is_finite_number(value) and field.name != "sample_time":
            low, high = bounds(type(record), field.name)
            found.append(make_slider(field, low if value < 0 else max(low, 0.0), high, float(value), REACH))
    return found
