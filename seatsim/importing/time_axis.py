"""The time of a group: from a column, from what its format states, or from a sample rate; and what is wrong with it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.importing.names import is_of, read_name
from seatsim.importing.signals import Group, Signal
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.units import DIMENSIONS, conversion

_GAP = 1.5
"""A step of more median steps than this is a gap."""
_EVEN = 0.5
"""Largest deviation from even spacing, in steps, that is one of the time stamps and not of the rows."""
_IRREGULAR = 8
"""Steps that differ from the usual one, from which rounding can be told from rows that were lost or written twice."""
_ROUNDED, _SHARED = 1.05, 2.0
"""Deviation from even spacing, in steps of the stamps, that is one of rounding; and where rows share a stamp."""
_WHOLE = 2e-6
"""Relative deviation from a whole number of Hz up to which a rate is that number: time stamps are rounded."""
_SLOWEST, _FASTEST = 20.0, 50_000.0
"""Hz; a column of time without unit is in s where its rows are between these rates, else its unit is asked for."""
_SAME_RATE = 0.01
"""Fraction by which the rates of two columns of the same time may differ."""
_EXACT = 0.25
"""Largest deviation from even spacing, in steps, of times that are rounded to their last digit."""


class Axis(NamedTuple):
    """Times in s, shape (N,), with the rate of their usual step in Hz.

    `breaks` are the rows before which time jumps, repeats or runs back; `lost` is how many rows are missing there;
    `repeated` how many repeat a time. `is_even` where all other rows are evenly spaced. `resolution` is the step in s
    of time stamps that are about as coarse as the rows or coarser, 0 for finer ones: then the rate is an estimate.
    """

    times: Array
    rate: float
    is_even: bool = True
    resolution: float = 0.0
    breaks: NDArray[np.int_] = np.empty(0, dtype=int)
    lost: int = 0
    repeated: int = 0
    backwards: int = 0


def measured_axis(times: Array) -> Axis | None:
    """Return the axis of a column of times in s, None where it does not rise."""
    steps = np.diff(times)
    rising = steps[steps > 0.0]
    if len(rising) < 2:
        return None
    rounded = None if (steps < 0.0).any() else _rounded_axis(times, steps)
    if rounded is not None or len(rising) < 0.5 * len(steps):
        return rounded
    usual = float(np.median(rising))
    breaks = np.flatnonzero((steps > _GAP * usual) | (steps <= 0.0)) + 1
    if len(breaks) > 0.05 * len(steps) and not (steps < 0.0).any():
        return Axis(times, _whole_rate((len(times) - 1) / float(times[-1] - times[0])), is_even=False)
    parts = np.split(times, breaks)
    spans = np.array([part[-1] - part[0] for part in parts])
    counted = np.array([len(part) - 1 for part in parts])
    rate = _whole_rate(float(np.sum(counted) / np.sum(spans)))
    off = max(map(_find_deviation, parts))
    jumps = steps[breaks - 1]
    lost = int(np.sum(np.round(jumps[jumps > 0.0] * rate) - 1))
    repeated, backwards = int(np.sum(jumps == 0.0)), int(np.sum(jumps < 0.0))
    return Axis(times, rate, off * rate <= _EVEN, 0.0, breaks, lost, repeated, backwards)


def _rounded_axis(times: Array, steps: Array) -> Axis | None:
    """Return the axis of rows whose stamps are rounded to about a row or more, None where they are finer.

    Rounding leaves every stamp within one of its steps from evenly spaced times; a row that was lost or written twice
    moves all that follow. Where several rows share a stamp and it is further off, the axis is not even.
    """
    usual = float(np.median(steps))
    is_shared = usual == 0.0
    if not is_shared and np.sum(np.abs(steps - usual) > _EVEN * usual) < _IRREGULAR:
        return None
    # The step of which all others are multiples, apart from the digits of a number.
    digits = int(np.floor(-np.log10(16.0 * np.spacing(np.max(np.abs(times)) + 1e-300))))
    different = np.unique(np.round(steps, min(digits, 12)))
    resolution = float(np.min(np.diff(different)) if len(different) > 1 else different[0])
    rows = np.arange(len(times))
    changes = np.flatnonzero(steps > 0.0) + 1
    first, last = changes[0], changes[-1]
    slopes = ((times[last] - times[first]) / (last - first), float(np.polyfit(rows, times - times[0], 1)[0]))
    off, slope = min((float(np.ptp(times - each * rows)), each) for each in slopes)
    if off <= (_SHARED if is_shared else _ROUNDED) * resolution:
        rate = _whole_rate(1.0 / slope, 1.0 / len(rows))
        return Axis(times[first] + (rows - first) / rate, rate, resolution=resolution)
    return Axis(times, 1.0 / slope, is_even=False, resolution=resolution) if is_shared else None


def _whole_rate(rate: float, near: float = _WHOLE) -> float:
    """Return a rate, or the whole number of Hz that it is apart from rounding."""
    return float(round(rate)) if round(rate) and abs(rate / round(rate) - 1.0) < near else float(f"{rate:.8g}")


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
            said.append(f"no column is called time; {seen}")
        if self.others:
            said.append(f"is taken for the time of all columns; {', '.join(self.others)} has another rate")
        return [f"{self.column}: {each}" for each in said]


def find_clock(group: Group) -> Clock | None:
    """Return the column of time: of those that are called so the one that rises most evenly.

    Where none is called so, and the format states no rate, it is the first column if its name means nothing and it
    rises exactly evenly, as nothing measured does, by another step than 1, by which rows are counted.
    """
    meanings = [(signal, read_name(signal.name, signal.unit)) for signal in group.signals]
    named = [_clock(signal, meaning.unit) for signal, meaning in meanings if meaning.quantity == "time"]
    if named:
        best = min(named, key=lambda clock: _flaws(clock.axis))
        known = [(each.column, each.axis.rate) for each in named if each.axis and each.unit]
        own = best.axis.rate if best.axis and best.unit else np.nan
        return best._replace(others=tuple(column for column, rate in known if abs(rate / own - 1.0) > _SAME_RATE))
    first, meaning = meanings[0]
    if group.rate is not None or first.unit or meaning.quantity is not None:
        return None
    clock = _clock(first, "")._replace(is_named=False)
    if not clock.unit or clock.axis is None or _flaws(clock.axis) or (np.diff(first.values) == 1.0).all():
        return None
    return clock if _find_deviation(clock.axis.times) * clock.axis.rate <= _EXACT else None


def _find_deviation(times: Array) -> float:
    """Return how far times are from even spacing between the first and the last of them, in s."""
    return float(np.max(np.abs(times - np.linspace(times[0], times[-1], len(times)))))


def _clock(signal: Signal, stated: str) -> Clock:
    unit = stated if stated and is_of(stated, "time") else ""
    times = signal.values[np.isfinite(signal.values)]
    axis = measured_axis(conversion(unit or "s", DIMENSIONS["time"]).factor * times) if len(times) > 2 else None
    if not unit and axis is not None and _SLOWEST <= axis.rate <= _FASTEST:
        unit = "s"
    return Clock(signal.name, unit, axis)


def _flaws(axis: Axis | None) -> int:
    """Return how far an axis is from even: 0 for one without a flaw."""
    return 4 if axis is None else 3 if not axis.is_even else 2 if len(axis.breaks) else int(axis.resolution > 0.0)


def is_spectrum(group: Group) -> bool:
    """Say whether the rows of a group follow each other in frequency."""
    first = group.signals[0]
    return read_name(first.name, first.unit).quantity == "frequency" and bool(np.all(np.diff(first.values) > 0.0))


def check_is_history(group: Group, place: str) -> None:
    """Raise InputError where a group is a spectrum."""
    if is_spectrum(group):
        seen = f"its rows stand over '{group.signals[0].name}', not over time"
        raise InputError(f"{place}: {seen}: it is a spectrum; export the time histories")
