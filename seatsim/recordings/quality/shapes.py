"""What the values of a channel look like, whatever they mean: plateaus, flat tops, smallest step, white noise."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.arrays import Array

WINDOW, FEWEST, LEAST_WINDOWS = 0.5, 50, 4
"""Seconds of a window in which noise is measured, its least rows, and least windows of a run."""
PILED = 3.0
"""Ratio of the rows at an extreme to those beside it from which they are piled up there."""
FLICKER = 0.5
"""Least share of rows that differ from the row before where noise exceeds the resolution: white noise of one step gives
three quarters."""


class Level(NamedTuple):
    """RMS of a channel's noise from third and fourth differences, and from fourth ones in calm and lively windows."""

    third: float
    fourth: float
    calm: float
    lively: float


def plateaus(values: Array) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Return length and first row of each stretch of equal values."""
    starts = np.concatenate([[0], np.flatnonzero(np.diff(values)) + 1])
    return np.diff(np.append(starts, len(values))), starts


def flat_tops(values: Array) -> Iterator[tuple[float, int]]:
    """Yield each extreme other than zero at which far more rows stand than in the 2 % of the range beside it.

    Coarse values are compared with the next level: a sine has 2.4 times as many rows at the last one.
    """
    near = max(0.02 * float(np.ptp(values)), 1.5 * quantum(values))
    lengths, starts = plateaus(values)
    # With so many stretches most are one row long, and their median need not be sought.
    usual = 1.0 if 3 * len(starts) > 2 * len(values) else float(np.median(lengths))
    for extreme in (float(np.max(values)), float(np.min(values))):
        at = values == extreme
        rows = int(np.sum(at))
        if rows < 5 * usual:
            continue
        beside = int(np.sum(np.abs(values - extreme) <= near)) - rows
        if extreme != 0.0 and rows >= PILED * beside and np.max(lengths[at[starts]]) >= 3 * usual:
            yield extreme, rows


def quantum(values: Array) -> float:
    """Return the smallest step between two values."""
    return float(np.min(np.diff(np.unique(values)), initial=np.inf))


def flickers(values: Array, rate: float) -> bool:
    """Say whether values change from row to row, as noise makes them, in the calmest fifth of windows too.

    The longest stretch of equal values is left out, as a sensor may be stuck there.
    """
    lengths, starts = plateaus(values)
    longest = int(np.argmax(lengths))
    rest = np.delete(values, slice(starts[longest], starts[longest] + lengths[longest]))
    rows = max(round(WINDOW * rate), FEWEST)
    pieces = rest[: len(rest) // rows * rows].reshape(-1, rows)
    spread = np.std(pieces, axis=1)
    calm = pieces[spread <= np.quantile(spread, 0.2)] if len(pieces) else pieces
    return len(calm) > 0 and float(np.mean(np.diff(calm, axis=1) != 0.0)) > FLICKER


def measure_level(values: Array, rate: float) -> Level:
    """Return the level in the quietest fifth of windows, infinite where there are too few."""
    rows = max(round(WINDOW * rate), FEWEST)
    windows = len(values) // rows
    if windows < LEAST_WINDOWS:
        return Level(np.inf, np.inf, np.inf, np.inf)
    pieces = values[: windows * rows].reshape(windows, rows)
    third, fourth = (
        np.median(np.abs(np.diff(pieces, n, axis=1)), axis=1) / (0.6745 * norm)
        for n, norm in ((3, 20**0.5), (4, 70**0.5))
    )
    quiet, spread = fourth <= np.quantile(fourth, 0.2), np.std(pieces, axis=1)
    calm, lively = spread <= np.quantile(spread, 0.2), spread >= np.quantile(spread, 0.8)
    return Level(*(float(np.mean(each)) for each in (third[quiet], fourth[quiet], fourth[calm], fourth[lively])))
