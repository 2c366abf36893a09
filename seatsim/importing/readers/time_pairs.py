"""Columns in groups that share a time: `t1; a; t2; b` states two of them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from seatsim.importing.names import read_name
from seatsim.importing.signals import Group, Signal
from seatsim.importing.time_axis import measured_axis


def part_by_time(signals: Sequence[Signal], rate: float | None) -> tuple[Group, ...]:
    """Return one group, or one for each column of time where every one has others behind it.

    Columns whose times are alike share a group. Rows that have no time end a group.
    """
    begins = [index for index, signal in enumerate(signals) if _is_clock(signal)]
    ends = [*begins[1:], len(signals)]
    if len(begins) < 2 or any(end - begin < 2 for begin, end in zip(begins, ends, strict=True)):
        return (Group("", tuple(signals), rate),)
    parts: list[list[Signal]] = []
    for begin, end in pairwise([0, *begins[1:], len(signals)]):
        part = list(signals[begin:end])
        clock = _clock(part)
        same = next((each for each in parts if np.array_equal(_clock(each).values, clock.values, equal_nan=True)), None)
        if same is None:
            parts.append(part)
        else:
            same += [signal for signal in part if signal is not clock]
    if len(parts) == 1:
        return (Group("", tuple(parts[0]), rate),)
    clocks = [_clock(part) for part in parts]
    return tuple(
        Group(clock.name, tuple(part)).take(np.isfinite(clock.values))
        for clock, part in zip(clocks, parts, strict=True)
    )


def _is_clock(signal: Signal) -> bool:
    is_named = read_name(signal.name, signal.unit).quantity == "time"
    return is_named and measured_axis(signal.values[np.isfinite(signal.values)]) is not None


def _clock(part: Sequence[Signal]) -> Signal:
    return next(signal for signal in part if _is_clock(signal))
