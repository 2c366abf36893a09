"""How well a predicted force agrees with a measured one: the figures of the literature."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.schema.arrays import Array

GUARD = 0.05
"""Share of a record's peak force below which a measured force does not count in the mean deviation."""


class Agreement(NamedTuple):
    """Agreement of a predicted force s with a measured one y.

    r2            1 - sum (y - s)^2 / sum (y - mean y)^2
    md            mean of |y - s| / |y|, over the samples where |y| is more than 5 % of its peak
    rmse          sqrt(mean (y - s)^2), N
    fit_percent   100 (1 - ||y - s|| / ||y - mean y||)

    Source: Yu et al. 2019 eqs 6-8 for the first three. Its eq 7 diverges where the measured force crosses zero; the
    guard is ours.
    """

    r2: float
    md: float
    rmse: float
    fit_percent: float


def assess_agreement(measured: Array, predicted: Array) -> Agreement:
    """Return the agreement on one record, arrays of shape (N,) in N; minus infinity for a force that never varies."""
    error = measured - predicted
    spread = float(np.sum((measured - np.mean(measured)) ** 2))
    share = float(np.sum(error**2)) / spread if spread > 0.0 else np.inf
    counted = np.abs(measured) > GUARD * np.max(np.abs(measured))
    deviation = float(np.mean(np.abs(error[counted] / measured[counted]))) if counted.any() else np.inf
    rmse = float(np.sqrt(np.mean(error**2)))
    return Agreement(1.0 - share, deviation, rmse, 100.0 * (1.0 - share**0.5))


def mean_agreement(each: Sequence[Agreement]) -> Agreement:
    """Return the mean of every figure over records, each of which has the same weight."""
    return Agreement(*(float(np.mean(values)) for values in zip(*each, strict=True)))
