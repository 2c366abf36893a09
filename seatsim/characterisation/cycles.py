"""Steady cycles of a record, as loops of equally many samples."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from seatsim.recordings.bench_tables import BenchRecord
from seatsim.schema.arrays import Array
from seatsim.simulation.damper_bench import SineTest

_BAND = 0.2
"""Half the width, over the amplitude, of the band about mid-stroke that a passage has to cross from side to side."""
_ALIKE = 0.03
"""Largest difference of a steady cycle's amplitude and period from their median, relative."""
_CENTRED = 0.05
"""Largest distance of the middle of a steady cycle from the median of the middles, over the amplitude."""
_LEAST_STEADY = 3
"""Steady cycles that make a record cyclic; two where there are no others."""
_SAMPLES = (64, 2000)
"""Least and most samples of a resampled cycle."""


class Cycle(NamedTuple):
    """One cycle of a record: its ends as rows (with fractions), amplitude and mid-stroke in m."""

    first: float
    last: float
    amplitude: float
    middle: float

    @property
    def rows(self) -> slice:
        """The rows inside."""
        return slice(int(np.ceil(self.first)), int(self.last) + 1)

    @property
    def length(self) -> float:
        """Number of rows, with fractions."""
        return self.last - self.first


def find_cycles(displacement: Array) -> list[Cycle]:
    """Return the cycles of a displacement, shape (N,), from one upward passage of mid-stroke to the next.

    Mid-stroke is halfway between the 1st and the 99th percentile. A passage leads from below a band about it to
    above, so that noise makes none; its instant is where the straight line through its rows meets mid-stroke.
    """
    low, high = (float(q) for q in np.percentile(displacement, (1, 99)))
    centre, amplitude = 0.5 * (low + high), 0.5 * (high - low)
    if amplitude <= 0.0:
        return []
    above, below = displacement > centre + _BAND * amplitude, displacement < centre - _BAND * amplitude
    side = above.astype(np.int8) - below
    outside = np.flatnonzero(side)
    upward = np.flatnonzero((side[outside][:-1] < 0) & (side[outside][1:] > 0))
    instants = [_passage(displacement, outside[k], outside[k + 1], centre) for k in upward]
    return [_cycle(displacement, a, b) for a, b in pairwise(instants)]


def _passage(x: Array, first: int, last: int, centre: float) -> float:
    part, middle = x[first : last + 1], 0.5 * (first + last)
    rows = np.arange(first, last + 1) - middle
    slope = float(rows @ part) / float(rows @ rows)
    return float(np.clip(middle + (centre - np.mean(part)) / slope, first, last)) if slope > 0.0 else middle


def _cycle(x: Array, first: float, last: float) -> Cycle:
    inside = x[int(first) : int(np.ceil(last)) + 1]
    low, high = float(np.min(inside)), float(np.max(inside))
    return Cycle(first, last, 0.5 * (high - low), 0.5 * (high + low))


def select_steady_cycles(cycles: Sequence[Cycle]) -> list[Cycle]:
    """Return the cycles whose amplitude, period and mid-stroke agree with their medians: no ring-up, no ring-down.

    Empty where they are fewer than half of all, or fewer than three (two, where these are all): such a record is not
    cyclic.
    """
    if not cycles:
        return []
    table = np.array([(cycle.amplitude, cycle.length, cycle.middle) for cycle in cycles])
    amplitude, length, middle = np.median(table, axis=0)
    alike = np.abs(table[:, 0] - amplitude) <= _ALIKE * amplitude
    alike &= np.abs(table[:, 1] - length) <= _ALIKE * length
    alike &= np.abs(table[:, 2] - middle) <= _CENTRED * amplitude
    steady = [cycle for cycle, kept in zip(cycles, alike, strict=True) if kept]
    enough = len(steady) >= min(_LEAST_STEADY, max(2, len(cycles)))
    return steady if enough and 2 * len(steady) >= len(cycles) else []


def resample_loops(record: BenchRecord, cycles: Sequence[Cycle], drift: float) -> list[SineTest]:
    """Return cycles of a record as loops of equally many samples, both ends included, by linear interpolation.

    A sample is the mean of the rows that it stands for, and the slope `drift` in N/s of the zero (see `find_drift`) is
    taken from the force of each loop about its middle, so that the loop closes.
    """
    from scipy.ndimage import uniform_filter1d

    least, most = _SAMPLES
    length = float(np.median([cycle.length for cycle in cycles]))
    samples = min(most, max(least, 2 * round(0.5 * length)))
    rows = np.arange(len(record.force), dtype=float)
    width = 2 * int(0.5 * length / samples) + 1
    at = np.linspace([cycle.first for cycle in cycles], [cycle.last for cycle in cycles], samples + 1, axis=1)
    time = (at - at[:, :1]) / record.rate
    measured = (record.displacement, record.velocity, record.force)
    x, v, force = (np.interp(at, rows, uniform_filter1d(y, width)) for y in measured)
    force -= drift * (time - 0.5 * time[:, -1:])
    return [SineTest(*parts) for parts in zip(time, x, v, force, strict=True)]


def find_drift(record: BenchRecord, cycles: Sequence[Cycle]) -> float:
    """Return the slope in N/s of the mean forces of cycles over time, 0 for a single cycle."""
    if len(cycles) < 2:
        return 0.0
    middles = [0.5 * (cycle.first + cycle.last) / record.rate for cycle in cycles]
    return float(np.polyfit(middles, [np.mean(record.force[cycle.rows]) for cycle in cycles], 1)[0])


def average_loops(loops: Sequence[SineTest]) -> SineTest:
    """Return the mean of loops of equally many samples, phase by phase."""
    return SineTest(*(np.mean([loop[part] for loop in loops], axis=0) for part in range(4)))
