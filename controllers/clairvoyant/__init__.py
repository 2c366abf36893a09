"""The clairvoyant bracket: between what no semi-active damper can do better and what one could have done."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seatsim.schema.registry import register

if TYPE_CHECKING:
    from seatsim.scenario.scenario import Scenario

__all__ = ["WEIGHTS", "Bracket", "clairvoyant"]

Array = NDArray[np.float64]
WEIGHTS = tuple(float(w) ** 2 for w in np.geomspace(12.0, 150.0, 7))
"""Weights of the squared travel in 1/s^4, from a soft seat to short travel."""
HOLD = 0.005
"""s; the force is held so long."""


@register("bracket", "clairvoyant", None)
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
    force: Array
    step: float

    @classmethod
    def of(cls, scenario: Scenario, progress: Callable[[str], None] = lambda text: None) -> ClairvoyantBounds:
        """Return the bracket of a scenario's seat, damper and floor."""
        return clairvoyant(scenario, progress=progress)

    @property
    def reached(self) -> Array:
        """J of the runs, shape (K,)."""
        squares: Array = self.acceleration**2 + self.weights * self.travel**2
        return squares

    @property
    def width(self) -> Array:
        """sqrt(J reached / J bound) - 1, shape (K,): what is not known of the best damper."""
        ratio: Array = np.sqrt(self.reached / self.lower) - 1
        return ratio

    def as_dict(self) -> dict[str, list[float]]:
        """Return the curves as lists, without the forces."""
        curves = {name: getattr(self, name) for name in ("weights", "lower", "acceleration", "travel", "width")}
        return {name: [float(value) for value in curve] for name, curve in curves.items()}

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


def clairvoyant(
    scenario: Scenario,
    weights: ArrayLike = WEIGHTS,
    hold: float = HOLD,
    progress: Callable[[str], None] = lambda text: None,
) -> ClairvoyantBounds:
    """Return the bracket of a scenario's seat, damper and floor; see docs/bracket.md for method and validity.

    Args:
        scenario: its law, coil rate and sample times play no part.
        weights: of the squared travel in 1/s^4, above 0.
        hold: time in s over which a force is held, a multiple of `solver.step`.
        progress: is called with what is being done.

    Raises:
        InputError: the scenario has no seat or one that is not linear, its damper is not dissipative, or a number is
            out of its range.
    """
    from controllers.clairvoyant.solve import solve

    return solve(scenario, np.asarray(weights, dtype=np.float64), hold, progress)
