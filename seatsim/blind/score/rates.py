"""Rates of what is right, and figures of stated probabilities."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.content import written

_BINS = 10
"""Of the reliability table: each holds a tenth of all probabilities, 24 for each case."""
_Z_95 = 1.96
"""Standard normal quantile of a two-sided 95 % interval."""


class Rate(NamedTuple):
    """How many of how many, with a 95 % Wilson interval."""

    right: int
    total: int

    @property
    @written("share")
    def value(self) -> float:
        """Share that is right; NaN of none."""
        return self.right / self.total if self.total else math.nan

    @property
    @written()
    def interval(self) -> tuple[float, float]:
        """Wilson (1927): `(p + z^2/2n -+ z sqrt(p(1-p)/n + z^2/4n^2)) / (1 + z^2/n)`; it holds for few cases too."""
        if not self.total:
            return (math.nan, math.nan)
        z, n, p = _Z_95, self.total, self.right / self.total
        centre = p + z * z / (2 * n)
        half = z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
        return (max((centre - half) / (1 + z * z / n), 0.0), min((centre + half) / (1 + z * z / n), 1.0))


def count_true(flags: Sequence[bool]) -> Rate:
    """Return how many flags are set."""
    return Rate(sum(bool(flag) for flag in flags), len(flags))


@dataclass(frozen=True)
class Bin:
    """A bin of the reliability table: stated mean, share that came true, how many, from and to."""

    stated: float
    true: float
    count: int
    low: float
    high: float


def reliability(stated: NDArray[np.float64], true: NDArray[np.bool_]) -> list[Bin]:
    """Return bins of equal mass of probabilities and of what came true, shape (n,) each.

    Sorted by what was stated; ties stay in their order. Equal mass, since most probabilities lie near zero and bins of
    equal width would hold next to nothing.
    """
    order = np.argsort(stated, kind="stable")
    return [_bin(stated[part], true[part]) for part in np.array_split(order, _BINS) if part.size]


def _bin(stated: NDArray[np.float64], true: NDArray[np.bool_]) -> Bin:
    return Bin(float(np.mean(stated)), float(np.mean(true)), stated.size, float(np.min(stated)), float(np.max(stated)))


def calibration_error(table: Sequence[Bin]) -> float:
    """Return the expected calibration error: mean over all of |stated - true| by bin (Naeini et al. 2015)."""
    total = sum(b.count for b in table)
    return sum(b.count * abs(b.stated - b.true) for b in table) / total if total else math.nan


def brier_score(stated: NDArray[np.float64], true: NDArray[np.bool_]) -> float:
    """Return the mean squared difference of probability and truth (Brier 1950)."""
    return float(np.mean((stated - true) ** 2)) if stated.size else math.nan
