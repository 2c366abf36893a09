"""Which damper model the inverse uses: the true one with its true state, or an assumed one whose state it tracks.

Both records have the same hooks, resolved at compile time.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from seatsim.compilation.jit import jit
from seatsim.kernel.generic import DamperModel, rates, scaling_at
from seatsim.kernel.hooks import hook
from seatsim.kernel.integration import axpy, combine
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling


class TrueModel(NamedTuple):
    """The inverse knows the damper of the rig, its state and its temperature.

    `order` is the degree of the force as a polynomial in the current, 0 where it is none (see `invert`).
    """

    damper: DamperModel
    order: int

    def model_state(self, true: State, followed: State) -> State:
        """Return the state with which the inverse evaluates the damper."""
        return true

    def model_scaling(self, true: TemperatureScaling, temperature: float) -> TemperatureScaling:
        """Return the temperature factors that the inverse uses."""
        return true


class AssumedModel(NamedTuple):
    """The inverse assumes that the damper is `damper` and tracks its state from measured motion and current.

    `temperature` is the assumed temperature of the damper in degC; NaN where the inverse reads the measured one.
    `order` as in `TrueModel`.
    """

    damper: DamperModel
    order: int
    factors: TemperatureFactors
    temperature: float

    def model_state(self, true: State, followed: State) -> State:
        """Return the state with which the inverse evaluates the damper."""
        return followed

    def model_scaling(self, true: TemperatureScaling, temperature: float) -> TemperatureScaling:
        """Return the temperature factors that the inverse uses, at the measured `temperature` in degC or its own."""
        return scaling_at(self.factors, temperature if math.isnan(self.temperature) else self.temperature)


InverseModel = TrueModel | AssumedModel


@hook
def model_state(model: InverseModel, true: State, followed: State) -> State:
    """State with which the inverse evaluates its damper: the true one, or the tracked one, `followed`."""
    raise TypeError(f"{type(model).__name__} is no model for the inverse")


@hook
def model_scaling(model: InverseModel, true: TemperatureScaling, temperature: float) -> TemperatureScaling:
    """Temperature factors that the inverse uses."""
    raise TypeError(f"{type(model).__name__} is no model for the inverse")


@jit
def follow_state(
    damper: DamperModel,
    z: State,
    x: float,
    v: float,
    x_next: float,
    v_next: float,
    i: float,
    scaling: TemperatureScaling,
    length: float,
) -> State:
    """Return an assumed damper's state `length` seconds after `z`, by the classical Runge-Kutta method.

    Displacement [m] and velocity [m/s] go linearly from `x`, `v` to `x_next`, `v_next`; the current `i` [A] and the
    temperature factors are constant. The error is not checked: rates above about 1 / length are not tracked.
    """
    # Two half steps between samples, so that a hysteresis as stiff as the rig itself is tracked too.
    h = 0.5 * length
    for part in range(2):
        xa, va = x + 0.5 * part * (x_next - x), v + 0.5 * part * (v_next - v)
        xb, vb = xa + 0.25 * (x_next - x), va + 0.25 * (v_next - v)
        xc, vc = xa + 0.5 * (x_next - x), va + 0.5 * (v_next - v)
        k1 = rates(damper, xa, va, i, scaling, z)
        k2 = rates(damper, xb, vb, i, scaling, axpy(z, 0.5 * h, k1))
        k3 = rates(damper, xb, vb, i, scaling, axpy(z, 0.5 * h, k2))
        k4 = rates(damper, xc, vc, i, scaling, axpy(z, h, k3))
        z = combine(z, h, k1, k2, k3, k4)
    return z
