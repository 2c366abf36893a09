"""Names in sentences, on a terminal and in tables for a spreadsheet."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

_LONGEST_NAME = 100
_LONGEST_WORD = 1000
_FORMULA = re.compile(r"[=@\t\r]|[+-](?!\d[\d.,]*\s?[^\W\d]*$)")
"""How a text begins that a spreadsheet computes; a size with a sign and a unit, such as `-10 degC`, is none."""


def explain_bad_name(name: str) -> str:
    """Return why a name cannot be that of a file or folder, and how one may look; empty where it can be."""
    if not name.strip() or name != name.strip() or name.startswith("."):
        problem = "is empty, or begins with a point or a space"
    elif any(sign in "/\\" or not sign.isprintable() for sign in name):
        problem = "holds a slash or a sign that is not printed"
    elif len(name.encode()) > _LONGEST_NAME:
        problem = f"is longer than {_LONGEST_NAME} bytes"
    else:
        return ""
    return f"{problem}; it names files: write letters, digits, spaces, - and _, such as rough-track-80C"


def cut_words(text: str) -> str:
    """Return a text without the middle of words of `_LONGEST_WORD` letters or more, such as a path made of noise."""
    return re.sub(rf"\S{{{_LONGEST_WORD},}}", lambda found: f"{found[0][:100]}...{found[0][-50:]}", text)


def cut(text: str) -> str:
    """Return a text of 60 letters at most, without the end of a longer one."""
    return text if len(text) <= 60 else f"{text[:57]}..."


def join_names(names: Collection[str], last: str = "and") -> str:
    """Return one or more names as they stand in a sentence: `a, b and c`."""
    *first, end = names
    return f"{', '.join(first)} {last} {end}" if first else end


def name_some(names: Sequence[str], most: int = 3, last: str = "and") -> str:
    """Return the first names as they stand in a sentence, and how many others there are: `a, b, c and 2 others`."""
    left = len(names) - most
    others = [f"{left} other{'s' * (left > 1)}"] if left > 0 else []
    return join_names([*names[:most], *others], last)


def shorten_paths(paths: Sequence[tuple[str, ...]]) -> list[str]:
    """Return the shortest end of each path that no other one has, its last part at least: `rig-2/sine` and `chirp`."""

    def shorten(path: tuple[str, ...]) -> str:
        others = {other for other in paths if other != path}
        ends = (path[-length:] for length in range(1, len(path)))
        return "/".join(next((end for end in ends if all(other[-len(end) :] != end for other in others)), path))

    return list(map(shorten, paths))


def split_source(text: str) -> tuple[str, str]:
    """Return a docstring without its last paragraph `Source: ...`, and what that says, in one line."""
    words, _, source = text.partition("\n\nSource: ")
    return words, " ".join(source.split())


def make_printable(text: str) -> str:
    """Return a text in which signs that a terminal would obey or hide are written as Python escapes them."""
    return "".join(sign if sign.isprintable() or sign in "\n\t" else ascii(sign)[1:-1] for sign in text)


def disarm(cell: object) -> object:
    """Return a cell of a CSV; before a text that a spreadsheet would compute stands an apostrophe, which it hides."""
    return f"'{cell}" if isinstance(cell, str) and _FORMULA.match(cell) else cell
