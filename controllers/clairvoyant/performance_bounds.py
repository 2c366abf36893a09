"""What comes out: the bound of each weight, and the run that comes close to it, as curves over travel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from seatsim.schema.arrays import Array
from seatsim.schema.content import Unwritten, written


@dataclass(frozen=True)
class ClairvoyantBounds:
    """Bounds and runs of an ideal semi-active damper on one seat and floor, one for each weight; shape (K,) each.

    The criterion is J = aw^2 + weight x^2 with the RMS Wk-weighted acceleration of the driver aw in m/s^2 and the RMS
    travel x in m. No force within the damper's envelope has a J below `lower`; that of `force` (K, N), in N, held over
    `step` seconds each, has the `acceleration` and the `travel`.
    """

    weights: Array
    lower: Array
    acceleration: Array
    travel: Array
    force: Unwritten[Array]
    step: Unwritten[float]

    @property
    def reached(self) -> Array:
        """J of the runs, shape (K,)."""
        squares: Array = self.acceleration**2 + self.weights * self.travel**2
        return squares

    @property
    @written()
    def width(self) -> Array:
        """sqrt(J reached / J bound) - 1, shape (K,): what is not known of the best damper."""
        ratio: Array = np.sqrt(self.reached / self.lower) - 1
        return ratio

    def bound(self, travel: ArrayLike) -> Array:
        """Return the aw in m/s^2 below which no damper comes at an RMS travel in m; the shape of `travel`."""
        x = np.asarray(travel, dtype=np.float64)[..., None]
        found: Array = np.sqrt(np.maximum(0.0, np.max(self.lower - self.weights * x**2, axis=-1)))
        return found

    def best(self, travel: ArrayLike) -> Array:
        """Return the aw in m/s^2 of the runs at an RMS travel in m, linear between them; NaN short of the shortest."""
        order = np.argsort(self.travel)
        lowest = np.minimum.accumulate(self.acceleration[order])
        found: Array = np.interp(np.asarray(travel), self.travel[order], lowest, left=np.nan)
        return found
