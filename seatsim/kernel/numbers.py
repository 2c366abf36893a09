"""Records as numbers in a row, and what many records of one form share.

A record is any nesting of named tuples and tuples of numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeVar, cast

T = TypeVar("T")


class Zero(NamedTuple):
    """A number that is 0 in every record."""


class One(NamedTuple):
    """A number that is 1 in every record."""


class Two(NamedTuple):
    """A number that is 2 in every record, such as the exponent of a product."""


SHARED: dict[type, float] = {Zero: 0.0, One: 1.0, Two: 2.0}
"""Numbers that are compiled in where all records share them: the terms and powers that they take away cost most."""


def numbers(record: tuple[object, ...]) -> list[float]:
    """Return the numbers of a record from the first field to the last, those of nested ones in their place.

    Raises:
        TypeError: a field is neither a number nor a record.
    """
    found: list[float] = []
    for part in record:
        if isinstance(part, tuple):
            found += numbers(part)
        elif isinstance(part, bool | int | float):
            found.append(part)
        else:
            raise TypeError(f"{type(part).__name__} is no number")
    return found


def template_of(records: Sequence[T]) -> T:
    """Return the first of several records of one form, with what they share of `SHARED` in place of its numbers."""
    first = records[0]
    if isinstance(first, tuple):
        parts = [template_of(column) for column in zip(*cast("Sequence[tuple[Any, ...]]", records), strict=True)]
        return cast("T", type(first)(*parts) if hasattr(first, "_fields") else tuple(parts))
    if isinstance(first, float) and all(record == first for record in records):
        return cast("T", next((kind() for kind, value in SHARED.items() if value == first), first))
    return first
