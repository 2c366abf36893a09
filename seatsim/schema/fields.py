"""Fields of the records that make up a rig: unit, meaning and bounds are stated once, here read by YAML, docs and fits.

A record is a `typing.NamedTuple` whose annotations carry `param(...)`:

    class Spring(NamedTuple):
        stiffness: Annotated[float, param("N/m", "spring stiffness", low=0)] = 4600.0

Pydantic validates it from a mapping, numba compiles it as a typed record.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Annotated, Any, Literal, NamedTuple, TypeVar, cast, get_args, get_origin, get_type_hints

from annotated_types import Ge, Gt, Le
from pydantic import Field, JsonValue, TypeAdapter
from pydantic.fields import FieldInfo

from seatsim.schema.registry import Record

R = TypeVar("R")
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
    names: tuple[str, ...] = getattr(record, "_fields", ())
    return names


def default_values(record: type) -> Mapping[str, object]:
    """Return the defaults of a record class by field, without the fields that have none."""
    defaults: Mapping[str, object] = getattr(record, "_field_defaults", {})
    return defaults


def validated(record: type[R], values: object) -> R:
    """Return the record of a class with the given values; raises `pydantic.ValidationError` where they do not fit."""
    known: type = record
    return cast("R", adapter(known).validate_python(values))


@cache
def adapter(record: type) -> TypeAdapter[object]:
    """Return the pydantic validator of a record class, which takes some milliseconds to make."""
    return TypeAdapter(record)


def describe(record: type) -> list[FieldSpecification]:
    """List name, unit, meaning and default of every field of a record class, in order."""
    defaults = default_values(record)
    specifications = []
    for name, hint in _hints(record).items():
        info = _field_info(hint)
        extra = info.json_schema_extra if info else None
        known = extra if isinstance(extra, dict) else {}
        unit, usual = str(known.get("unit", "")), cast("list[float] | None", known.get("usual"))
        meaning = (info.description or "") if info else ""
        required, default = name not in defaults, defaults.get(name)
        specifications.append(FieldSpecification(name, unit, meaning, default, required, usual))
    return specifications


def replace_fields(record: N, changes: Mapping[str, float]) -> N:
    """Return a record with other values of some of its fields."""
    return record._replace(**changes)


def bounds(record: type, name: str) -> tuple[float, float]:
    """Return the least and the greatest value of a field; infinite where it has no such bound."""
    limits = {"low": -math.inf, "high": math.inf}
    info = _field_info(_hints(record)[name])
    for mark in info.metadata if info else ():
        if isinstance(mark, Ge):
            limits["low"] = float(mark.ge)  # type: ignore[arg-type]  # only comparable by type
        elif isinstance(mark, Gt):
            limits["low"] = float(mark.gt) + SLIGHTLY  # type: ignore[arg-type]  # only comparable by type
        elif isinstance(mark, Le):
            limits["high"] = float(mark.le)  # type: ignore[arg-type]  # only comparable by type
    return limits["low"], limits["high"]


def choices(record: type, name: str) -> tuple[str, ...]:
    """Return the permitted values of a field that is one of several words, nothing for any other field."""
    parts = get_args(_hints(record)[name])
    return get_args(parts[0]) if parts and get_origin(parts[0]) is Literal else ()


@cache
def _hints(record: type) -> Mapping[str, object]:
    return get_type_hints(record, include_extras=True)


def _field_info(hint: object) -> FieldInfo | None:
    if get_origin(hint) is not Annotated:
        return None
    return next((part for part in get_args(hint) if isinstance(part, FieldInfo)), None)
