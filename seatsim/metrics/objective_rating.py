"""How alike two curves are: corridor, phase, magnitude and slope as ISO/TS 18571:2014 rates them.

The equations were recalled, and agree with the package objective-rating-metrics 1.3 at 10 kHz.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seatsim.compilation.cached import compiled
from seatsim.metrics.motion import as_pair, require_finite, require_positive
from seatsim.schema.arrays import Array
from seatsim.schema.content import written
from seatsim.schema.errors import InputError

_INNER, _OUTER = 0.05, 0.5
"""Half widths of the corridors, as shares of the largest magnitude of the reference."""
_LARGEST_SHIFT = 0.2
"""Share of the length by which one curve is shifted against the other at most; such a shift is rated 0."""
_EQUAL = 1e-9
"""Correlations that differ by less are equal; rounding must not choose among the periods of a sine."""
_BAND = 0.1
"""Share of the length by which the warping leads or trails at most."""
_LARGEST_MAGNITUDE_ERROR, _LARGEST_SLOPE_ERROR = 0.5, 2.0
"""Relative errors that are rated 0."""
_AVERAGED = 4e-4
"""s; half of the nine samples at 10 kHz over which a slope is averaged."""
_MOST_ROWS = 6000
"""Samples that are warped at most: one minute at 100 Hz."""


class ObjectiveRating(NamedTuple):
    """Ratings of a curve against a reference, from 0 to 1, and the time in s by which the curve is late."""

    corridor: float
    phase: float
    magnitude: float
    slope: float
    shift: float

    @property
    @written()
    def overall(self) -> float:
        """`0.4 corridor + 0.2 phase + 0.2 magnitude + 0.2 slope`."""
        return 0.4 * self.corridor + 0.2 * (self.phase + self.magnitude + self.slope)


def rate_agreement(reference: ArrayLike, curve: ArrayLike, sample_rate: float) -> ObjectiveRating:
    """Return the objective rating of a curve C against a reference T of N samples, after ISO/TS 18571:2014 (recalled).

    - corridor: mean of `clip((b - |C - T|) / (b - a), 0, 1)^2`, where a and b are 5 % and 50 % of max|T|.
    - phase: the shift n of at most 0.2 N samples, either way, at which both curves correlate best (Pearson, over the
      samples that overlap, the least shift of equal ones): `1 - n / (0.2 N)`.
    - magnitude: of the shifted curves, warped in time such that the sum of `(C - T)^2` is least, by less than 0.1 of
      their length: `1 - e / 0.5`, at least 0, with `e = sum|C - T| / sum|T|` along the warping.
    - slope: of the shifted curves' slopes, averaged over nine samples at 10 kHz: `1 - e / 2`, at least 0, with
      `e = sum|C' - T'| / sum|T'|`.

    The standard samples at 10 kHz. Here the samples are taken as they are: slopes are averaged over the same time,
    0.9 ms, and beyond 6000 samples the curves are warped as means of neighbours.

    Args:
        reference: T, what was measured, shape (N,), N >= 5.
        curve: C, what was simulated, shape (N,), in the unit of the reference.
        sample_rate: samples per second.

    Raises:
        InputError: the curves are no signals of one length, too short or not finite, the reference is zero throughout,
            or the rate is not positive.
    """
    T, C = as_pair(reference, curve, ("reference", "curve"))
    rate = require_positive(sample_rate, "sample_rate")
    if T.size < 5 or not np.any(require_finite(T, "reference")):
        raise InputError("reference: must have at least 5 samples, of which one is not 0")
    corridor, shift = _rate_corridor(T, require_finite(C, "curve")), _find_shift(T, C)
    phase = max(1.0 - abs(shift) / (_LARGEST_SHIFT * T.size), 0.0)
    # A curve that is late loses its first samples, and the reference its last ones.
    late, early = max(shift, 0), max(-shift, 0)
    T, C = T[early : T.size - late], C[late : C.size - early]
    return ObjectiveRating(corridor, phase, _rate_magnitude(T, C), _rate_slope(T, C, rate), shift / rate)


def _rate_corridor(T: Array, C: Array) -> float:
    inner, outer = _INNER * np.max(np.abs(T)), _OUTER * np.max(np.abs(T))
    return float(np.mean(np.clip((outer - np.abs(C - T)) / (outer - inner), 0.0, 1.0) ** 2))


def _find_shift(T: Array, C: Array) -> int:
    """Return by how many samples C is late, the least such number at which the correlation is largest."""
    most = int(_LARGEST_SHIFT * T.size)
    found = _correlate(T, C, most), _correlate(C, T, most)
    best = max(np.max(each) for each in found) - _EQUAL
    late, early = (int(np.argmax(each >= best)) if np.max(each) >= best else T.size for each in found)
    return late if late <= early else -early


def _correlate(T: Array, C: Array, most: int) -> Array:
    """Return Pearson's correlation of the first samples of T with C from 0 to `most` samples on, 0 where one rests."""
    # Imported here: it takes long, and what imports this module rarely rates.
    from scipy.signal import correlate

    T, C = T - np.mean(T), C - np.mean(C)
    overlap = T.size - np.arange(most + 1)
    sums = correlate(C, T, "full", "fft")[T.size - 1 : T.size + most]
    before = np.array([np.concatenate([[0.0], np.cumsum(each)]) for each in (T, T**2)])[:, overlap]
    behind = np.array([np.sum(each) - np.concatenate([[0.0], np.cumsum(each)])[: most + 1] for each in (C, C**2)])
    variances = [square - total**2 / overlap for total, square in (before, behind)]
    # What rounding leaves of a constant is not its variance.
    moves = (variances[0] > _EQUAL * before[1]) & (variances[1] > _EQUAL * behind[1])
    scale = np.sqrt(np.where(moves, variances[0] * variances[1], np.inf))
    return np.asarray((sums - before[0] * behind[0] / overlap) / scale)


def _rate_magnitude(T: Array, C: Array) -> float:
    together = math.ceil(T.size / _MOST_ROWS)
    rows = T.size // together
    T, C = (np.mean(each[: rows * together].reshape(rows, together), axis=1) for each in (T, C))
    deviation, size = compiled(_warp, ())(T, C, math.ceil(_BAND * rows))
    return _rate(deviation, size, _LARGEST_MAGNITUDE_ERROR)


def _warp(T: Array, C: Array, band: int) -> tuple[float, float]:
    """Return the sums of |C - T| and |T| along the warping of least squares that leads or trails by less than `band`.

    Dynamic time warping: the best way to a pair of samples is the best one to one of the three pairs before it, and its
    sums are carried along, so that no way need be traced back.
    """
    n = T.size
    cost, deviation, size = np.full(n + 1, np.inf), np.zeros(n + 1), np.zeros(n + 1)
    cost[0] = 0.0
    for i in range(n):
        first, last = max(i - band + 1, 0), min(i + band, n)
        # What stands at the places `first` and before is of the last row and to the left and above of this one's.
        above, above_deviation, above_size = cost[first], deviation[first], size[first]
        cost[first] = np.inf
        for j in range(first, last):
            least, left_deviation, left_size = above, above_deviation, above_size
            above, above_deviation, above_size = cost[j + 1], deviation[j + 1], size[j + 1]
            if above < least:
                least, left_deviation, left_size = above, above_deviation, above_size
            if cost[j] < least:
                least, left_deviation, left_size = cost[j], deviation[j], size[j]
            away = abs(C[j] - T[i])
            cost[j + 1] = least + away * away
            deviation[j + 1], size[j + 1] = left_deviation + away, left_size + abs(T[i])
    return deviation[n], size[n]


def _rate_slope(T: Array, C: Array, rate: float) -> float:
    slopes = [_average(np.gradient(each), round(_AVERAGED * rate)) for each in (T, C)]
    return _rate(float(np.sum(np.abs(slopes[1] - slopes[0]))), float(np.sum(np.abs(slopes[0]))), _LARGEST_SLOPE_ERROR)


def _average(values: Array, half: int) -> Array:
    """Return means over `half` samples to either side, over fewer at the ends, where a side is short of them."""
    place = np.arange(values.size)
    reach = np.minimum(half, np.minimum(place, place[::-1]))
    total = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray((total[place + reach + 1] - total[place - reach]) / (2 * reach + 1))


def _rate(deviation: float, size: float, largest: float) -> float:
    """Return the rating of a deviation of curves of such a size: 1 where there is none, 0 from the largest on."""
    return max(1.0 - deviation / (largest * size), 0.0) if size > 0.0 else float(deviation == 0.0)
