"""Long signals made short for drawing: fewer points, the part worth a closer look, few items of many."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypeVar

import numpy as np

from seatsim.schema.arrays import Array

T = TypeVar("T")

BINS = 400
"""Intervals over the width of a panel, of which least and largest value are kept: as fine as its points."""


class Window(NamedTuple):
    """Part of a run, in s."""

    start: float
    end: float

    def part(self, step: float) -> slice:
        """Return the samples inside, both ends included, of a signal that is sampled every `step` s from 0."""
        return slice(round(self.start / step), round(self.end / step) + 1)

    def __str__(self) -> str:
        """Return the window as a title states it."""
        return f"{self.start:.1f} to {self.end:.1f} s"


def thin_line(x: Array, y: Array, bins: int = BINS) -> tuple[Array, Array]:
    """Return a line of at most 2 `bins` points that covers the same pixels as (x, y), shape (N,) each.

    The least and the largest value of every interval are kept, in their order: a mean or every n-th sample would hide
    the peaks that a reader looks for.
    """
    if len(y) <= 2 * bins:
        return x, y
    size = -(-len(y) // bins)
    parts = np.pad(y, (0, -len(y) % size), mode="edge").reshape(-1, size)
    ends = np.sort(np.column_stack([parts.argmin(axis=1), parts.argmax(axis=1)]), axis=1)
    # The padding repeats the last sample, which may be an extreme at a place beyond the end.
    kept = np.minimum(ends + size * np.arange(len(parts))[:, None], len(y) - 1).ravel()
    return x[kept], y[kept]


def find_loudest(values: Array, step: float, seconds: float, raster: float) -> Window:
    """Return the window of that many seconds in which sum x^2 is largest, the earliest of equals.

    values: shape (N,), sampled every `step` s from 0; a shorter signal is its own window. It begins at a multiple of
    `raster` s: a close-up looks the same a few samples later, and its title states a round time.
    """
    size, stride = round(seconds / step), max(1, round(raster / step))
    if size >= len(values):
        return Window(0.0, (len(values) - 1) * step)
    energy = np.concatenate([[0.0], np.cumsum(np.square(values))])
    starts = np.arange(0, len(values) - size, stride)
    start = int(starts[np.argmax(energy[starts + size] - energy[starts])])
    return Window(start * step, (start + size) * step)


def spread_evenly(items: Sequence[T], most: int) -> list[T]:
    """Return at most `most` items (2 or more), spread evenly over their order, first and last included."""
    if len(items) <= most:
        return list(items)
    return [items[index * (len(items) - 1) // (most - 1)] for index in range(most)]
