"""Doubts about a scenario that is valid: values that no seat has, and a sweep that changes nothing."""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from seatsim.effects.base import EFFECTS, acts_on
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.scenario.numbers import TEMPERATURE, list_records
from seatsim.scenario.scenario import Scenario
from seatsim.schema.fields import describe, field_names
from seatsim.schema.plausible import doubt
from seatsim.schema.registry import is_own, specification_of


def list_doubts(scenario: Scenario) -> list[str]:
    """Return a sentence for each value that is unusual for a seat, and for each that changes nothing."""
    doubts = []
    for section, record in list_records(scenario).items():
        for field in describe(type(record)):
            problem = doubt(field, getattr(record, field.name))
            if problem:
                keys = (
                    (*section.split("."), field.name) if section != TEMPERATURE or _is_thermal(scenario) else (section,)
                )
                doubts.append(f"{_place(scenario, keys)}: {problem}")
    if TEMPERATURE in scenario.label and not _depends_on_temperature(scenario):
        doubts.append(
            f"{_place(scenario, (TEMPERATURE,))}: nothing depends on the temperature that is varied, so that all runs"
            " are the same; state damper.temperature_factors, or damper.thermal_fade under effects"
        )
    return doubts + _list_unread(scenario)


def _list_unread(scenario: Scenario) -> list[str]:
    """Return a sentence for each effect on a thermocouple that nothing reads, since the fluid itself is simulated."""
    if not _is_thermal(scenario) or scenario.control is None or specification_of(type(scenario.control.law)).replays:
        return []
    ramp, own = np.arange(3.0), cast("tuple[Any, ...]", scenario.effects)
    return [
        f"{_place(scenario, ('effects',))}: {EFFECTS.name_of(type(effect))} states how the fluid differs from its"
        " thermocouple, which changes nothing here, since the temperature of the fluid is simulated; state it as a"
        " number, or replay a recorded damper_temperature"
        for effect in own
        if acts_on(type(effect), (TEMPERATURE,)) and not np.array_equal(effect.temperature(1.0, ramp), ramp)
    ]


def _is_thermal(scenario: Scenario) -> bool:
    return isinstance(scenario.temperature, Thermal)


def _place(scenario: Scenario, keys: tuple[str, ...]) -> str:
    return scenario.source.place(keys) if scenario.source else f"{scenario.name}, {'.'.join(keys)}"


def _depends_on_temperature(scenario: Scenario) -> bool:
    """Return whether damper, effects, law or the damper that an inverse assumes change with the temperature."""
    inverse, law = (scenario.control.inverse, type(scenario.control.law)) if scenario.control else (None, None)
    # What a law of the user's own reads is not known.
    if law is not None and (is_own(law) or any(TEMPERATURE in name for name in field_names(law))):
        return True
    factors = [scenario.damper.factors, *([inverse.damper.factors] if inverse else [])]
    return any(map(_act, factors)) or any(
        acts_on(type(effect), ("factors", TEMPERATURE)) for effect in scenario.effects
    )


def _act(factors: TemperatureFactors) -> bool:
    return any((factors.viscous, factors.stiffness, factors.yield_force))
