"""Channels of a run from the columns of a group: converted to SI units and corrected, as the map states them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatsim.importing.alignment import Channel, evened
from seatsim.importing.clocks import Clocked
from seatsim.importing.doubts import doubt_channel
from seatsim.importing.import_map import PRIMITIVE, ChannelMap
from seatsim.importing.names import quantity_of
from seatsim.importing.signals import LISTED
from seatsim.importing.time_axis import Axis
from seatsim.recordings.quality.damage import find_spikes
from seatsim.recordings.quality.issue import Issue
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, nearest, placed
from seatsim.schema.text import name_some
from seatsim.schema.units import conversion

_SLOWER = 0.9
"""Share of the rows of its table below which a channel has a rate of its own."""


def make_channel(
    name: str, entry: ChannelMap, clocked: Clocked, wanted: str, notes: list[str]
) -> tuple[Channel, list[Issue]]:
    """Return a channel in the wanted unit on the even time base of its group, with the doubts that the map leaves.

    Raises:
        InputError: a column is not there, a unit is not stated or wrong, or rows hold no number.
    """
    values = _column(name, entry, entry.column, clocked)
    if entry.minus is not None:
        values = values - _column(name, entry, entry.minus, clocked)
    values = _in_si(name, entry, values, clocked, wanted)
    rate = clocked.axis.rate
    # What is still to be differentiated is a position or a velocity.
    quantity = {0: quantity_of(name), 1: None, 2: "displacement"}[entry.differentiate]
    doubts = [issue for issue in doubt_channel(name, values, rate, quantity) if not _mends(entry, issue)]
    channel = _evened(name, *_filled(name, entry, values, clocked, notes), clocked.axis)
    return channel._replace(values=_corrected(name, channel.values, entry, channel.rate, notes)), doubts


def no_column(name: str, column: str | None, group: str | None, clocked: Sequence[Clocked]) -> InputError:
    """Return the error of a column that no group holds."""
    names = list(dict.fromkeys(signal.name for each in clocked for signal in each.group.signals))
    where = f" of group '{group}'" if group else ""
    hint = nearest(column, names)
    return InputError(f"channels.{name}: no column '{column}'{where}{hint}; columns are {name_some(names, LISTED)}")


def _column(name: str, entry: ChannelMap, column: str | None, clocked: Clocked) -> Array:
    signal = clocked.group.find(column or "")
    if signal is None:
        raise no_column(name, column, entry.group, [clocked])
    return signal.values


def _in_si(name: str, entry: ChannelMap, values: Array, clocked: Clocked, wanted: str) -> Array:
    base = PRIMITIVE[wanted, entry.differentiate] if entry.differentiate else wanted
    signal = clocked.group.find(entry.column or "")
    unit = entry.unit or (signal.unit if signal else "") or (base if entry.column == name else "")
    if not unit:
        raise InputError(
            f"channels.{name}: neither the map nor the file states the unit of '{entry.column}'; write unit"
        )
    with placed(f"channels.{name}.unit"):
        found = conversion(unit, base)
    return found.factor * (entry.sign * entry.scale * values + entry.offset) + found.zero


def _mends(entry: ChannelMap, issue: Issue) -> bool:
    """Say whether the map corrects what is doubted."""
    mended = {"gravity": entry.remove_mean, "offset": entry.remove_mean, "missing": entry.fill, "spikes": entry.despike}
    return mended.get(issue.kind, False)


def _filled(name: str, entry: ChannelMap, values: Array, clocked: Clocked, notes: list[str]) -> tuple[Array, Array]:
    """Return the rows that hold a number, with their times; inner ones that do not are interpolated if stated.

    A channel that is slower than its table holds a number in every n-th row; it keeps these as its own rows.

    Raises:
        InputError: rows hold no number and the map does not say `fill`.
    """
    there = np.flatnonzero(np.isfinite(values))
    if len(there) == len(values):
        return values, clocked.axis.times
    if len(there) < 2:
        raise InputError(f"{clocked.label}, {name}: column '{entry.column}' holds no numbers")
    every = np.diff(there)
    if every[0] > 1 and np.all(every == every[0]):
        return values[there], clocked.axis.times[there]
    inner = slice(int(there[0]), int(there[-1]) + 1)
    missing = int(np.sum(np.isnan(values[inner])))
    if missing and not entry.fill:
        at = f"the first after {clocked.axis.times[there[np.argmax(every > 1)]]:.5g} s"
        raise InputError(
            f"{clocked.label}, {name}: {missing} rows hold no number, {at}; fill: true in the map interpolates them"
        )
    if missing:
        notes.append(f"{name}: {missing} rows that held no number are interpolated")
    rows = np.arange(len(values))
    return np.interp(rows, there, values[there])[inner], clocked.axis.times[inner]


def _evened(name: str, values: Array, times: Array, axis: Axis) -> Channel:
    """Return values on an even time base, with their own rate."""
    start, rate = float(times[0]), axis.rate
    share = (axis.times[-1] - axis.times[0]) / (times[-1] - start) * (len(times) - 1) / (len(axis.times) - 1)
    if share < _SLOWER:  # a slow channel in a fast table
        rate *= float(share)
    if axis.is_even:
        return Channel(values, start, rate)
    grid = start + np.arange(int((times[-1] - times[0]) * rate + 1e-6) + 1) / rate
    return Channel(evened(name, values, times, grid), start, rate)


def _corrected(name: str, values: Array, entry: ChannelMap, rate: float, notes: list[str]) -> Array:
    """Return values without spikes and without their mean, differentiated, as the map says."""
    if entry.despike and len(rows := find_spikes(values)):
        values = values.copy()
        values[rows] = 0.5 * (values[rows - 1] + values[rows + 1])
        notes.append(f"{name}: {len(rows)} spikes are interpolated")
    for _ in range(entry.differentiate):
        values = np.gradient(values, 1.0 / rate)
    if not entry.remove_mean:
        return values
    notes.append(f"{name}: its mean of {float(np.mean(values)):.4g} is taken out")
    return values - float(np.mean(values))
