"""Who is told that something is being compiled, since a first run waits for it; nothing heavy is imported here."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

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
