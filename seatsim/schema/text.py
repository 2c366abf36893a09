"""Names in sentences."""

from __future__ import annotations

from collections.abc import Collection, Sequence

LONGEST_NAME = 100


def explain_bad_name(name: str) -> str:
    """Return why a name cannot be that of a file or folder, and how one may look; empty where it can be."""
    if not name.strip() or name != name.strip() or name.startswith("."):
        problem = "is empty, or begins with a point or a space"
    elif any(sign in "/\\" or not sign.isprintable() for sign in name):
        problem = "holds a slash or a sign that is not printed"
    elif len(name.encode()) > LONGEST_NAME:
        problem = f"is longer than {LONGEST_NAME} bytes"
    else:
        return ""
    return f"{problem}; it names files: write letters, digits, spaces, - and _, such as rough-track-80C"


def join_names(names: Collection[str], last: str = "and") -> str:
    """Return one or more names as they stand in a sentence: `a, b and c`."""
    *first, end = names
    return f"{', '.join(first)} {last} {end}" if first else end


def name_some(names: Sequence[str], most: int = 3, last: str = "and") -> str:
    """Return the first names as they stand in a sentence, and how many others there are: `a, b, c and 2 others`."""
    left = len(names) - most
    others = [f"{left} other{'s' * (left > 1)}"] if left > 0 else []
    return join_names([*names[:most], *others], last)
