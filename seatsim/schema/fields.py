"""Fields of the records that make up a rig: unit, meaning and bounds are stated once, here read by YAML, docs and fits.

A record is a `typing.NamedTuple` whose annotations carry `param(...)`:

    class Spring(NamedTuple):
        stiffness: Annotated[float, param("N/m", "spring stiffness", low=0)] = 4600.0

Pydantic validates it from a mapping, numba compiles it as a typed record. A value that is permitted but unusual
(`param(..., usual=(low, high))`) is doubted, with the unit in which it was probably meant.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeVar, cast, get_args, get_origin, get_type_hints

from annotated_types import Ge, Gt, Le
from pydantic import Field, JsonValue, TypeAdapter
from pydantic.fields import FieldInfo

from seatsim.schema.content import list_written
from seatsim.schema.registry import Record
from seatsim.schema.units import CONVERSIONS
from seatsim.schema.yaml_text import parse_value

_R = TypeVar("_R")
N = TypeVar("N", bound=Record)
SLIGHTLY = 1e-9
"""How far above an open bound a value may come."""


def param(
    unit: str,
    meaning: str,
    low: float | None = None,
    high: float | None = None,
    above: float | None = None,
    usual: tuple[float, float] | None = None,
) -> Any:  # what stands in `Annotated` is no type to a checker
    """Describe one field: SI `unit`, `meaning`, and bounds (`low <= value <= high`, `value > above`).

    `usual` is the range of seats that are built; a value beyond it is permitted, and asked about.
    """
    extra: dict[str, JsonValue] = {"unit": unit} | ({"usual": list(usual)} if usual else {})
    return Field(description=meaning, json_schema_extra=extra, ge=low, le=high, gt=above, strict=True)


class FieldSpecification(NamedTuple):
    """What is known of one field of a record."""

    name: str
    unit: str
    meaning: str
    default: object
    required: bool
    usual: Sequence[float] | None = None


def field_names(record: type) -> tuple[str, ...]:
    """Return the names of the fields of a record class, in order; none for a class that is no record."""
    return tuple(getattr(record, "_fields", ()))


def default_values(record: type) -> dict[str, object]:
    """Return the defaults of a record class by field, without the fields that have none."""
    return dict(getattr(record, "_field_defaults", {}))


def validated(record: type[_R], values: object) -> _R:
    """Return the record of a class with the given values; raises `pydantic.ValidationError` where they do not fit."""
    return cast("_R", adapter(cast("type", record)).validate_python(values))


def read_packaged(path: Path, kind: type[_R]) -> _R:
    """Return what stands in a YAML file of the package, as a value of a kind."""
    return validated(kind, parse_value(path.read_text(encoding="utf-8")))


@cache
def adapter(record: type) -> TypeAdapter[object]:
    """Return the pydantic validator of a record class, which takes some milliseconds to make."""
    return TypeAdapter(record)


def describe(record: type) -> list[FieldSpecification]:
    """List name, unit, meaning and default of every field of a record class, in order."""
    defaults = default_values(record)
    specifications = []
    for name, hint in _hints(record).items():
        info, known = _field_info(hint), _extra_of(hint)
        unit, meaning = str(known.get("unit", "")), (info.description or "") if info else ""
        usual = cast("Sequence[float] | None", known.get("usual"))  # as `param` states it
        specifications.append(FieldSpecification(name, unit, meaning, defaults.get(name), name not in defaults, usual))
    return specifications


def replace_fields(record: N, changes: Mapping[str, float]) -> N:
    """Return a record with other values of some of its fields."""
    return record._replace(**changes)


def bounds(record: type, name: str) -> tuple[float, float]:
    """Return the least and the greatest value of a field; infinite where it has no such bound."""
    low, high = -math.inf, math.inf
    info = _field_info(_hints(record)[name])
    for mark in info.metadata if info else ():
        match mark:
            case Ge(ge=int() | float() as bound):
                low = float(bound)
            case Gt(gt=int() | float() as bound):
                low = float(bound) + SLIGHTLY
            case Le(le=int() | float() as bound):
                high = float(bound)
    return low, high


def choices(record: type, name: str) -> tuple[str, ...]:
    """Return the permitted values of a field that is one of several words, nothing for any other field."""
    parts = get_args(_hints(record)[name])
    return get_args(parts[0]) if parts and get_origin(parts[0]) is Literal else ()


def item_units(record: type, name: str) -> list[str]:
    """Return the unit of each item of a tuple field, an empty text where it states none."""
    parts = get_args(_hints(record)[name])
    return [str(_extra_of(item).get("unit", "")) for item in get_args(parts[0])] if parts else []


@cache
def _hints(record: type) -> Mapping[str, object]:
    return get_type_hints(record, include_extras=True)


def _field_info(hint: object) -> FieldInfo | None:
    return next((part for part in get_args(hint) if isinstance(part, FieldInfo)), None)


def _extra_of(hint: object) -> Mapping[str, JsonValue]:
    """Return what `param` states of a field beyond its bounds."""
    info = _field_info(hint)
    return info.json_schema_extra if info and isinstance(info.json_schema_extra, dict) else {}


_UNUSUAL = "is unusual, since seats have"
"""In every sentence of a doubt about a value."""


def doubt(field: FieldSpecification, value: object) -> str:
    """Return why a value of a field is unusual and what was probably meant, empty where it is usual.

    A value of 0 means that the part is not there, and the default that nothing was stated.
    """
    if field.usual is None or value == field.default:
        return ""
    low, high = field.usual
    unit = "" if field.unit == "-" else f" {field.unit}"
    for odd in value if isinstance(value, tuple) else (value,):
        if isinstance(odd, int | float) and not _is_usual(odd, field):
            return f"{odd:g}{unit} {_UNUSUAL} {low:g} to {high:g}{unit}{guess(odd, field)}"
    return ""


def guess(value: object, field: FieldSpecification) -> str:
    """Return the unit in which a value would be usual, as the end of a sentence; empty where there is none."""
    if isinstance(value, int | float) and field.usual is not None:
        for unit, (factor, zero) in CONVERSIONS.get(field.unit, {}).items():
            if _is_usual(meant := factor * value + zero, field):
                return f"; {value:g} {unit} would be {meant:.4g} {field.unit}"
    return ""


def _is_usual(value: float, field: FieldSpecification) -> bool:
    if field.usual is None or value == 0.0:
        return True
    low, high = field.usual
    # A range that begins above zero is one of magnitudes: the ends of a travel have both signs.
    size = abs(value) if low > 0.0 else value
    return low <= size <= high and math.isfinite(size)


def head_columns(record: type, print_unit: Callable[[str], str] = str) -> list[str]:
    """Return the name of each written field of a record class with its unit, as `print_unit` prints it."""
    units = {field.name: print_unit(field.unit) for field in describe(record)}
    return [f"{field.key} [{unit}]" if (unit := units[field.name]) else field.key for field in list_written(record)]
