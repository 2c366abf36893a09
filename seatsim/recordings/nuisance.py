"""Nuisance parameters: nominal parameters known to within the recording's tolerance; refitting one is no effect."""

import dataclasses
import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from seatsim.recordings.header import USUAL, Header, Tolerance
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.fields import bounds, describe, replace_fields

_SCALE_OF_FORCES = 100.0
"""N; scale of the tolerance of forces that are nominally zero, as the recording's contract states it."""
_SCALE_OF_LENGTHS = 0.01
"""m; scale of the tolerance of lengths that are nominally zero, as the recording's contract states it."""
_NOT_UNCERTAIN = ("damper_ratio", "travel", "v_ref", "n", "resistance")
"""Fields that are a convention, a geometry or an exponent of a model's form, or that move no compared channel."""

_LEAST_SHARE = 0.05
"""Share of its nominal value below which no parameter falls that may not be negative: without mass nothing moves."""
SECTIONS = {"plant": "plant", "damper": "damper.parameters", "coil": "actuator"}
"""Dotted key in the file of a scenario of each section that holds parameters."""
_NONE_OF_ITS_OWN: Mapping[str, float] = MappingProxyType({})


class Nuisance(NamedTuple):
    """One parameter: section and name in the scenario, nominal value, largest deviation, permitted range, and unit."""

    section: str
    name: str
    nominal: float
    tolerance: float
    low: float = -math.inf
    high: float = math.inf
    unit: str = "-"

    @property
    def key(self) -> str:
        """Dotted key of the parameter in the file of a scenario."""
        return f"{SECTIONS[self.section]}.{self.name}"

    def at(self, deviation: float) -> float:
        """Return the value at a deviation from -1 to 1, in units of the tolerance, within the permitted range."""
        return float(min(max(self.nominal + self.tolerance * deviation, self.low), self.high))


def list_varied(header: Header, scenario: Scenario, fitted: float) -> tuple[Nuisance, ...]:
    """List the parameters that the tolerances of a recording let vary; `fitted` is that of those stated as fitted."""

    def resolve(tolerance: Tolerance) -> float:
        return fitted if tolerance == "fitted" else tolerance

    own = {key: resolve(tolerance) for key, tolerance in header.own_tolerances.items()}
    default = header.default_tolerance
    # A fit leaves no parameter at zero exactly, so that one that is zero was not fitted.
    of_zeros = USUAL if default == "fitted" else default
    return tuple(list_nuisances(scenario, resolve(default), own, of_zeros))


def list_nuisances(
    scenario: Scenario, tolerance: float, own: Mapping[str, float] = _NONE_OF_ITS_OWN, of_zeros: float | None = None
) -> list[Nuisance]:
    """List the parameters that relative tolerances let vary; those that are zero vary by a scale of their unit.

    Args:
        scenario: the nominal one.
        tolerance: of the parameters that have none of their own.
        own: tolerances by dotted key; a convention or geometry varies only where it has one.
        of_zeros: tolerance of parameters that are zero and have none of their own, as `tolerance` where absent.
    """
    stiffness = scenario.plant.suspension_stiffness if scenario.plant else 0.0
    scales = {"N": _SCALE_OF_FORCES, "N/m": stiffness, "m": _SCALE_OF_LENGTHS}
    sections = {"plant": scenario.plant, "damper": scenario.damper.record, "coil": scenario.coil}
    found = []
    for section, record in sections.items():
        for specification in describe(type(record)) if record is not None else []:
            name, value = specification.name, getattr(record, specification.name)
            key = f"{SECTIONS[section]}.{name}"
            if (name in _NOT_UNCERTAIN and key not in own) or not isinstance(value, float | int):
                continue
            usual = tolerance if value or of_zeros is None else of_zeros
            # Rates and times have no scale: a coil without a delay has none, and not one that is known to be small.
            largest = own.get(key, usual) * (abs(value) if value else scales.get(specification.unit, 0.0))
            if largest > 0.0:
                low, high = bounds(type(record), name)
                # What may not be negative keeps a share of what it is nominally.
                low = max(low, _LEAST_SHARE * value) if low >= 0.0 else low
                found.append(Nuisance(section, name, float(value), largest, low, high, specification.unit))
    return found


def vary(scenario: Scenario, parameters: Sequence[Nuisance], deviations: Array) -> Scenario:
    """Return the scenario with each parameter changed by tolerance times deviation, shape (parameters,), -1 to 1."""
    changes: dict[str, dict[str, float]] = {"plant": {}, "damper": {}, "coil": {}}
    for parameter, deviation in zip(parameters, deviations, strict=True):
        changes[parameter.section][parameter.name] = parameter.at(deviation)
    plant = None if scenario.plant is None else replace_fields(scenario.plant, changes["plant"])
    damper = dataclasses.replace(scenario.damper, record=replace_fields(scenario.damper.record, changes["damper"]))
    coil = replace_fields(scenario.coil, changes["coil"])
    return dataclasses.replace(scenario, plant=plant, damper=damper, coil=coil)
