"""Headings of the columns of a table of records: the name of each field with its unit."""

from __future__ import annotations

from collections.abc import Callable

from seatsim.schema.content import list_written
from seatsim.schema.fields import describe


def head_columns(record: type, print_unit: Callable[[str], str] = str) -> list[str]:
    """Return the name of each written field of a record class with its unit, as `print_unit` prints it."""
    units = {field.name: print_unit(field.unit) for field in describe(record)}
    return [f"{field.key} [{unit}]" if (unit := units[field.name]) else field.key for field in list_written(record)]
