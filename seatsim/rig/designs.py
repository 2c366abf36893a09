"""Interface of a control law that is designed, for code that reports and saves its design.

The classes stand with the synthesis, which `seatsim` imports for its types alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple, Protocol, runtime_checkable

from seatsim.rig.coil import Coil
from seatsim.rig.control import FloorRecord, Floors, Law
from seatsim.rig.plant import Plant
from seatsim.schema.arrays import Array

if TYPE_CHECKING:
    from controllers.synthesis import Design


def unit_of_gain(measure: str) -> str:
    """Return the unit of the gain in N on what is measured, by the last word of its name."""
    return {"displacement": "N/m", "velocity": "N s/m", "acceleration": "kg"}[measure.rpartition("_")[2]]


class Clipping(NamedTuple):
    """What the limits of the damper cost a design on one run: it can only resist, within its currents.

    `promised` is the driver's Wk-weighted RMS acceleration in m/s^2 if the damper delivered all that is wanted,
    `delivered` that of the run; `force_error` is the RMS of wanted less delivered force, over that of the wanted one.
    """

    promised: float
    delivered: float
    force_error: float


@runtime_checkable
class SynthesisedLaw(Protocol):
    """A law whose gain is synthesised from weights, and whose design can be judged, reported and saved."""

    def synthesis(self, plant: Plant, floors: Floors, progress: Callable[[str], object]) -> Design:
        """Return the design for a seat on some floors; `progress` is told what is being done."""

    def describe(self, plant: Plant, coil: Coil, floors: Floors) -> str:
        """Return a line on gain, norm and margins of the design; empty where nothing was synthesised."""

    @property
    def is_limited_by_travel(self) -> bool:
        """Whether the weight of the travel is still to be found: what the seat's end stops permit."""

    def with_travel_weight(self, weight: float) -> Law:
        """Return the law with a weight in 1/s^2."""

    def margins(self, plant: Plant, coil: Coil, gain: Array) -> str:
        """Return in words the margins of the loop that a gain closes with seat and coil."""

    def with_gain(self, gain: Array) -> Law:
        """Return the law with a stated gain."""

    def promise(self, plant: Plant, coil: Coil, gain: Array, floor: FloorRecord) -> Array:
        """Return the driver's acceleration in m/s^2 on a floor, shape (N,), with all of the wanted force."""
