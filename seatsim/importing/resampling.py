"""Band-limited interpolation: a windowed sinc, for any ratio of rates and any fraction of a row.

    y(t) = sum_k x_k h(t - t_k) / sum_k h(t - t_k),   h(s) = sinc(2 c s) kaiser(s / W),   2 c = ROLL min(rate, new rate)

so that what lies above the lower of the two Nyquist frequencies is attenuated and not folded. The rows beyond both ends
are mirrored through the end value. A command is a staircase that the controller holds from row to row: it keeps its
levels, and no ripple of the sinc makes a current of them that nobody commanded.
"""

from __future__ import annotations

import numpy as np

from seatsim.schema.arrays import Array

HALF, BETA, ROLL = 32, 9.0, 0.92
"""Zero crossings of the sinc on each side, shape of the Kaiser window (stop band -90 dB), share of the band kept."""
CHUNK = 20_000
HELD = ("current_command", "command_voltage")
"""Channels that hold each value until the next row."""
SAME = 1e-6
"""Fraction of a row by which times may differ from rows, and still need no interpolation."""


def resample(values: Array, start: float, rate: float, times: Array, new_rate: float) -> Array:
    """Return values that begin at `start` with `rate` in Hz at other times, shape (M,), spaced by `new_rate`.

    Times outside the record get its first and last value.
    """
    rows = (times - start) * rate
    near = np.round(rows)
    if rate <= new_rate * (1.0 + 1e-9) and np.max(np.abs(rows - near), initial=0.0) < SAME * max(
        1.0, len(values) * 1e-3
    ):
        return np.asarray(values[np.clip(near.astype(int), 0, len(values) - 1)])
    if np.ptp(values) == 0.0:
        return np.full(len(times), values[0])
    band = ROLL * min(1.0, new_rate / rate) if new_rate < rate else 1.0
    reach = int(np.ceil(HALF / band))
    padded = _extended(values, reach)
    clipped = np.clip(rows, 0.0, len(values) - 1.0)
    parts = [_interpolate(padded, clipped[at : at + CHUNK], reach, band) for at in range(0, len(clipped), CHUNK)]
    return np.concatenate(parts)


def hold(values: Array, start: float, rate: float, times: Array) -> Array:
    """Return at other times, shape (M,), the value of the last row before each; the first and last one outside."""
    rows = np.floor((times - start) * rate + SAME * len(values))
    return np.asarray(values[np.clip(rows.astype(int), 0, len(values) - 1)])


def _extended(values: Array, reach: int) -> Array:
    """Return values continued at both ends, mirrored through the end value, or as the end value where too short."""
    if len(values) <= reach + 1:
        return np.pad(values, reach, mode="edge")
    return np.concatenate([2 * values[0] - values[reach:0:-1], values, 2 * values[-1] - values[-2 : -reach - 2 : -1]])


def _interpolate(padded: Array, rows: Array, reach: int, band: float) -> Array:
    base = np.floor(rows).astype(int)
    taps = np.arange(-reach + 1, reach + 1)
    away = taps[None, :] - (rows - base)[:, None]
    weights = np.sinc(band * away) * np.i0(BETA * np.sqrt(np.maximum(0.0, 1.0 - (away / reach) ** 2)))
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
