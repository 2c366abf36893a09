"""Keys and numbers of a scenario by the dotted keys of its file, such as `plant.driver_mass`, and doubts about them."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any

from seatsim.effects.base import acts_on
from seatsim.rig.sensors import Sensors
from seatsim.rig.temperature import Thermal
from seatsim.scenario.scenario import Scenario
from seatsim.scenario.sections import SECTIONS
from seatsim.schema.errors import permit
from seatsim.schema.fields import FieldSpecification, describe, doubt, field_names, replace_fields
from seatsim.schema.registry import Record, is_own
from seatsim.schema.validation import check_value
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath

PARAMETERS = ("plant", "damper.parameters", "actuator")
"""Sections of a file whose numbers are parameters of the rig; those of the others are conditions of a run."""
LAW, TEMPERATURE = "controller", "temperature"


def list_numbers(scenario: Scenario) -> dict[str, float]:
    """Return the numbers of plant, damper, coil, control law and temperature by dotted key."""
    found = {
        f"{section}.{name}": value
        for section, record in _records(scenario).items()
        for name in field_names(type(record))
        if isinstance(value := getattr(record, name), int | float) and not isinstance(value, bool)
    }
    return found if isinstance(scenario.temperature, Thermal) else found | {TEMPERATURE: scenario.temperature}


def set_number(scenario: Scenario, key: str, value: float) -> Scenario:
    """Return the scenario with another value of a number that `list_numbers` names."""
    section, _, name = key.rpartition(".")
    if not section:
        return dataclasses.replace(scenario, temperature=value)
    record: Any = replace_fields(_records(scenario)[section], {name: value})
    if section == LAW and scenario.control is not None:
        return dataclasses.replace(scenario, control=dataclasses.replace(scenario.control, law=record))
    if section == "damper.parameters":
        return dataclasses.replace(scenario, damper=dataclasses.replace(scenario.damper, record=record))
    changed = {SECTIONS[section].field or section: record}
    return dataclasses.replace(scenario, **changed)


def change_numbers(scenario: Scenario, changes: Mapping[str, float], nominal: Mapping[str, float]) -> Scenario:
    """Return a scenario with what was changed on purpose, stated as values of a nominal scenario with these numbers.

    A parameter that is not the nominal one, since it was refitted, is off by as much after the change: it is `value x
    own / nominal`, or `value + own` where the nominal value is 0. A condition, as the temperature, is what was stated.
    """
    own = list_numbers(scenario)
    for key, value in changes.items():
        known = nominal[key]
        refitted = key.startswith(PARAMETERS) and own[key] != known
        moved = value * own[key] / known if known else value + own[key]
        scenario = set_number(scenario, key, moved if refitted else value)
    return scenario


def check_key(key: str, known: Iterable[str], source: Source, keys: KeyPath) -> None:
    """Raise InputError, placed at `keys` of a source, where a dotted key names no number of a scenario."""
    permitted = list(known)
    if key not in permitted:
        raise source.error(keys, f"the nominal scenario has no such number{permit(key, permitted)}")


def check_number(scenario: Scenario, key: str, value: float, source: Source, keys: KeyPath) -> None:
    """Raise InputError, placed at `keys` of a source, where a scenario has no such number or does not permit the value.

    The error names the value, what is permitted, and the nearest key.
    """
    check_key(key, list_numbers(scenario), source, keys)
    section, _, name = key.rpartition(".")
    record, field = (_records(scenario)[section], name) if section else (Thermal(), "start")
    check_value(record, field, value, source, keys)


def _list_records(scenario: Scenario) -> dict[str, Record]:
    """Return the records whose fields are keys of a scenario, by the dotted key that they stand under in its file.

    A temperature that is stated as a number is the start of one that changes; sensors that are not stated are those
    that a file without keys would state.
    """
    thermal = scenario.temperature if isinstance(scenario.temperature, Thermal) else Thermal(scenario.temperature)
    control, damper = scenario.control, scenario.damper
    # What is registered as a law, damper or excitation is a record of its keys.
    found: dict[str, Any] = {
        "plant": scenario.plant,
        "driver": scenario.driver,
        "damper.parameters": damper.record,
        "damper.temperature_factors": damper.factors,
        "actuator": scenario.coil,
        TEMPERATURE: thermal,
        LAW: control and control.law,
        f"{LAW}.sensors": control and (control.sensors or Sensors()),
        "excitation": scenario.excitation,
        "solver": scenario.solver,
        "start": scenario.start,
    }
    found |= {f"effects.{index}.parameters": effect for index, effect in enumerate(scenario.effects)}
    return {section: record for section, record in found.items() if record is not None}


def list_keys(scenario: Scenario) -> dict[str, FieldSpecification]:
    """Return the dotted keys of a scenario that are fields of a record, with unit and meaning of each."""
    fields = {
        f"{section}.{field.name}": field
        for section, record in _list_records(scenario).items()
        for field in describe(type(record))
    }
    return {**fields, TEMPERATURE: fields[f"{TEMPERATURE}.start"]}


def find_unit(scenario: Scenario, key: str) -> str:
    """Return the unit of a dotted key; an empty string where it has none, as a name or a whole section."""
    others = {f"{LAW}.sample_time": "s", f"{LAW}.inverse.temperature": "degC"}
    keys = list_keys(scenario)
    return keys[key].unit if key in keys else others.get(key, "")


def _records(scenario: Scenario) -> dict[str, Record]:
    """Return the records of numbers by the section of the file that they stand under."""
    known = _list_records(scenario)
    sections = (*PARAMETERS, LAW, *([TEMPERATURE] if isinstance(scenario.temperature, Thermal) else []))
    return {section: known[section] for section in sections if section in known}


def list_doubts(scenario: Scenario) -> list[str]:
    """Return a sentence for each value that is unusual for a seat, and for each that changes nothing."""
    doubts = []
    for section, record in _list_records(scenario).items():
        for field in describe(type(record)):
            if problem := doubt(field, getattr(record, field.name)):
                is_number = section == TEMPERATURE and not isinstance(scenario.temperature, Thermal)
                keys = (section,) if is_number else (*section.split("."), field.name)
                doubts.append(f"{scenario.place(*keys)}: {problem}")
    if TEMPERATURE in scenario.label and not _depends_on_temperature(scenario):
        doubts.append(
            f"{scenario.place(TEMPERATURE)}: nothing depends on the temperature that is varied, so that all runs"
            " are the same; state damper.temperature_factors, or damper.thermal_fade under effects"
        )
    return doubts


def _depends_on_temperature(scenario: Scenario) -> bool:
    """Return whether damper, effects, law or the damper that an inverse assumes change with the temperature."""
    inverse, law = (scenario.control.inverse, type(scenario.control.law)) if scenario.control else (None, None)
    # What a law of the user's own reads is not known.
    if law is not None and (is_own(law) or any(TEMPERATURE in name for name in field_names(law))):
        return True
    factors = [scenario.damper.factors, *([inverse.damper.factors] if inverse else [])]
    act = any(any((each.viscous, each.stiffness, each.yield_force)) for each in factors)
    return act or any(acts_on(type(effect), ("factors", TEMPERATURE)) for effect in scenario.effects)
