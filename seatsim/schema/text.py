"""Names in sentences."""

from __future__ import annotations

import re
from collections.abc import Collection

LONGEST_NAME = 100
LONGEST_WORD = 1000


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


def cut_words(text: str) -> str:
    """Return a text without the middle of words of `LONGEST_WORD` letters or more, such as a path made of noise."""
    return re.sub(rf"\S{{{LONGEST_WORD},}}", lambda found: f"{found[0][:100]}...{found[0][-50:]}", text)


def join_names(names: Collection[str], last: str = "and") -> str:
    """Return one or more names as they stand in a sentence: `a, b and c`."""
    *first, end = names
    return f"{', '.join(first)} {last} {end}" if first else end
