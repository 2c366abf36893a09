"""What of a scenario is a condition, under which a seat has to do well, and what is a choice of its designer.

Conditions are the floor, the seed, the temperature, the driver and the start: nobody chooses the weather. All else is a
choice: law, damper, coil, springs. Runs under one condition are alternatives to each other.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from seatsim.scenario.scenario import Scenario
from seatsim.schema.registry import Record, name_of

_CONDITIONS = ("excitation", "seed", "temperature", "driver", "start", "plant.driver_mass")
"""Sections and keys of a file that state a condition."""
_OF_CONDITIONS = ("driver.", "floor.")
"""Beginnings of the names of effects that act on driver or floor."""
T = TypeVar("T")


def is_condition(key: str) -> bool:
    """Return whether a dotted key of a scenario file, such as `excitation.speed`, states a condition."""
    return any(key == known or key.startswith(f"{known}.") for known in _CONDITIONS)


def condition_of(scenario: Scenario) -> str:
    """Return the condition of a run as a text that is equal where the condition is."""
    driver = (scenario.plant.driver_mass if scenario.plant else None, scenario.driver)
    floor = (scenario.excitation, scenario.seed, scenario.start)
    return repr((floor, scenario.temperature, driver, [each for each in scenario.effects if _is_outside(each)]))


def choice_of(scenario: Scenario) -> str:
    """Return what its designer chose of a run as a text that is equal where the choice is."""
    seat = scenario.plant._replace(driver_mass=0.0) if scenario.plant else None
    rig = (seat, scenario.damper, scenario.coil, [each for each in scenario.effects if not _is_outside(each)])
    return repr((rig, scenario.control, scenario.solver))


def _is_outside(effect: Record) -> bool:
    return name_of("effect", type(effect)).startswith(_OF_CONDITIONS)


def group_by_condition(items: Iterable[tuple[Scenario, T]]) -> list[list[T]]:
    """Return what belongs to scenarios, in groups of one condition each, in the order given."""
    groups: dict[str, list[T]] = {}
    for scenario, item in items:
        groups.setdefault(condition_of(scenario), []).append(item)
    return list(groups.values())


def is_passive(scenario: Scenario) -> bool:
    """Return whether the current of a run is constant, whatever the seat does."""
    return scenario.control is not None and name_of("law", type(scenario.control.law)) == "constant"
