"""The end of every report: how its figures were made, with which settings and versions, and how to make it again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from importlib.metadata import version

from seatsim.report.blocks import Block, Code, Items, Section, Table, Text
from seatsim.report.formatting import format_number

PACKAGES = ("seatsim", "numpy", "scipy", "numba")


def describe_method(method: Sequence[str], settings: Mapping[str, object], command: str) -> Section:
    """Return the section on method, settings, versions and how to make the report again."""
    blocks: list[Block] = [Items(list(method))]
    if settings:
        blocks.append(Table("Settings", ["key", "value"], [[key, _write(value)] for key, value in settings.items()], 2))
    blocks.append(Table("Versions", ["package", "version"], list_versions(), 2))
    return Section("method", "How this was made", [*blocks, Text("This makes the report again:"), Code(command)])


@lru_cache(maxsize=1)
def list_versions() -> list[list[str]]:
    """Return the packages on which the figures depend, each with its version."""
    return [[name, version(name)] for name in PACKAGES]


def _write(value: object) -> str:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    return format_number(float(value), 5)
