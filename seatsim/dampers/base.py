"""What a damper is: a record of parameters with `force` and, where it has a state, `rates`.

    def force(self, x, v, i, heat, z):   force in N, positive when it opposes extension
    def rates(self, x, v, i, heat, z):   time derivative of the state z (a tuple of floats)
    def coulomb(self, i, heat):          magnitude in N of a set-valued friction beside `force` (optional)

with x [m], v = x' [m/s], current i [A], `heat` the temperature factors (`seatsim.temperature.Heat`) by which
the model multiplies its viscous, elastic and yield terms. Methods are compiled by numba: plain arithmetic and
`math` only; what they call from their module is decorated with `seatsim.jit.jit`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol, TypeVar

from seatsim.registry import register
from seatsim.temperature import Heat, TemperatureFactors

T = TypeVar("T", bound=type)
State = tuple[float, ...]


class Damper(Protocol):
    """The part of a damper that every model has; see the module for the optional methods."""

    def force(self, x: float, v: float, i: float, heat: Heat, z: Any) -> float:
        """Return the damper force in N."""


class DamperCard(NamedTuple):
    """What is stated of a damper model.

    initial: state at rest. current_order: degree (1 or 2) of the polynomial in the current that `force` is at
    fixed motion and state, 0 where it is none; it decides whether the inverse has a closed form. centred: the
    model branches on sgn(x) or sgn(dv/dt), so that it is wrong where the motion is not centred about x = 0.
    The ranges of speed [m/s], current [A] and temperature [degC] are those of the data behind it. complete: the
    model is a form without a parameter set of its own; a scenario states all of its parameters.
    """

    source: str
    initial: State
    state: str
    current_order: int
    centred: bool
    max_speed: float
    max_current: float
    temperatures: tuple[float, float]
    factors: TemperatureFactors
    complete: bool


def damper(
    name: str,
    source: str,
    initial: State = (),
    state: str = "",
    current_order: int = 0,
    centred: bool = False,
    max_speed: float = 1.0,
    max_current: float = 2.0,
    temperatures: tuple[float, float] = (20.0, 80.0),
    factors: TemperatureFactors | None = None,
    complete: bool = False,
) -> Callable[[T], T]:
    """Register a record class as the damper `model: name`; see `DamperCard` for the facts."""
    card = DamperCard(
        source,
        initial,
        state,
        current_order,
        centred,
        max_speed,
        max_current,
        temperatures,
        factors or TemperatureFactors(),
        complete,
    )
    return register("damper", name, card)
