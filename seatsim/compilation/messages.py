"""What the user is told of compilation: that a first run waits for it, and why a method of his own fails.

Nothing heavy is imported here. The message of numba itself quotes every function on the way there.
"""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from seatsim.schema.modules import used_files

_Watcher = Callable[[int], None]
_watchers: list[_Watcher] = []


@contextmanager
def watch_compilation(tell: _Watcher) -> Iterator[None]:
    """Call `tell` with the number of functions compiled so far, each time one begins, and with 0 when all are done."""
    _watchers.append(tell)
    try:
        yield
    finally:
        _watchers.remove(tell)


def report(parts: int) -> None:
    """Tell the watchers."""
    for tell in _watchers:
        tell(parts)


_FAILED = "Failed in nopython mode pipeline (step: nopython frontend)"
_CALL = re.compile(
    r"No implementation of function Function\(<.*?function ([\w.]+).*\) found for signature:\s+>>> \w+(.*)"
)
"""A call that fits no function: its name, and the types that it is given."""
_REFUSED = re.compile(r"to signature '(\(.*\))' due to \"TypeError: (.*)\"")
"""The arguments of a method that is called with others, and what is wrong with these."""


def is_compilation(error: Exception) -> bool:
    """Whether an error is one of numba's, which it raises where it cannot compile a method."""
    return _FAILED in str(error)


def explain(error: Exception) -> str:
    """Return what is wrong and where; of any other error, its kind, its first line and its line of own code."""
    text = str(error).strip()
    inner = text.rpartition(_FAILED)[2].strip()
    if not is_compilation(error) or not inner:
        own = set(map(str, used_files()))
        lines = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename in own]
        where = f"{Path(lines[-1].filename).name}, line {lines[-1].lineno}: " if lines else ""
        return f"{where}{type(error).__name__}: {text.partition(chr(10))[0]}"
    place = re.search(r'File "([^"<]+)", line (\d+)', inner)  # what is generated has no file
    where = f"{Path(place[1]).name}, line {place[2]}: " if place else ""
    return f"{where}cannot be compiled: {_state_reason(inner)}"


def _state_reason(inner: str) -> str:
    called, refused = _CALL.match(inner), _REFUSED.search(inner)
    name = called[1] if called else ""
    if refused:
        return f"{name}{refused[1]} is called with other arguments: {refused[2]}"
    if called:
        return f"{name} takes no {_shorten(called[2])}"
    reason = inner.partition("\n")[0]
    return _shorten(reason[:1].lower() + reason[1:])


def _shorten(text: str) -> str:
    """Return a text without the types of all fields, which follow the name of a record."""
    while (shorter := re.sub(r"(?<=\w)\([^()]*\)", "", text)) != text:
        text = shorter
    return text
