"""Which damper the inverse believes in: the plant's own, with its true state, or another model with a state of its own.

Both records answer to the same hooks, resolved at compile time.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from seatsim.compilation.jit import jit
from seatsim.kernel.generic import Tuple, axpy, combine, heat_at, hook, rates
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling


class Truth(NamedTuple):
    """The inverse knows the plant's damper, its state and its temperature."""

    damper: Any
    order: int

    def state(self, true: Any, own: Any) -> Any:
        """Return the state with which the inverse evaluates the damper."""
        return true

    def scaling(self, true: Any, temperature: float) -> Any:
        """Return the temperature factors that the inverse uses."""
        return true


class Belief(NamedTuple):
    """The inverse believes in `damper` and follows its state from measured motion and current.

    `temperature` is what the inverse believes it to be in degC; NaN where it reads the damper's.
    """

    damper: Any
    order: int
    factors: TemperatureFactors
    temperature: float

    def state(self, true: Any, own: Any) -> Any:
        """Return the state with which the inverse evaluates the damper."""
        return own

    def scaling(self, true: Any, temperature: float) -> Any:
        """Return the temperature factors that the inverse uses."""
        return heat_at(self.factors, temperature if math.isnan(self.temperature) else self.temperature)


@hook
def state(self: Any, true: Tuple, own: Tuple) -> Tuple:
    """State with which the inverse evaluates the damper."""
    raise TypeError


@hook
def scaling(self: Any, true: TemperatureScaling, temperature: float) -> TemperatureScaling:
    """Temperature factors that the inverse uses."""
    raise TypeError


@jit
def follow(
    damper: Any,
    own: Tuple,
    x: float,
    v: float,
    x_next: float,
    v_next: float,
    i: float,
    scaling: TemperatureScaling,
    length: float,
) -> Tuple:
    """Return a believed state after `length` seconds, in two Runge-Kutta steps along motion linear between samples."""
    h = 0.5 * length
    for part in range(2):
        xa, va = x + 0.5 * part * (x_next - x), v + 0.5 * part * (v_next - v)
        xb, vb = xa + 0.25 * (x_next - x), va + 0.25 * (v_next - v)
        xc, vc = xa + 0.5 * (x_next - x), va + 0.5 * (v_next - v)
        k1 = rates(damper, xa, va, i, scaling, own)
        k2 = rates(damper, xb, vb, i, scaling, axpy(own, 0.5 * h, k1))
        k3 = rates(damper, xb, vb, i, scaling, axpy(own, 0.5 * h, k2))
        k4 = rates(damper, xc, vc, i, scaling, axpy(own, h, k3))
        own = combine(own, h, k1, k2, k3, k4)
    return own
