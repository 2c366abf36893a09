"""What runs and swept values are called in a picture, and which runs it shows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.scenario.scenario import Scenario, Solver
from seatsim.schema.fields import describe
from seatsim.simulation.result import Run

MOST = 8
"""Most runs that lines of one panel can tell apart."""
LONGEST = 52
"""Letters of a label; longer ones are cut in the middle."""
LONGEST_TITLE = 64
PRETTY = {"degC": "°C", "^2": "²", "^3": "³", "ohm": "Ω", " s/m": "·s/m"}


def unit(text: str) -> str:
    """Return a unit as it is printed in a picture."""
    for plain, pretty in PRETTY.items():
        text = text.replace(plain, pretty)
    return text


def shown(runs: Sequence[Run]) -> list[Run]:
    """Return the runs that lines are drawn of.

    These are all of up to eight runs; of more those at the first swept values (one for each variant), or else
    eight that are spread evenly over their order, first and last included.
    """
    if len(runs) <= MOST:
        return list(runs)
    first = _swept(runs[0])
    alike = [run for run in runs if _swept(run) == first]
    if 1 < len(alike) <= MOST:
        return alike
    return [runs[index * (len(runs) - 1) // (MOST - 1)] for index in range(MOST)]


def which(chosen: Sequence[Run], runs: Sequence[Run]) -> str:
    """Return a sentence about the runs that are left out, or nothing."""
    return f" {len(chosen)} of {len(runs)} runs are shown." if len(chosen) < len(runs) else ""


def labels(runs: Sequence[Run], longest: int = LONGEST, without: str = "") -> list[str]:
    """Return what sets each run apart from the others: variant and swept values, less those of one key."""
    several = len({run.scenario.name for run in runs}) > 1
    return [clean(_described(run.scenario, several, without), longest) for run in runs]


def apart(alike: Sequence[Run], runs: Sequence[Run]) -> tuple[str, list[str]]:
    """Return what sets some of the runs apart from the others, and what sets each of these apart from the rest."""
    keys = [key for key in alike[0].scenario.label if len({str(run.scenario.label.get(key)) for run in alike}) == 1]
    several = len({run.scenario.name for run in runs}) > 1
    same = len({run.scenario.name for run in alike}) == 1
    shared = [_part(alike[0].scenario, key, alike[0].scenario.label[key]) for key in keys]
    own = [
        [_part(run.scenario, key, value) for key, value in run.scenario.label.items() if key not in keys]
        for run in alike
    ]
    heading = ", ".join([alike[0].scenario.name] * (several and same) + shared)
    names = [
        ", ".join([run.scenario.name] * (not same) + parts) or run.scenario.name
        for run, parts in zip(alike, own, strict=True)
    ]
    return clean(heading, LONGEST), [clean(name, LONGEST) for name in names]


def title(runs: Sequence[Run]) -> str:
    """Return the name of one run with what sets it apart, or the names of the scenarios of several."""
    if len(runs) == 1:
        return clean(_described(runs[0].scenario, True), LONGEST_TITLE)
    return clean(", ".join(dict.fromkeys(run.scenario.name for run in runs)), LONGEST_TITLE)


def clean(text: str, longest: int) -> str:
    """Return a text that matplotlib prints as it stands: no formulas, no hidden label, not too long."""
    half = longest // 2
    short = text if len(text) <= longest else f"{text[: half - 1]}…{text[-half:]}"
    return (f" {short}" if short.startswith("_") else short).replace("$", r"\$")


def is_number(value: Any) -> bool:
    """Tell whether a swept value is a number."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def axis(scenario: Scenario, key: str) -> str:
    """Return the label of an axis over the swept key, with its unit."""
    return f"{_word(key)} [{unit(unit_of(scenario, key)) or '-'}]"


def unit_of(scenario: Scenario, key: str) -> str:
    """Return the unit of the value under a dotted key of a scenario; empty where it has none."""
    if key == "temperature":
        return "degC"
    section, _, name = key.rpartition(".")
    record = _records(scenario).get(section)
    specifications = describe(record) if record else []
    found = next((specification.unit for specification in specifications if specification.name == name), "")
    return "" if found == "-" else found


def _records(scenario: Scenario) -> dict[str, type]:
    control, belief = scenario.control, scenario.control.inverse if scenario.control else None
    return {
        "plant": Plant,
        "damper.parameters": type(scenario.damper.record),
        "damper.temperature_factors": TemperatureFactors,
        "actuator": Coil,
        "temperature": Thermal,
        "controller": type(control.law) if control else tuple,
        "controller.inverse.parameters": type(belief.damper.record) if belief else tuple,
        "excitation": type(scenario.excitation),
        "solver": Solver,
    }


def _described(scenario: Scenario, named: bool, without: str = "") -> str:
    """Return variant and swept values, less those of one key; `named` puts the scenario's name first."""
    parts = [_part(scenario, key, value) for key, value in scenario.label.items() if key != without]
    return ", ".join([scenario.name] * named + parts) or scenario.name


def _part(scenario: Scenario, key: str, value: Any) -> str:
    if key == "variant":
        return str(value)
    text = f"{value:g}" if is_number(value) else str(value)
    if key == "temperature" and is_number(value):
        return f"{text} °C"
    return f"{_word(key)} {text} {unit(unit_of(scenario, key))}".strip()


def _word(key: str) -> str:
    return "damper temperature" if key == "temperature" else key.rpartition(".")[2].replace("_", " ")


def _swept(run: Run) -> dict[str, Any]:
    return {key: value for key, value in run.scenario.label.items() if key != "variant"}
