"""What every reader returns: a file's channels, in groups that share a time base, as they stand there."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.arrays import Array

TIME = "time"
"""Name of a channel of times, where its file has no other for it."""
LISTED = 8
"""Names that a sentence lists at most."""


class Signal(NamedTuple):
    """One channel as a file has it: `values` of shape (N,), NaN where nothing stands; `unit` is empty if not stated."""

    name: str
    unit: str
    values: Array


class Group(NamedTuple):
    """Channels of equal length on one time base.

    `rate` in Hz and `start` in s are what the format itself states beside the channels, None where it states nothing.
    `is_road` tells that rows follow each other in distance.
    """

    name: str
    signals: tuple[Signal, ...]
    rate: float | None = None
    start: float | None = None
    is_road: bool = False

    @property
    def rows(self) -> int:
        """Values of each channel."""
        return len(self.signals[0].values)

    def find(self, name: str) -> Signal | None:
        """Return the channel of this name."""
        return next((signal for signal in self.signals if signal.name == name), None)

    def take(self, rows: slice | NDArray[np.bool_]) -> Group:
        """Return the group with some of its rows."""
        return self._replace(signals=tuple(signal._replace(values=signal.values[rows]) for signal in self.signals))


class DataFile(NamedTuple):
    """A file's groups, the name of its format, and sentences on what of it was not taken."""

    path: Path
    format: str
    groups: tuple[Group, ...]
    notes: tuple[str, ...] = ()


class Channels:
    """The channels of a file, gathered into groups of one name that share a time base."""

    def __init__(self) -> None:
        self._even: dict[tuple[str, int, float | None, float | None], list[Signal]] = {}
        self._timed: list[tuple[str, Array, list[Signal]]] = []

    def __len__(self) -> int:
        return len(self._even) + len(self._timed)

    def add(self, name: str, signal: Signal, rate: float | None = None, start: float | None = None) -> None:
        """Add a channel to those of its group's name, its length, its rate in Hz and its start in s."""
        self._even.setdefault((name, len(signal.values), rate, start), []).append(signal)

    def add_timed(self, name: str, times: Array, signals: Iterable[Signal]) -> None:
        """Add channels to those that have the same times in s, or as a group of this name."""
        same = next((held for _, others, held in self._timed if np.array_equal(others, times)), None)
        if same is None:
            self._timed.append((name, times, list(signals)))
        else:
            same += signals

    def groups(self) -> tuple[Group, ...]:
        """Return the groups; of several of one name each is called after its first channel too."""
        found = [(Group(name, tuple(held), rate, start), held) for (name, _, rate, start), held in self._even.items()]
        found += [(Group(name, (Signal(TIME, "s", times), *held)), held) for name, times, held in self._timed]
        names = [group.name for group, _ in found]
        called = [
            name if names.count(name) == 1 else f"{name}, {held[0].name}".strip(", ")
            for name, (_, held) in zip(names, found, strict=True)
        ]
        return tuple(group._replace(name=name) for name, (group, _) in zip(called, found, strict=True))
