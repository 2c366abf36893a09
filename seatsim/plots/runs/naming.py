"""What runs and swept values are called in a figure, and which of many runs it shows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeGuard

from seatsim.plots.labels import LONGEST, LONGEST_TITLE, clean_text, format_unit
from seatsim.plots.thinning import spread_evenly
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.scenario.scenario import Scenario, Solver
from seatsim.schema.fields import describe
from seatsim.simulation.result import Run

MOST = 8
"""Most runs that lines of one panel can tell apart."""


def select_shown(runs: Sequence[Run]) -> list[Run]:
    """Return the runs that lines are drawn of.

    Up to eight runs are all drawn. Of more runs, those at the first swept values (one for each variant) are drawn,
    or else eight that are spread evenly over their order, first and last included.
    """
    if len(runs) <= MOST:
        return list(runs)
    # Lines of the same swept values differ in their variant, which is what a reader compares.
    first = _swept_values(runs[0])
    group = [run for run in runs if _swept_values(run) == first]
    if 1 < len(group) <= MOST:
        return group
    return spread_evenly(runs, MOST)


def describe_omission(chosen: Sequence[Run], runs: Sequence[Run]) -> str:
    """Return a sentence on how many runs are left out, with a space before it; empty where none is."""
    return f" {len(chosen)} of {len(runs)} runs are shown." if len(chosen) < len(runs) else ""


def label_runs(runs: Sequence[Run], longest: int = LONGEST, without: str = "") -> list[str]:
    """Return what sets each run apart from the others: variant and swept values, less those of one key."""
    several = len({run.scenario.name for run in runs}) > 1
    return [clean_text(_describe(run.scenario, several, without), longest) for run in runs]


def distinguish_runs(group: Sequence[Run], runs: Sequence[Run]) -> tuple[str, list[str]]:
    """Return what sets some of the runs apart from the others, and what sets each of these apart from the rest."""
    keys = [key for key in group[0].scenario.label if len({str(run.scenario.label.get(key)) for run in group}) == 1]
    several = len({run.scenario.name for run in runs}) > 1
    same = len({run.scenario.name for run in group}) == 1
    shared = [_describe_part(group[0].scenario, key, group[0].scenario.label[key]) for key in keys]
    own = [
        [_describe_part(run.scenario, key, value) for key, value in run.scenario.label.items() if key not in keys]
        for run in group
    ]
    heading = ", ".join([group[0].scenario.name] * (several and same) + shared)
    names = [
        ", ".join([run.scenario.name] * (not same) + parts) or run.scenario.name
        for run, parts in zip(group, own, strict=True)
    ]
    return clean_text(heading, LONGEST), [clean_text(name, LONGEST) for name in names]


def make_title(runs: Sequence[Run]) -> str:
    """Return the name of one run with what sets it apart, or the names of the scenarios of several."""
    if len(runs) == 1:
        return clean_text(_describe(runs[0].scenario, True), LONGEST_TITLE)
    return clean_text(", ".join(dict.fromkeys(run.scenario.name for run in runs)), LONGEST_TITLE)


def is_number(value: object) -> TypeGuard[float]:
    """Tell whether a swept value is a number; true and false are not, though Python counts them as integers."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def label_axis(scenario: Scenario, key: str) -> str:
    """Return the label of an axis over the swept key, with its unit."""
    return f"{_name_key(key)} [{format_unit(find_unit(scenario, key)) or '-'}]"


def find_unit(scenario: Scenario, key: str) -> str:
    """Return the unit of the value under a dotted key of a scenario; empty where it has none."""
    if key == "temperature":
        return "degC"
    section, _, name = key.rpartition(".")
    record = _records(scenario).get(section)
    specifications = describe(record) if record else []
    found = next((specification.unit for specification in specifications if specification.name == name), "")
    return "" if found == "-" else found


def _records(scenario: Scenario) -> dict[str, type]:
    """Return the class of parameters behind each section of a scenario file; their fields state the units."""
    control, assumed = scenario.control, scenario.control.inverse if scenario.control else None
    return {
        "plant": Plant,
        "damper.parameters": type(scenario.damper.record),
        "damper.temperature_factors": TemperatureFactors,
        "actuator": Coil,
        "temperature": Thermal,
        "controller": type(control.law) if control else tuple,
        "controller.inverse.parameters": type(assumed.damper.record) if assumed else tuple,
        "excitation": type(scenario.excitation),
        "solver": Solver,
    }


def _describe(scenario: Scenario, named: bool, without: str = "") -> str:
    """Return variant and swept values, less those of one key; `named` puts the scenario's name first."""
    parts = [_describe_part(scenario, key, value) for key, value in scenario.label.items() if key != without]
    return ", ".join([scenario.name] * named + parts) or scenario.name


def _describe_part(scenario: Scenario, key: str, value: object) -> str:
    if key == "variant":
        return str(value)
    text = f"{value:g}" if is_number(value) else str(value)
    if key == "temperature" and is_number(value):
        return f"{text} °C"
    return f"{_name_key(key)} {text} {format_unit(find_unit(scenario, key))}".strip()


def _name_key(key: str) -> str:
    return "damper temperature" if key == "temperature" else key.rpartition(".")[2].replace("_", " ")


def _swept_values(run: Run) -> dict[str, object]:
    return {key: value for key, value in run.scenario.label.items() if key != "variant"}
