"""Interfaces that the compiled loop requires of the records that are plugged into it.

numba compiles a record's methods and never reads these; they are for readers and for the type checker. Every record is
a `typing.NamedTuple` with ordinary methods; its arguments are passed by position.
"""

from __future__ import annotations

from typing import Protocol

from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling

EffectRecord = tuple[object, ...]
"""A `typing.NamedTuple` with a method for each hook that it uses (see `seatsim.kernel.hooks`)."""


class DamperModel(Protocol):
    """A damper model: the part that every model has.

    x [m] and v [m/s] are displacement and velocity of the damper, i [A] its coil current, `scaling` the factors of the
    temperature on its viscous, elastic and yield terms, z its state (empty where it has none).
    """

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State, /) -> float:
        """Return the force in N without the set-valued friction, positive when it opposes extension."""


class DamperWithState(DamperModel, Protocol):
    """A damper with a state of its own, such as a hysteresis."""

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State, /) -> State:
        """Return the time derivative of z, of the same length."""


class DamperWithFriction(DamperModel, Protocol):
    """A damper with a friction that is set-valued at rest, which the kernel solves without regularisation."""

    def coulomb(self, i: float, scaling: TemperatureScaling, /) -> float:
        """Return the magnitude of the friction in N."""
