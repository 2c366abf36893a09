"""What is wrong with the rows of a file: times that jump, repeat or run back, and distances that are coarse."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from seatsim.importing.time_axis import Axis
from seatsim.recordings.quality.damage import Doubter
from seatsim.recordings.quality.issue import Issue
from seatsim.schema.arrays import Array

SLOWEST, FASTEST = 5.0, 200_000.0
"""Hz; rates of loggers of vibration lie between."""
COARSE_ROAD = 0.1
"""m; distance of rows above which a tyre feels waves that a road does not hold."""


def doubt_time(axis: Axis, channel: str) -> Iterator[Issue]:
    """Yield what is wrong with a column of time."""
    doubter = Doubter(channel, None)
    if axis.backwards:
        first = int(axis.breaks[0])
        text = f"runs back {axis.backwards} times, the first at row {first}; gaps: split makes runs of the parts"
        yield doubter.say("warning", "restart", text)
    if axis.repeated:
        text = f"{axis.repeated} rows repeat the time before; gaps: fill leaves the repeats out"
        yield doubter.say("warning", "repeated", text)
    if axis.lost:
        first = next(int(row) for row in axis.breaks if axis.times[row] - axis.times[row - 1] > 0.0)
        text = f"{axis.lost} rows are missing, the first at {axis.times[first - 1]:.6g} s; gaps: split or gaps: fill"
        yield doubter.say("warning", "gap", text)
    if axis.resolution:
        yield doubter.say("warning", "rounded", _say_rounded(axis))
    elif not axis.is_even:
        yield doubter.say(
            "warning", "uneven", f"rows are not evenly spaced; they are interpolated at {axis.rate:.5g} Hz"
        )
    if not SLOWEST <= axis.rate <= FASTEST:
        text = f"rows are {1.0 / axis.rate:.4g} s apart, {axis.rate:.4g} Hz; is its unit another one, such as ms?"
        yield doubter.say("warning", "rate", text)


def _say_rounded(axis: Axis) -> str:
    """Return what stamps that are about as coarse as the rows, or coarser, say of the rate."""
    steps = f"its stamps go in steps of {axis.resolution:.4g} s, about as coarse as the rows or coarser"
    if axis.is_even:
        return f"{steps}; the rate is estimated as {axis.rate:.6g} Hz: state it by sample_rate in the map, or by --rate"
    return f"{steps}, and the rows are not even by them; state the rate by sample_rate in the map, or by --rate"


def doubt_distance(along: Array, channel: str) -> Iterator[Issue]:
    """Yield what the rows of a road cannot show."""
    step = float(np.median(np.diff(along)))
    if step > COARSE_ROAD:
        text = f"{channel}: rows are {step:.3g} m apart; waves shorter than {2.0 * step:.3g} m are missing"
        yield Issue("note", "coarse", text, channel)
    if np.ptp(np.diff(along)) > 0.01 * step:
        yield Issue("warning", "uneven", f"{channel}: rows are not evenly spaced along the road", channel)
