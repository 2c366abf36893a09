"""What every reader returns: channels in groups that share a time base, and what a file states beside them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
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
