"""How much later the clock of one file started than that of another, by cross-correlation of what both measured.

The offset is where the correlation of two channels is greatest, between rows by a parabola.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from seatsim.recordings.quality.relations import band_passed
from seatsim.recordings.recording import COMMANDS
from seatsim.schema.arrays import Array

_SHORTEST = 2.0
"""s; least length of a record that tells an offset."""
_LEAST = 0.5
"""Correlation below which two channels do not tell an offset."""
_HALF, _BETA, _ROLL = 32, 9.0, 0.92
"""Zero crossings of the sinc on each side, shape of the Kaiser window (stop band -90 dB), share of the band kept."""
_CHUNK = 20_000
_SAME = 1e-6
"""Fraction of a row by which times may differ from rows, and still need no interpolation."""


class Channel(NamedTuple):
    """A channel on its own time base."""

    values: Array
    start: float
    rate: float


class _Offset(NamedTuple):
    """Seconds to add to the times of the second file; by which channel, and how alike it is in both."""

    seconds: float
    channel: str
    correlation: float


def estimate_offset(first: Mapping[str, Channel], second: Mapping[str, Channel]) -> _Offset | None:
    """Return the offset of the second group's clock, by the shared channel that is most alike; None without any."""
    shared = (_compare(first[name], second[name], name) for name in first if name in second)
    alike = [offset for offset in shared if offset is not None and offset.correlation >= _LEAST]
    return max(alike, key=lambda offset: offset.correlation, default=None)


def describe_offset(label: str, reference: str, found: _Offset | None) -> str:
    """Return a sentence on the offset of a group against another one."""
    if found is None:
        seen = f"shares no channel with {reference} that shows an offset"
        return f"{label}: {seen}; its times are taken as they are, or state align"
    by = f"by cross-correlation of {found.channel} ({found.correlation:.3f})"
    return f"{label}: moved against {reference} by {found.seconds:+.5g} s, {by}"


def _compare(one: Channel, other: Channel, name: str) -> _Offset | None:
    """Return the offset between two records of a channel, on the time base of the slower one."""
    from scipy.signal import correlate, correlation_lags

    rate = min(one.rate, other.rate)
    a, b = (_even(channel, rate) for channel in (one, other))
    if min(len(a), len(b)) < _SHORTEST * rate or not a.std() or not b.std():
        return None
    values = correlate(b, a, method="fft")
    at = int(np.argmax(values))
    # Values that are `late` in the second are at the same instant as those of the first.
    late = (correlation_lags(len(b), len(a))[at] + _vertex(values, at)) / rate
    alike = float(values[at] / (np.linalg.norm(a) * np.linalg.norm(b)))
    return _Offset(float(one.start - other.start - late), name, alike)


def _even(channel: Channel, rate: float) -> Array:
    rows = int((len(channel.values) - 1) / channel.rate * rate) + 1
    times = channel.start + np.arange(rows) / rate
    values = resample(channel.values, channel.start, channel.rate, times, rate)
    return band_passed(values - float(np.mean(values)), rate, 0.2, 0.4 * rate)


def _vertex(values: Array, at: int) -> float:
    """Return the vertex of the parabola through a peak and its neighbours, in rows from the peak."""
    if not 0 < at < len(values) - 1:
        return 0.0
    before, peak, after = values[at - 1 : at + 2]
    bend = before - 2.0 * peak + after
    return float(0.5 * (before - after) / bend) if bend else 0.0


def resample(values: Array, start: float, rate: float, times: Array, new_rate: float) -> Array:
    """Return values that begin at `start` with `rate` in Hz at other times, shape (M,), spaced by `new_rate`.

    Times outside the record get its first and last value.
    """
    rows = (times - start) * rate
    near = np.round(rows)
    off = np.max(np.abs(rows - near), initial=0.0)
    if rate <= new_rate * (1.0 + 1e-9) and off < _SAME * max(1.0, len(values) * 1e-3):
        return np.asarray(values[np.clip(near.astype(int), 0, len(values) - 1)])
    if np.ptp(values) == 0.0:
        return np.full(len(times), values[0])
    band = _ROLL * min(1.0, new_rate / rate) if new_rate < rate else 1.0
    reach = int(np.ceil(_HALF / band))
    # Mirrored through the end value, or continued as it where there are too few values.
    mirrored: dict[str, Any] = {"mode": "reflect", "reflect_type": "odd"}
    padded = np.pad(values, reach, **(mirrored if len(values) > reach + 1 else {"mode": "edge"}))
    clipped = np.clip(rows, 0.0, len(values) - 1.0)
    parts = [_interpolate(padded, clipped[at : at + _CHUNK], reach, band) for at in range(0, len(clipped), _CHUNK)]
    return np.concatenate(parts)


def hold(values: Array, start: float, rate: float, times: Array) -> Array:
    """Return at other times, shape (M,), the value of the last row before each; the first and last one outside."""
    rows = np.floor((times - start) * rate + _SAME * len(values))
    return np.asarray(values[np.clip(rows.astype(int), 0, len(values) - 1)])


def _interpolate(padded: Array, rows: Array, reach: int, band: float) -> Array:
    base = np.floor(rows).astype(int)
    taps = np.arange(-reach + 1, reach + 1)
    away = taps[None, :] - (rows - base)[:, None]
    weights = np.sinc(band * away) * np.i0(_BETA * np.sqrt(np.maximum(0.0, 1.0 - (away / reach) ** 2)))
    taken = padded[base[:, None] + taps[None, :] + reach]
    return np.asarray(np.sum(weights * taken, axis=1) / np.sum(weights, axis=1))


def evened(name: str, values: Array, times: Array, grid: Array) -> Array:
    """Return unevenly spaced values of a channel on an even grid: held, or by cubic splines through them.

    Of rows with the same time the first one counts.
    """
    from scipy.interpolate import CubicSpline

    if name in COMMANDS:
        return np.asarray(values[np.clip(np.searchsorted(times, grid, side="right") - 1, 0, None)])
    later = np.concatenate([[True], np.diff(times) > 0.0])
    return np.asarray(CubicSpline(times[later], values[later])(grid), dtype=np.float64)
