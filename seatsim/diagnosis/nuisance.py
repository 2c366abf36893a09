"""Nominal parameters that are known to within the recording's tolerance: they are refitted, and are no effect."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.scenario.scenario import Scenario
from seatsim.schema.fields import describe

Array = NDArray[np.float64]

SCALE_OF_FORCES = 100.0
"""N; scale of the tolerance of forces that are nominally zero."""
SCALE_OF_LENGTHS = 0.01
"""m; scale of the tolerance of lengths that are nominally zero."""
LEFT_OUT = ("damper_ratio", "travel", "v_ref", "n")
"""Fields that are a convention, a geometry or an exponent of a model's form."""


class Nuisance(NamedTuple):
    """One parameter: section and name in the scenario, nominal value, and the largest deviation from it."""

    section: str
    name: str
    value: float
    span: float


def nuisances(scenario: Scenario, tolerance: float) -> list[Nuisance]:
    """List the parameters that the tolerance lets vary; those that are zero vary by a scale of their unit."""
    stiffness = scenario.plant.suspension_stiffness if scenario.plant else 0.0
    scales = {"N": SCALE_OF_FORCES, "N/m": stiffness, "m": SCALE_OF_LENGTHS}
    sections = {"plant": scenario.plant, "damper": scenario.damper.record, "coil": scenario.coil}
    found = []
    for section, record in sections.items():
        for specification in describe(type(record)) if record is not None else []:
            value = getattr(record, specification.name)
            if (
                specification.name in LEFT_OUT
                or not isinstance(value, float | int)
                or (section == "coil" and value == 0.0)
            ):
                continue
            span = tolerance * (abs(value) if value else scales.get(specification.unit, 0.0))
            if span > 0.0 and specification.name != "resistance":
                found.append(Nuisance(section, specification.name, float(value), span))
    return found


def varied(scenario: Scenario, parameters: Sequence[Nuisance], u: Array) -> Scenario:
    """Return the scenario with every parameter off by its span times u, shape (len(parameters),), -1 to 1."""
    records: dict[str, Any] = {"plant": scenario.plant, "damper": scenario.damper.record, "coil": scenario.coil}
    for parameter, share in zip(parameters, u, strict=True):
        value = {parameter.name: parameter.value + parameter.span * float(share)}
        records[parameter.section] = records[parameter.section]._replace(**value)
    damper = dataclasses.replace(scenario.damper, record=records["damper"])
    return dataclasses.replace(scenario, plant=records["plant"], damper=damper, coil=records["coil"])
