"""Why numba cannot compile a method, in one sentence: its own message quotes every function on the way there."""

from __future__ import annotations

import re
from pathlib import Path

FAILED = "Failed in nopython mode pipeline (step: nopython frontend)"


def is_compilation(error: Exception) -> bool:
    """Whether an error is one of numba's, which it raises where it cannot compile a method."""
    return FAILED in str(error)


def explain(error: Exception) -> str:
    """Return what is wrong and where; of any other error, its kind and its first line."""
    text = str(error).strip()
    reason = next((line for line in text.rpartition(FAILED)[2].splitlines() if line.strip()), "").strip()
    if not is_compilation(error) or not reason:
        return f"{type(error).__name__}: {text.partition(chr(10))[0]}"
    # The types of all fields follow the name of a record.
    reason = re.sub(r"(of type \w+)\(.*", r"\1", reason)
    place = re.search(r'File "([^"]+)", line (\d+)', text.rpartition(FAILED)[2])
    where = f"{Path(place[1]).name}, line {place[2]}: " if place else ""
    return f"{where}cannot be compiled: {reason[:1].lower()}{reason[1:]}"
