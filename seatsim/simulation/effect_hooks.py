"""Methods through which an effect acts before and after the time loop, and how they are found.

`seatsim.effects.base` says what each of them means; those inside the time loop are found by the kernel.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Generic, Protocol, TypeVar, cast

from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.arrays import Array

P_co = TypeVar("P_co", covariant=True)


class ChangesPlant(Protocol):
    """An effect on the parameters of the seat."""

    def plant(self, plant: Plant) -> Plant:
        """Return the changed parameters."""


class ChangesCoil(Protocol):
    """An effect on the parameters of the coil."""

    def coil(self, coil: Coil) -> Coil:
        """Return the changed parameters."""


class ChangesFactors(Protocol):
    """An effect on the temperature factors of the damper."""

    def factors(self, factors: TemperatureFactors) -> TemperatureFactors:
        """Return the changed factors."""


class ChangesTemperature(Protocol):
    """An effect on the temperature of the fluid."""

    def temperature(self, step: float, values: Array) -> Array:
        """Return the fluid's temperature in degC out of the thermocouple's, shape (N,), every `step` seconds."""


class PushesFrame(Protocol):
    """An effect that exerts a force on the frame."""

    def frame_force(self, time: Array, seed: int) -> Array:
        """Return the force in N at each time in s, shape (N,)."""


class ChangesReading(Protocol):
    """An effect on what a sensor says."""

    def reading(self, channel: str, step: float, values: Array) -> Array:
        """Return what the sensor says out of what is true, shape (N,), every `step` seconds."""


class UndoesReading(Protocol):
    """An effect on what a sensor says of an input."""

    def truth(self, channel: str, step: float, values: Array) -> Array:
        """Return what is true out of what the sensor says, shape (N,), every `step` seconds."""


class Hook(Generic[P_co]):
    """A method that an effect may have; `P_co` is its signature."""

    def __init__(self, method: str) -> None:
        self.method = method

    def of(self, effects: Sequence[object]) -> Iterator[P_co]:
        """Yield the effects that have the method, in their order."""
        # An isinstance of a runtime protocol takes 10 us, some fifty times in a simulation of 10 ms: too slow here.
        return (cast(P_co, effect) for effect in effects if hasattr(effect, self.method))


PLANT = Hook[ChangesPlant]("plant")
COIL = Hook[ChangesCoil]("coil")
FACTORS = Hook[ChangesFactors]("factors")
TEMPERATURE = Hook[ChangesTemperature]("temperature")
FRAME_FORCE = Hook[PushesFrame]("frame_force")
READING = Hook[ChangesReading]("reading")
TRUTH = Hook[UndoesReading]("truth")
