"""Units of the keys of a scenario, from the fields that a key leads to."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.sensors import Sensors
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.scenario.scenario import Scenario, Solver, Start
from seatsim.schema.fields import describe

_RECORDS: Mapping[str, Callable[[Scenario], type]] = {
    "plant": lambda scenario: Plant,
    "driver": lambda scenario: type(scenario.driver),
    "actuator": lambda scenario: Coil,
    "temperature": lambda scenario: Thermal,
    "damper.parameters": lambda scenario: type(scenario.damper.record),
    "damper.temperature_factors": lambda scenario: TemperatureFactors,
    "controller": lambda scenario: type(scenario.control.law) if scenario.control else Plant,
    "controller.sensors": lambda scenario: Sensors,
    "excitation": lambda scenario: type(scenario.excitation),
    "solver": lambda scenario: Solver,
    "start": lambda scenario: Start,
}
"""The record whose fields are the keys below each section."""
_DIRECT = {"temperature": "degC", "controller.sample_time": "s", "controller.inverse.temperature": "degC"}
"""Units of keys that are no field of a record."""


def find_unit(scenario: Scenario, key: str) -> str:
    """Return the unit of a dotted key; an empty string where it has none, as a name or a whole section."""
    if key in _DIRECT:
        return _DIRECT[key]
    section, _, name = key.rpartition(".")
    record = _find_record(scenario, section)
    return next((field.unit for field in describe(record) if field.name == name), "") if record else ""


def _find_record(scenario: Scenario, section: str) -> type | None:
    parts = section.split(".")
    if parts[0] == "effects" and len(parts) == 3 and parts[1].isdecimal() and int(parts[1]) < len(scenario.effects):
        return type(scenario.effects[int(parts[1])])
    return _RECORDS[section](scenario) if section in _RECORDS else None
