"""What every reader returns: channels in groups that share a time base, what a file states beside them, and their time.

The time of a group is that of a column, of what its format states, or of a sample rate; something may be wrong with it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.importing.names import is_of, read_name
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.units import DIMENSIONS, conversion

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
    """

    name: str
    signals: tuple[Signal, ...]
    rate: float | None = None
    start: float | None = None

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


_SAMPLE = r"(?:sampl\w*|abtast|scan|acquisition)"
_RATE = rf"{_SAMPLE}(?:rate|freq\w*)|fs|fr[ée]quenced.[ée]chantillonnage"
_STEP = rf"{_SAMPLE}(?:interval\w*|period\w*|step|zeit)|dt|delta[tx]"
"""Names, as `bare` returns them, under which the sample rate in Hz, or the interval in s, is stated."""
_RATES = re.compile(rf"{_RATE}|rate|frequency|sampleratehz|fa")
_STEPS = re.compile(rf"{_STEP}|ts|sampletime|increment|wfincrement|step|dx|xdelta|xinc|xincrement")
"""The same where they stand among variables: words that mean something else in a line of text are among them."""
_ENTRY = re.compile(
    r"""^[\W_]*(?P<key>[^\W\d][^\d:=;,|\t\[(]*?)["']?\s*(?:[\[(](?P<of_key>[^\])]*)[\])])?\s*[:=;,|\t ]\s*["']?"""
    r"""(?P<number>\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)["']?[\s;,|\[(]*(?P<unit>[A-Za-zµμ]*)[\W_]*$"""
)
"""A key, a number and perhaps a unit in a line of their own, such as `SampleRate, 200, Hz` or `dt = 0.002 s`."""
_LONGEST = 200
"""Letters of a line that may be such an entry."""
_IN_HZ = {"": 1.0, "hz": 1.0, "khz": 1e3, "s": 1.0, "sps": 1.0}
_IN_S = {"": 1.0, "s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6}
_NUMBER = re.compile(r"\s*\d+([.,]\d*)?([eE][-+]?\d{1,2})?\s*")
"""A number as a text."""
UNITS = ("unitstring", "unit", "units", "einheit", "ylabelunit", "yunit", "unity", "nunit", "niunitdescription")
"""Names under which a unit is stated."""


def bare(name: str) -> str:
    """Return a name in lower case and without underscores and blanks: `Sample_Rate` is `samplerate`."""
    return name.lower().replace("_", "").replace(" ", "")


def stated_rate(values: Mapping[str, object], seconds: float = 1.0) -> float | None:
    """Return the sample rate in Hz that stands among named values, None where none does.

    `seconds` is the unit of intervals in s.
    """
    for names, is_rate in ((_RATES, True), (_STEPS, False)):
        for key, value in values.items():
            number = scalar(value) if names.fullmatch(bare(key)) else None
            if number is not None and 0.0 < number < np.inf:
                return number if is_rate else 1.0 / (seconds * number)
    return None


def find_rate(lines: Sequence[str]) -> float | None:
    """Return the sample rate in Hz that lines of text state, None where none does."""
    entries = (_ENTRY.match(line) for line in lines if len(line) <= _LONGEST)
    for entry in filter(None, entries):
        number, key = float(entry["number"].replace(",", ".")), bare(entry["key"])
        unit = (entry["unit"] or entry["of_key"] or "").lower()
        if re.fullmatch(_RATE, key) and number > 0.0 and unit in _IN_HZ:
            return number * _IN_HZ[unit]
        if re.fullmatch(_STEP, key) and number > 0.0 and unit in _IN_S:
            return 1.0 / (number * _IN_S[unit])
    return None


def stated_text(values: Mapping[str, object], names: Sequence[str]) -> str:
    """Return the text that stands under the first of some bare names, empty where none does."""
    return next((text for name in names for key in values if bare(key) == name and (text := as_text(values[key]))), "")


def stated_unit(values: Mapping[str, object]) -> str:
    """Return the unit that stands among named values, empty where none does."""
    return stated_text(values, UNITS)


def scalar(value: object) -> float | None:
    """Return a single number, whatever array or text it stands in, None where there is none."""
    if isinstance(value, Mapping | list | tuple):
        return None
    array = np.asarray(value)
    if array.size == 1 and array.dtype.kind in "USO" and _NUMBER.fullmatch(as_text(array)):
        return float(as_text(array).replace(",", "."))
    return float(array.ravel()[0]) if array.size == 1 and array.dtype.kind in "fiu" else None


def as_text(value: object) -> str:
    """Return a text that may be bytes or stand in an array; it is empty where there is none."""
    if value is None or isinstance(value, Mapping | list | tuple):
        return ""
    array = np.asarray(value)
    if array.size != 1:
        return ""
    single = array.ravel()[0]
    return single.decode(errors="replace") if isinstance(single, bytes) else str(single)


def _in_seconds(times: NDArray[np.generic]) -> NDArray[np.generic]:
    """Return durations in s, or dates in s since the first of them; other values as they are."""
    if times.dtype.kind not in "mM":
        return times
    since = times - times.ravel()[0] if times.dtype.kind == "M" and times.size else times
    return np.asarray(since.astype("timedelta64[ns]") / np.timedelta64(1, "s"), dtype=np.float64)


def note_left_out(what: str, names: Sequence[str]) -> tuple[str, ...]:
    """Return a sentence on what was not taken, none where that is nothing."""
    return (f"{what}: {', '.join(dict.fromkeys(names))}",) if names else ()


def signals_of(
    name: str, array: NDArray[np.generic], unit: str = "", columns: Sequence[str] = (), units: Sequence[str] = ()
) -> list[Signal]:
    """Return the channels of an array of shape (N,), (N, k) or (k, N), k smaller; a matrix is `name#1`, `name#2`."""
    found = _in_seconds(np.squeeze(np.asarray(array)))
    if found.dtype.kind not in "fiub" or found.ndim not in (1, 2) or found.size < 2:
        return []
    values = found.astype(np.float64)
    if values.ndim == 1:
        return [Signal(name, unit, values)]
    if values.shape[0] < values.shape[1]:
        values = values.T
    count = values.shape[1]
    names = list(columns) if len(columns) == count else [f"{name}#{index + 1}" for index in range(count)]
    stated = list(units) if len(units) == count else [unit] * count
    return [Signal(each, of, values[:, index]) for index, (each, of) in enumerate(zip(names, stated, strict=True))]


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
