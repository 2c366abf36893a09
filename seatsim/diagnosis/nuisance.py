"""Nuisance parameters: nominal parameters known to within the recording's tolerance; refitting one is no effect."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.scenario.scenario import Scenario
from seatsim.schema.fields import describe, replace_fields

Array = NDArray[np.float64]

SCALE_OF_FORCES = 100.0
"""N; scale of the tolerance of forces that are nominally zero, as the recording's contract states it."""
SCALE_OF_LENGTHS = 0.01
"""m; scale of the tolerance of lengths that are nominally zero, as the recording's contract states it."""
NOT_UNCERTAIN = ("damper_ratio", "travel", "v_ref", "n", "resistance")
"""Fields that are a convention, a geometry or an exponent of a model's form, or that move no compared channel."""


class Nuisance(NamedTuple):
    """One parameter: section and name in the scenario, nominal value, and the largest deviation from it (tolerance)."""

    section: str
    name: str
    nominal: float
    tolerance: float


def list_nuisances(scenario: Scenario, tolerance: float) -> list[Nuisance]:
    """List the parameters that a relative tolerance lets vary; those that are zero vary by a scale of their unit."""
    stiffness = scenario.plant.suspension_stiffness if scenario.plant else 0.0
    scales = {"N": SCALE_OF_FORCES, "N/m": stiffness, "m": SCALE_OF_LENGTHS}
    sections = {"plant": scenario.plant, "damper": scenario.damper.record, "coil": scenario.coil}
    found = []
    for section, record in sections.items():
        for specification in describe(type(record)) if record is not None else []:
            value = getattr(record, specification.name)
            if specification.name in NOT_UNCERTAIN or not isinstance(value, float | int):
                continue
            # Rates and times have no scale: a coil without a delay has none, and not one that is known to be small.
            largest = tolerance * (abs(value) if value else scales.get(specification.unit, 0.0))
            if largest > 0.0:
                found.append(Nuisance(section, specification.name, float(value), largest))
    return found


def vary(scenario: Scenario, parameters: Sequence[Nuisance], deviations: Array) -> Scenario:
    """Return the scenario with each parameter changed by tolerance times deviation, shape (parameters,), -1 to 1."""
    changes: dict[str, dict[str, float]] = {"plant": {}, "damper": {}, "coil": {}}
    for parameter, deviation in zip(parameters, deviations, strict=True):
        changes[parameter.section][parameter.name] = parameter.nominal + parameter.tolerance * float(deviation)
    plant = None if scenario.plant is None else replace_fields(scenario.plant, changes["plant"])
    damper = dataclasses.replace(scenario.damper, record=replace_fields(scenario.damper.record, changes["damper"]))
    return dataclasses.replace(
        scenario, plant=plant, damper=damper, coil=replace_fields(scenario.coil, changes["coil"])
    )
