"""What every reader returns: a file's channels, in groups that share a time base, as they stand there."""

from __future__ import annotations

from collections.abc import Sequence
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


def groups_by_length(name: str, signals: list[Signal], rate: float | None) -> list[Group]:
    """Return channels as groups of equal length, in the order in which the lengths come."""
    lengths = dict.fromkeys(len(signal.values) for signal in signals)
    parts = [tuple(signal for signal in signals if len(signal.values) == length) for length in lengths]
    if len(parts) == 1:
        return [Group(name, parts[0], rate)]
    return [Group(f"{name}, {part[0].name}" if name else part[0].name, part, rate) for part in parts]


def add_channels(groups: list[Group], name: str, time: Array, signals: Sequence[Signal]) -> None:
    """Add channels to the group of `groups` that has the same times in s, or as a group of their own."""
    for number, group in enumerate(groups):
        if len(time) == group.rows and np.array_equal(group.signals[0].values, time):
            groups[number] = group._replace(signals=(*group.signals, *signals))
            return
    groups.append(Group(name, (Signal(TIME, "s", time), *signals)))
