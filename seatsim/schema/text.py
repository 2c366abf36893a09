"""Names in sentences."""

from __future__ import annotations

from collections.abc import Collection


def join_names(names: Collection[str], last: str = "and") -> str:
    """Return one or more names as they stand in a sentence: `a, b and c`."""
    *first, end = names
    return f"{', '.join(first)} {last} {end}" if first else end
