"""Values that are permitted but unusual, and the unit in which they were probably meant.

What is usual stands with the fields (`param(..., usual=(low, high))`), the units that are mistaken for each other here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from seatsim.schema.fields import FieldSpecification


class _MistakenUnit(NamedTuple):
    """A unit in place of the SI unit: `factor * value + offset` is the value in SI."""

    name: str
    factor: float
    offset: float = 0.0


_MISTAKEN: Mapping[str, tuple[_MistakenUnit, ...]] = {
    "m": (_MistakenUnit("mm", 1e-3), _MistakenUnit("cm", 1e-2)),
    "kg": (_MistakenUnit("g", 1e-3), _MistakenUnit("t", 1e3)),
    "N/m": (_MistakenUnit("N/mm", 1e3), _MistakenUnit("N/cm", 1e2)),
    "N s/m": (_MistakenUnit("N s/mm", 1e3), _MistakenUnit("N s/cm", 1e2)),
    "s": (_MistakenUnit("ms", 1e-3),),
    "A": (_MistakenUnit("mA", 1e-3),),
    "m/s": (_MistakenUnit("km/h", 1 / 3.6), _MistakenUnit("mm/s", 1e-3)),
    "m/s^2": (_MistakenUnit("g", 9.80665), _MistakenUnit("mm/s^2", 1e-3)),
    "degC": (_MistakenUnit("K", 1.0, -273.15), _MistakenUnit("degF", 5 / 9, -160 / 9)),
}
"""Units that stand in place of the SI unit, the likelier first."""


UNUSUAL = "is unusual, since seats have"
"""In every sentence of a doubt, by which such sentences are found among others."""


def doubt(field: FieldSpecification, value: object) -> str:
    """Return why a value of a field is unusual and what was probably meant, empty where it is usual.

    A value of 0 means that the part is not there, and the default that nothing was stated.
    """
    if field.usual is None or value == field.default:
        return ""
    low, high = field.usual
    numbers = value if isinstance(value, tuple) else (value,)
    odd = next((number for number in numbers if isinstance(number, int | float) and not _is_usual(number, field)), None)
    if odd is None:
        return ""
    unit = "" if field.unit == "-" else f" {field.unit}"
    return f"{odd:g}{unit} {UNUSUAL} {low:g} to {high:g}{unit}{guess(odd, field)}"


def guess(value: object, field: FieldSpecification) -> str:
    """Return the unit in which a value would be usual, as the end of a sentence; empty where there is none."""
    if not isinstance(value, int | float):
        return ""
    for unit in _MISTAKEN.get(field.unit, ()):
        meant = unit.factor * value + unit.offset
        if field.usual is not None and _is_usual(meant, field):
            return f"; {value:g} {unit.name} would be {meant:.4g} {field.unit}"
    return ""


def _is_usual(value: float, field: FieldSpecification) -> bool:
    if field.usual is None or value == 0.0:
        return True
    low, high = field.usual
    # A range that begins above zero is one of magnitudes: the ends of a travel have both signs.
    size = abs(value) if low > 0.0 else value
    return low <= size <= high and math.isfinite(size)
