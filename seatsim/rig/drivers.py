"""Drivers: seated bodies of the literature as tables of masses and links.

A driver whose model is not `single_mass` rests on the cushion with its contact mass, whose acceleration is that of the
seat's surface: `driver_acceleration`, where ISO 10326-1 has its accelerometer. All masses, stiffnesses and dampings are
scaled so that the body weighs what `plant.driver_mass` says, which leaves its resonances where they are.

A new model is a further entry of `drivers.yaml`: at most four masses beside that of the contact.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from seatsim.schema.arrays import Array
from seatsim.schema.fields import read_packaged

_ModelName = Literal["single_mass", "iso5982", "wan_schimmels", "boileau_rakheja"]
SINGLE_MASS: _ModelName = "single_mass"
_CONTACT = -1
"""Number of the point of contact in a link."""


class Driver(NamedTuple):
    """The driver of a seat: which body it is; `plant.driver_mass` is the mass that rests on the seat."""

    model: Annotated[
        _ModelName, Field(description="'single_mass', or a body: 'iso5982', 'wan_schimmels', 'boileau_rakheja'")
    ] = SINGLE_MASS


class Link(NamedTuple):
    """Spring in N/m and dashpot in N s/m between two masses, by their numbers; _CONTACT is the seat's surface."""

    upper: int
    lower: int
    stiffness: float
    damping: float


class Body(NamedTuple):
    """One model of the literature: masses in kg, that which moves with the seat's surface first, and links."""

    contact: float
    masses: tuple[float, ...]
    links: tuple[Link, ...]
    head: int
    source: str

    @property
    def mass(self) -> float:
        """Mass on the seat in kg."""
        return self.contact + sum(self.masses)


BODIES = read_packaged(Path(__file__).with_name("drivers.yaml"), dict[str, Body])
"""Bodies by the name of their model; all are recalled: the figures and the links were not read in the source."""


class BodyMatrices(NamedTuple):
    """Masses, shape (n,), and the matrices of stiffness and damping about the contact point, shape (n, n) each."""

    masses: Array
    stiffness: Array
    damping: Array


def body_matrices(body: Body, mass: float | None = None) -> BodyMatrices:
    """Return the matrices of a body in kg, N/m and N s/m, scaled to a `mass` in kg on the seat where one is given."""
    count, scale = len(body.masses), 1.0 if mass is None else mass / body.mass
    stiffness, damping = np.zeros((count, count)), np.zeros((count, count))
    for link in body.links:
        ends = [end for end in (link.upper, link.lower) if end != _CONTACT]
        signs = np.outer([1.0, -1.0][: len(ends)], [1.0, -1.0][: len(ends)])
        stiffness[np.ix_(ends, ends)] += link.stiffness * signs
        damping[np.ix_(ends, ends)] += link.damping * signs
    return BodyMatrices(scale * np.array(body.masses), scale * stiffness, scale * damping)
