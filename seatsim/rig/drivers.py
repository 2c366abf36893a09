"""Drivers: seated bodies of the literature as tables of masses and links, and what is measured of such bodies.

A driver whose model is not `single_mass` rests on the cushion with its contact mass, whose acceleration is that of the
seat's surface: `driver_acceleration`, where ISO 10326-1 has its accelerometer. All masses, stiffnesses and dampings are
scaled so that the body weighs what `plant.driver_mass` says, which leaves its resonances where they are.

A new model is a further entry of `BODIES`: at most four masses beside that of the contact.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field

from seatsim.schema.arrays import Array

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


_CUSHION_MASS = 1.0
"""kg that move with the surface of the cushion, for models without a mass there (ours): without it the contact point
would have no inertia of its own. It raises the apparent mass by as much."""

BODIES: Mapping[str, Body] = {
    "iso5982": Body(
        contact=2.0,
        masses=(45.0, 6.0, 2.0),
        links=(Link(0, _CONTACT, 36200.0, 1390.0), Link(1, _CONTACT, 9990.0, 387.0), Link(2, 1, 34400.0, 234.0)),
        head=2,
        source="ISO 5982:2001, model of a person of 75 kg, of whom 55 kg rest on the seat",
    ),
    "wan_schimmels": Body(
        contact=_CUSHION_MASS,
        masses=(36.0, 5.5, 15.0, 4.17),
        links=(
            Link(0, _CONTACT, 49340.0, 2475.0),
            Link(1, 0, 192000.0, 909.1),
            Link(2, 1, 10000.0, 200.0),
            Link(2, 0, 20000.0, 330.0),
            Link(3, 2, 134400.0, 250.0),
        ),
        head=3,
        source="Wan and Schimmels 1995: thighs and pelvis, lower torso, upper torso, head",
    ),
    "boileau_rakheja": Body(
        contact=_CUSHION_MASS,
        masses=(12.78, 8.62, 28.49, 5.31),
        links=(
            Link(0, _CONTACT, 90000.0, 2064.0),
            Link(1, 0, 162800.0, 4585.0),
            Link(2, 1, 183000.0, 4750.0),
            Link(3, 2, 310000.0, 400.0),
        ),
        head=3,
        source="Boileau and Rakheja 1998: thighs and pelvis, lower torso, chest, head and neck",
    ),
}
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


def apparent_mass(body: Body, frequency: ArrayLike) -> NDArray[np.complex128]:
    """Return force over acceleration at a rigid seat in kg, shape of `frequency` in Hz (ISO 5982)."""
    response = _responses(body, np.asarray(frequency, dtype=float))
    return np.asarray(body.contact + response @ np.array(body.masses))


def head_transmissibility(body: Body, frequency: ArrayLike) -> NDArray[np.complex128]:
    """Return the acceleration of the head over that of a rigid seat, shape of `frequency` in Hz (ISO 5982)."""
    return np.asarray(_responses(body, np.asarray(frequency, dtype=float))[..., body.head])


def _responses(body: Body, frequency: Array) -> NDArray[np.complex128]:
    """Return the acceleration of every mass over that of the seat, shape (..., masses)."""
    masses, stiffness, damping = body_matrices(body)
    s = 2j * np.pi * frequency[..., None, None]
    dynamic = np.diag(masses) * s**2 + damping * s + stiffness
    drive = (damping * s + stiffness).sum(axis=-1)
    return np.linalg.solve(dynamic, drive[..., None])[..., 0]
