"""Definition of an excitation: a record of keys that yields the motion of the floor."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.registry import Record, Registry

Array = NDArray[np.float64]
T = TypeVar("T", bound=type)


class Floor(NamedTuple):
    """Vertical motion of the cab floor, sampled every `step` seconds from time zero; upward positive.

    The simulation takes the acceleration as linear between samples; velocity and displacement are what laws
    and transmissibility need, consistent with it and free of drift.
    """

    step: float
    acceleration: Array
    velocity: Array
    displacement: Array
    command: Array | None = None
    coil_current: Array | None = None
    temperature: Array | None = None

    @property
    def time(self) -> Array:
        """Time of each sample in s, shape (N,)."""
        return self.step * np.arange(len(self.acceleration), dtype=np.float64)


class Excitation(Record, Protocol):
    """A record (NamedTuple) of keys; `floor` turns them into motion."""

    def floor(self, step: float, seed: int) -> Floor:
        """Return the floor's motion sampled every `step` seconds; every random draw derives from `seed`."""


class ExcitationSpecification(NamedTuple):
    """Specification of an excitation: its source (standard and clause) where there is one."""

    source: str


EXCITATIONS: Registry[Excitation, ExcitationSpecification] = Registry("excitation")
"""All excitations by name."""


def excitation(name: str, source: str = "") -> Callable[[T], T]:
    """Register a record class as the excitation `kind: name`."""
    return EXCITATIONS.register(name, ExcitationSpecification(source))
