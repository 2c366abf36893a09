"""Which column of a group is its time, in which unit, and whether its rows are a history over time at all."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from seatsim.importing.names import is_of, read_name
from seatsim.importing.signals import Group, Signal
from seatsim.importing.time_axis import Axis, measured_axis
from seatsim.schema.errors import InputError
from seatsim.schema.units import DIMENSIONS, conversion

SLOWEST, FASTEST = 20.0, 50_000.0
"""Hz; a column of time without unit is in s where its rows are between these rates, else its unit is asked for."""

SAME_RATE = 0.01
"""Fraction by which the rates of two columns of the same time may differ."""
EXACT = 0.25
"""Largest deviation from even spacing, in steps, of times that are rounded to their last digit."""


class Clock(NamedTuple):
    """A column that is the time of its group.

    `unit` is empty where none is stated and s is not likely; `axis` is in s then. `axis` is None where the column does
    not rise. `is_named` tells whether its name says time. `others` are columns of time with another rate.
    """

    column: str
    unit: str
    axis: Axis | None
    is_named: bool = True
    others: tuple[str, ...] = ()

    @property
    def open(self) -> str:
        """What has to be stated before the column can be used, empty where nothing has."""
        if self.unit and self.axis is not None:
            return ""
        seen = f"has no unit, and its rows are {1.0 / self.axis.rate:.4g} apart" if self.axis else "does not rise"
        return f"'{self.column}' {seen}"

    @property
    def assumptions(self) -> list[str]:
        """Sentences on a column that is taken for the time without a name that says so, or in place of others."""
        said = []
        if not self.is_named and self.axis is not None:
            seen = f"this one rises evenly and is taken for it, in s ({self.axis.rate:.6g} Hz)"
            said.append(f"{self.column}: no column is called time; {seen}")
        if self.others:
            said.append(
                f"{self.column}: is taken for the time of all columns; {', '.join(self.others)} has another rate"
            )
        return said


def find_clock(group: Group) -> Clock | None:
    """Return the column of time: of those that are called so the one that rises most evenly.

    Where none is called so, and the format states no rate, it is the first column if its name means nothing and it
    rises exactly evenly, as nothing measured does, by another step than 1, by which rows are counted.
    """
    meanings = [(signal, read_name(signal.name, signal.unit)) for signal in group.signals]
    named = [_clock(signal, meaning.unit) for signal, meaning in meanings if meaning.quantity == "time"]
    if named:
        best = min(named, key=lambda clock: _flaws(clock.axis))
        return best._replace(others=tuple(each.column for each in named if _differs(each, best)))
    first, meaning = meanings[0]
    if group.rate is not None or group.is_road or first.unit or meaning.quantity is not None:
        return None
    clock = _clock(first, "")._replace(is_named=False)
    return clock if clock.unit and _is_exact(clock.axis) and not (np.diff(first.values) == 1.0).all() else None


def _differs(clock: Clock, other: Clock) -> bool:
    """Say whether two columns of time, both in a known unit, have different rates."""
    if clock.axis is None or other.axis is None or not (clock.unit and other.unit):
        return False
    return abs(clock.axis.rate / other.axis.rate - 1.0) > SAME_RATE


def _is_exact(axis: Axis | None) -> bool:
    if axis is None or _flaws(axis):
        return False
    times = axis.times
    return bool(np.max(np.abs(times - np.linspace(times[0], times[-1], len(times)))) * axis.rate <= EXACT)


def _clock(signal: Signal, stated: str) -> Clock:
    unit = stated if stated and is_of(stated, "time") else ""
    times = signal.values[np.isfinite(signal.values)]
    axis = measured_axis(conversion(unit or "s", DIMENSIONS["time"]).factor * times) if len(times) > 2 else None
    if not unit and axis is not None and SLOWEST <= axis.rate <= FASTEST:
        unit = "s"
    return Clock(signal.name, unit, axis)


def _flaws(axis: Axis | None) -> int:
    """Return how far an axis is from even: 0 for one without a flaw."""
    if axis is None:
        return 4
    return 3 if not axis.is_even else 2 if len(axis.breaks) else int(axis.resolution > 0.0)


def is_spectrum(group: Group) -> bool:
    """Say whether the rows of a group follow each other in frequency."""
    first = group.signals[0]
    return read_name(first.name, first.unit).quantity == "frequency" and bool(np.all(np.diff(first.values) > 0.0))


def check_is_history(group: Group, place: str) -> None:
    """Raise InputError where a group is a spectrum."""
    if is_spectrum(group):
        raise InputError(
            f"{place}: its rows stand over '{group.signals[0].name}', not over time: it is a spectrum; export the time"
            " histories"
        )
