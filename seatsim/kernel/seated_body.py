"""A seated body of up to four masses, carried by the point of contact with the cushion, in the compiled loop."""

from __future__ import annotations

from typing import NamedTuple

from seatsim.compilation.jit import jit
from seatsim.kernel.rig import SeatMotion
from seatsim.rig.plant import Plant
from seatsim.rig.state import State
from seatsim.schema.registry import register

MASSES = 4
"""Masses that a body has room for."""
Vector = tuple[float, float, float, float]
Matrix = tuple[Vector, Vector, Vector, Vector]


class BodySpecification(NamedTuple):
    """What the loop knows of a body: its state at rest, displacements from the contact point in m and their rates."""

    initial: State


@register("body", "seated_body", BodySpecification((0.0,) * (2 * MASSES)))
class SeatedBody(NamedTuple):
    """Masses linked by springs and dashpots to each other and to the point of contact.

        M (x'' + zc'' 1) = -K x - C x',   f = 1' (K x + C x')

    x are the displacements of the masses from the contact point zc, f is the force with which they push it upward;
    where the sum over a column of K or C is not 0 its mass is linked to the contact point. A mass of 0 stays at rest.
    """

    masses: Vector
    stiffness: Matrix
    damping: Matrix

    def inner_mass(self, plant: Plant, z: State) -> float:
        """Return the masses in kg that the contact point carries."""
        return self.masses[0] + self.masses[1] + self.masses[2] + self.masses[3]

    def inner_force(self, plant: Plant, z: State) -> float:
        """Return the upward force of the masses on the contact point in N."""
        pull = _pull(self.stiffness, self.damping, z)
        return pull[0] + pull[1] + pull[2] + pull[3]

    def rates(self, plant: Plant, motion: SeatMotion, z: State) -> State:
        """Return the rates of displacements and speeds."""
        pull, mass, base = _pull(self.stiffness, self.damping, z), self.masses, motion.driver
        return (
            z[4], z[5], z[6], z[7],
            _fall(pull[0], mass[0], base), _fall(pull[1], mass[1], base),
            _fall(pull[2], mass[2], base), _fall(pull[3], mass[3], base),
        )  # fmt: skip


@jit
def _pull(stiffness: Matrix, damping: Matrix, z: State) -> Vector:
    """Return K x + C x' in N."""
    return (
        _row(stiffness[0], damping[0], z),
        _row(stiffness[1], damping[1], z),
        _row(stiffness[2], damping[2], z),
        _row(stiffness[3], damping[3], z),
    )


@jit
def _row(k: Vector, c: Vector, z: State) -> float:
    springs = k[0] * z[0] + k[1] * z[1] + k[2] * z[2] + k[3] * z[3]
    return springs + c[0] * z[4] + c[1] * z[5] + c[2] * z[6] + c[3] * z[7]


@jit
def _fall(pull: float, mass: float, base: float) -> float:
    """Return the acceleration of a mass relative to the contact point in m/s^2."""
    return -pull / mass - base if mass > 0.0 else 0.0
