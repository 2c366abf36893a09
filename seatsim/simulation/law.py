"""A control law made ready for the time loop, and what it has to say after it."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant


@runtime_checkable
class DesignedForPlant(Protocol):
    """A law whose design needs the seat."""

    def prepared(self, plant: Plant) -> object:
        """Return the compiled form of the law."""


@runtime_checkable
class DesignedForSampling(Protocol):
    """A law whose design needs the seat, the coil and its own sample time."""

    def sampled(self, plant: Plant, coil: Coil, sample_time: float) -> object:
        """Return the compiled form of the law for samples every `sample_time` seconds."""


@runtime_checkable
class TakesNotes(Protocol):
    """A compiled form that has something to say after a run."""

    def notes(self) -> tuple[str, ...]:
        """Return sentences for the user."""


def prepare_law(law: object, plant: Plant, coil: Coil, sample_time: float) -> object:
    """Return the compiled form of a law, designed for a nominal rig where the law asks for it (`seatsim.rig.control`).

    Raises:
        InputError: the law cannot be designed for this rig.
    """
    if isinstance(law, DesignedForSampling):
        return law.sampled(plant, coil, sample_time)
    return law.prepared(plant) if isinstance(law, DesignedForPlant) else law


def collect_notes(law: object) -> tuple[str, ...]:
    """Return the sentences that the compiled form of a law has for its user after a run."""
    return law.notes() if isinstance(law, TakesNotes) else ()
