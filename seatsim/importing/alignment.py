"""How much later the clock of one file started than that of another, by cross-correlation of what both measured.

The offset is where the correlation of two channels is greatest, between rows by a parabola. Its uncertainty is the
standard error of the offsets that parts of the record show by themselves, and at least a tenth of a row.
"""

from collections.abc import Mapping
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from seatsim.recordings.quality.relations import band_passed
from seatsim.recordings.recording import ACCELEROMETERS
from seatsim.schema.arrays import Array

_PARTS, _SHORTEST = 6, 2.0
"""Parts of a record in which the offset is estimated again, and their least length in s."""
_LEAST = 0.5
"""Correlation below which two channels do not tell an offset."""
_AHEAD = 0.2
"""s by which the offset of a part may differ from that of the whole."""
_DRIFT = 4.0
"""Standard errors by which the last part may differ from the first, before the clocks run apart."""
_RELATED = (("current_command", "coil_current"), *combinations(ACCELEROMETERS, 2))
"""Channels that follow each other, though not at once: their own lag is taken into the offset."""
_OWN_LAG, _UNCLEAR = 0.01, 0.05
"""s of uncertainty that a lag between related channels adds, and up to which it may be all that there is."""
_HALF, _BETA, _ROLL = 32, 9.0, 0.92
"""Zero crossings of the sinc on each side, shape of the Kaiser window (stop band -90 dB), share of the band kept."""
_CHUNK = 20_000
HELD = ("current_command", "command_voltage")
"""Channels that hold each value until the next row."""
_SAME = 1e-6
"""Fraction of a row by which times may differ from rows, and still need no interpolation."""


class Channel(NamedTuple):
    """A channel on its own time base."""

    values: Array
    start: float
    rate: float


class _Offset(NamedTuple):
    """Seconds to add to the times of the second file, with a standard error; by which channels, and how alike."""

    seconds: float
    error: float
    first: str
    second: str
    correlation: float
    drift: float | None = None

    @property
    def is_clear(self) -> bool:
        """Say whether this is an offset of clocks, and not the lag of a channel behind another one."""
        return self.first == self.second or abs(self.seconds) > _UNCLEAR


def estimate_offset(first: Mapping[str, Channel], second: Mapping[str, Channel]) -> _Offset | None:
    """Return the offset of the second group's clock, by the pair of channels that are most alike; None without any."""
    pairs = [(name, name, 0.0) for name in first if name in second]
    if not pairs:
        both = (pair for one, other in _RELATED for pair in ((one, other), (other, one)))
        pairs = [(a, b, _OWN_LAG) for a, b in both if a in first and b in second]
    found = [offset for pair in pairs if (offset := _of_pair(first[pair[0]], second[pair[1]], pair)) is not None]
    best = max(found, key=lambda offset: abs(offset.correlation), default=None)
    return best if best is not None and abs(best.correlation) >= _LEAST else None


def describe_offset(label: str, reference: str, found: _Offset | None) -> str:
    """Return a sentence on the offset of a group against another one."""
    if found is None:
        return f"{label}: shares no channel with {reference} that shows an offset; its times are taken as they are"
    by = found.first if found.first == found.second else f"{found.second} and {found.first}"
    seen = f"{found.seconds:+.5g} s (+- {found.error:.2g} s), by cross-correlation of {by} ({found.correlation:.3f})"
    if not found.is_clear:
        return f"{label}: {seen} may be the lag between the two; its times are taken as they are, or state align"
    drift = "" if found.drift is None else f"; the clocks run apart by {found.drift:.2g} s over the record"
    return f"{label}: moved against {reference} by {seen}{drift}"


def _of_pair(one: Channel, other: Channel, pair: tuple[str, str, float]) -> _Offset | None:
    """Return the offset between two channels, on a time base of the slower one that is fine enough."""
    rate = min(one.rate, other.rate)
    a, b = (_even(channel, rate) for channel in (one, other))
    if min(len(a), len(b)) < _SHORTEST * rate or not a.std() or not b.std():
        return None
    lag, correlation = _lag(a, b, rate, None)
    # Values that are `lag` later in the second are at the same instant as those of the first.
    seconds = one.start - other.start - lag
    parts = _parts(a, b, rate, lag)
    error = max(float(np.std(parts)) / np.sqrt(len(parts)) if len(parts) > 1 else 0.5 / rate, 0.1 / rate, pair[2])
    drift = float(np.polyfit(np.arange(len(parts)), parts, 1)[0]) * (len(parts) - 1) if len(parts) > 3 else 0.0
    apart = drift if abs(drift) > _DRIFT * max(error, 0.2 / rate) else None
    return _Offset(seconds, error, pair[0], pair[1], correlation, apart)


def _even(channel: Channel, rate: float) -> Array:
    rows = int((len(channel.values) - 1) / channel.rate * rate) + 1
    times = channel.start + np.arange(rows) / rate
    values = resample(channel.values, channel.start, channel.rate, times, rate)
    return band_passed(values - float(np.mean(values)), rate, 0.2, 0.4 * rate)


def _lag(a: Array, b: Array, rate: float, about: float | None) -> tuple[float, float]:
    """Return by how many s the second is later, near a given lag where there is one, and their correlation there."""
    from scipy.signal import correlate, correlation_lags

    rows, values = correlation_lags(len(b), len(a)), correlate(b, a, method="fft")
    if about is not None:
        near = np.abs(rows / rate - about) <= _AHEAD
        rows, values = rows[near], values[near]
    at = int(np.argmax(values))
    return (rows[at] + _vertex(values, at)) / rate, float(values[at] / (np.linalg.norm(a) * np.linalg.norm(b)))


def _vertex(values: Array, at: int) -> float:
    """Return the vertex of the parabola through a peak and its neighbours, in rows from the peak."""
    if not 0 < at < len(values) - 1:
        return 0.0
    before, peak, after = values[at - 1 : at + 2]
    bend = before - 2.0 * peak + after
    return float(0.5 * (before - after) / bend) if bend else 0.0


def _parts(a: Array, b: Array, rate: float, lag: float) -> Array:
    """Return the lags of parts of the overlap, each by itself."""
    shift = round(lag * rate)
    begin, end = max(0, -shift), min(len(a), len(b) - shift)
    count = min(_PARTS, int((end - begin) / (_SHORTEST * rate)))
    found = []
    for edges in np.array_split(np.arange(begin, max(begin, end)), max(count, 1)):
        one, other = a[edges], b[edges + shift] if len(edges) else a[:0]
        if len(edges) > _SHORTEST * rate * 0.9 and one.std() > 0.1 * a.std() and other.std() > 0.1 * b.std():
            found.append(_lag(one, other, rate, 0.0)[0] + shift / rate)
    return np.array(found)


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

    if name in HELD:
        return np.asarray(values[np.clip(np.searchsorted(times, grid, side="right") - 1, 0, None)])
    later = np.concatenate([[True], np.diff(times) > 0.0])
    return np.asarray(CubicSpline(times[later], values[later])(grid), dtype=np.float64)
