"""What two channels of a file show of each other, whatever rig they are of: copies, derivatives, delays."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from itertools import combinations

import numpy as np

from seatsim.recordings.quality.issue import Issue
from seatsim.recordings.quality.relations import MOST_ROWS, find_delay, kind_of, read_gain, regress
from seatsim.schema.arrays import Array

_ALIKE = 0.9
"""Correlation from which a channel is the delayed copy of another one."""
_REST, _STANDING, _RELAXED = 0.5, 0.01, 0.01
"""s for which a motion stands still, its swing there as a share of the whole, and the least change of a force there."""
_FEWEST = 8
"""Rows of such a stretch from which a change can be told."""


def doubt_pairs(
    channels: Mapping[str, Array],
    rate: float | None,
    quantities: Mapping[str, str | None],
    commands: Collection[str] = (),
) -> Iterator[Issue]:
    """Yield copies, derived velocities and what follows its command late, among channels of one time base."""
    part = {name: centred for name, values in channels.items() if (centred := _centred(values[:MOST_ROWS])) is not None}
    for first, second in combinations(part, 2):
        same = quantities.get(first) == quantities.get(second)
        if np.array_equal(channels[first][:MOST_ROWS], channels[second][:MOST_ROWS]):
            yield Issue("warning", "duplicate", f"{second}: holds the same values as {first}", second)
        elif rate and same and (first in commands) != (second in commands):
            yield from _delayed(first, second, part[first], part[second], rate)
    yield from _unconfirmed(channels, quantities, commands)
    if rate:
        yield from _derived(part, rate, quantities)
        yield from _relaxed(part, rate, quantities)


def _centred(values: Array) -> Array | None:
    if np.isnan(values).any() or np.ptp(values) == 0.0:
        return None
    return values - float(np.mean(values))


def _derived(part: Mapping[str, Array], rate: float, quantities: Mapping[str, str | None]) -> Iterator[Issue]:
    """Yield velocities that were computed from a displacement: they are no measurement of their own."""
    for velocity in (name for name in part if quantities.get(name) == "velocity"):
        for name in (name for name in part if quantities.get(name) == "displacement"):
            gain, alike = regress(np.gradient(part[name], 1.0 / rate), part[velocity], rate)
            if alike > 0.98 and abs(gain - 1.0) < 0.1:
                text = f"is the derivative of {name} (gain {gain:.3f}); computed from it, no sensor of its own"
                yield Issue("note", "derived", f"{velocity}: {text}", velocity)
                break
            if alike > 0.98 and (said := read_gain(gain, "m/s")):
                text = f"{velocity}: is {gain:.4g} times the derivative of {name}: {said}"
                yield Issue("warning", kind_of(gain), text, velocity)
                break


def _unconfirmed(
    channels: Mapping[str, Array], quantities: Mapping[str, str | None], commands: Collection[str]
) -> Iterator[Issue]:
    """Yield commanded forces and motions of which nothing was measured: no data tell their sign and their size."""
    measured = {quantities.get(name) for name in channels if name not in commands}
    for name in channels:
        quantity = quantities.get(name)
        if name in commands and quantity in ("force", "velocity", "displacement") and quantity not in measured:
            text = f"is a command by its name, and no {quantity} was measured: nothing here shows its sign or scale"
            yield Issue("note", "command", f"{name}: {text}", name)


def _relaxed(part: Mapping[str, Array], rate: float, quantities: Mapping[str, str | None]) -> Iterator[Issue]:
    """Yield forces that change while the motion stands still after it has moved, as those that relax do."""
    rows = round(_REST * rate)
    if rows < _FEWEST:
        return
    for name in (name for name in part if quantities.get(name) == "displacement"):
        still = _still(part[name], rows)
        for force in (each for each in part if quantities.get(each) == "force"):
            piece = np.array([np.mean(part[force][at : at + rows // 4]) for at in still])
            later = np.array([np.mean(part[force][at + rows - rows // 4 : at + rows]) for at in still])
            change = np.abs(later - piece)
            if len(change) and np.max(change) > _RELAXED * np.ptp(part[force]):
                text = f"changes by up to {np.max(change):.3g} N in {_REST:g} s after {name} has come to rest"
                said = f"{force}: {text}: it relaxes, its zero drifts, or its current changes"
                yield Issue("note", "relaxation", said, force)


def _still(motion: Array, rows: int) -> list[int]:
    """Return the rows at which a motion comes to rest for so many rows."""
    windows = len(motion) // rows
    swing = np.ptp(motion[: windows * rows].reshape(windows, rows), axis=1) if windows else np.empty(0)
    calm = swing < _STANDING * float(np.ptp(motion))
    return [int(k) * rows for k in np.flatnonzero(calm[1:] & ~calm[:-1]) + 1]


def _delayed(first: str, second: str, one: Array, other: Array, rate: float) -> Iterator[Issue]:
    rows, alike = find_delay(other, one, round(0.2 * rate))
    if alike > _ALIKE and abs(rows) >= 2:
        late, early = (second, first) if rows > 0 else (first, second)
        text = f"follows {early} by {1e3 * abs(rows) / rate:.3g} ms (correlation {alike:.3f})"
        yield Issue("note", "late", f"{late}: {text}", late)
