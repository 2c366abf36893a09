"""What can stand in a scenario: names by kind, and the keys of each with unit, default and bounds."""

from __future__ import annotations

import inspect

from seatsim.dampers.base import CONFIDENCE
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.sensors import Sensors
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.scenario.scenario import Solver, Start
from seatsim.schema import registry
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.fields import FieldSpecification
from seatsim.schema.fields import describe as fields_of

KINDS = ("damper", "law", "excitation", "effect")
SECTIONS = {
    "plant": Plant,
    "actuator": Coil,
    "temperature_factors": TemperatureFactors,
    "temperature": Thermal,
    "sensors": Sensors,
    "solver": Solver,
    "start": Start,
}
"""Sections of a scenario whose keys are always the same."""


def describe(name: str = "") -> str:
    """Return the list of all names, or the page of one.

    Raises:
        InputError: nothing has that name.
    """
    if not name:
        lines = [f"{kind}: {', '.join(registry.names(kind))}" for kind in KINDS]
        return "\n".join(
            [*lines, f"section: {', '.join(SECTIONS)}", "", "seatsim describe NAME shows the keys of one."]
        )
    if name in SECTIONS:
        return _page(name, "section", SECTIONS[name])
    for kind in KINDS:
        if name in registry.names(kind):
            return _page(name, kind, registry.find(kind, name))
    known = [known for kind in KINDS for known in registry.names(kind)] + list(SECTIONS)
    raise InputError(f"nothing is called '{name}'{nearest(name, known)}; 'seatsim describe' lists all names")


def _page(name: str, kind: str, cls: type) -> str:
    specification = None if kind == "section" else registry.specification_of(cls)
    lines = [f"{name} ({kind})", "", inspect.getdoc(cls) or ""]
    if specification is not None and specification.source:
        lines += ["", f"Source: {specification.source}"]
    if specification is not None and kind == "damper":
        low, high = specification.temperatures
        speed, current = specification.max_speed, specification.max_current
        lines += [f"Range of the data: |v| <= {speed:g} m/s, 0 to {current:g} A, {low:g} to {high:g} degC"]
        lines += [f"State: {specification.state}"] if specification.state else []
        lines += [f"Confidence: {specification.confidence}; {CONFIDENCE[specification.confidence]}"]
        lines += [f"Not fitted by an identification: {', '.join(specification.fixed)}"] if specification.fixed else []
    return "\n".join([*lines, "", "Keys:", *(_line(field) for field in fields_of(cls))])


def _line(field: FieldSpecification) -> str:
    unit = f" [{field.unit}]" if field.unit else ""
    default = "required" if field.required else f"default {_shown(field.default)}"
    return f"  {field.name}{unit}: {field.meaning} ({default})"


def _shown(value: object) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, tuple) and all(isinstance(item, float) for item in value):
        return f"[{', '.join(f'{item:g}' for item in value)}]"
    return str(value)
