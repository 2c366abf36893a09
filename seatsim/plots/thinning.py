"""Long channels made short for drawing, and the part of a run that is worth a closer look."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

BINS = 1200
"""Intervals over the width of a panel, of which least and largest value are kept: finer than its pixels."""
CLOSE_UP = 6.0
"""Length in s of a closer look."""
STRIDE = 0.1
"""Raster in s on which a closer look begins."""


class Window(NamedTuple):
    """Part of a run, in s."""

    start: float
    end: float

    def part(self, step: float) -> slice:
        """Return the samples inside, both ends included."""
        return slice(round(self.start / step), round(self.end / step) + 1)

    def __str__(self) -> str:
        """Return the window as a title states it."""
        return f"{self.start:.1f} to {self.end:.1f} s"


def thinned(x: Array, y: Array) -> tuple[Array, Array]:
    """Return a line of at most 2 `BINS` points over the same pixels: extremes are kept, in their order."""
    if len(y) <= 2 * BINS:
        return x, y
    size = -(-len(y) // BINS)
    bins = np.pad(y, (0, -len(y) % size), mode="edge").reshape(-1, size)
    ends = np.sort(np.column_stack([bins.argmin(axis=1), bins.argmax(axis=1)]), axis=1)
    kept = np.minimum(ends + size * np.arange(len(bins))[:, None], len(y) - 1).ravel()
    return x[kept], y[kept]


def eventful(values: Array, step: float) -> Window:
    """Return the window of `CLOSE_UP` seconds in which the RMS is largest, the first of equals."""
    size = round(CLOSE_UP / step)
    if size >= len(values):
        return Window(0.0, (len(values) - 1) * step)
    energy = np.concatenate([[0.0], np.cumsum(values**2)])
    starts = np.arange(0, len(values) - size, max(1, round(STRIDE / step)))
    start = int(starts[np.argmax(energy[starts + size] - energy[starts])])
    return Window(start * step, (start + size) * step)
