"""A damper's parameters adjusted before a fit: scaled to another damper, fixed by the user."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from seatsim.identification.current_laws import is_current_law
from seatsim.identification.damper_record import DamperRecord, FieldValue, law_range
from seatsim.identification.scales import parse_unit
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.fields import bounds, describe
from seatsim.schema.validation import is_finite_number

R = TypeVar("R", bound=DamperRecord)

RANGE_FIELDS = ("law_end",)
"""Fields that state where a model holds; they are set from the data, not fitted."""


def rescale_damper(record: R, force: float, end: float) -> R:
    """Return a record for another damper: its forces times `force`, its laws stretched to the current `end` in A."""
    fields = record._asdict()
    stretch = end / (law_range(fields, end) or end)
    changed: dict[str, FieldValue] = {"law_end": end} if "law_end" in fields else {}
    for specification in describe(type(record)):
        value = fields[specification.name]
        powers = parse_unit(specification.unit)
        factor = force ** powers.get("N", 0.0)
        if specification.name in RANGE_FIELDS or isinstance(value, int | str):
            continue
        if isinstance(value, tuple):
            law = is_current_law(type(record), specification.name)
            changed[specification.name] = tuple(factor * c / (stretch**k if law else 1.0) for k, c in enumerate(value))
        else:
            changed[specification.name] = value * factor * stretch ** powers.get("A", 0.0)
    return record._replace(**changed)


def fix_parameters(record: R, values: Mapping[str, float]) -> R:
    """Return a record with some numbers as the user fixes them.

    Raises:
        InputError: a name is no number of the model, or its value is none or out of bounds.
    """
    known = numeric_fields(type(record))
    for name, value in values.items():
        if name not in known:
            raise InputError(f"--fix {name}: no such number{nearest(name, known)}; permitted: {', '.join(known)}")
        low, high = bounds(type(record), name)
        whole = isinstance(record._asdict()[name], int)
        if not _is_permitted(value, low, high, whole):
            kind = "a whole number" if whole else "a number"
            raise InputError(f"--fix {name}={value} is not permitted; it must be {kind} from {low:g} to {high:g}")
        record = record._replace(**{name: int(value) if whole else float(value)})
    return record


def _is_permitted(value: object, low: float, high: float, whole: bool) -> bool:
    """Whether a value, which may be any word of the command line, is a finite number within bounds."""
    return is_finite_number(value) and low <= value <= high and not (whole and value != int(value))


def numeric_fields(cls: type) -> list[str]:
    """Return the names of the numbers of a record class, those that can be fixed."""
    return [specification.name for specification in describe(cls) if isinstance(specification.default, int | float)]
