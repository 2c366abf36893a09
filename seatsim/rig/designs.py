"""Interfaces of a control law's design, for code that reports and saves it.

The classes that implement them stand with the synthesis, which `seatsim` never imports.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from seatsim.rig.coil import Coil
from seatsim.rig.control import FloorRecord, Floors, Law
from seatsim.rig.plant import Plant
from seatsim.schema.arrays import Array

_Progress = Callable[[str], object]
"""Callback that gets a line on the progress of a long computation."""


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


class _NormProof(Protocol):
    """A proof that the H-infinity norm of a stable loop lies below `gamma`."""

    @property
    def gamma(self) -> float:
        """Proven upper bound of the norm."""


class BoxProof(Protocol):
    """A proof that no gain in the box of the permitted ones is better than a level below `gamma`."""

    @property
    def is_proven(self) -> bool:
        """Whether every part of the box is excluded."""

    @property
    def boxes(self) -> int:
        """Number of boxes that are excluded."""

    @property
    def better(self) -> Array | None:
        """A better gain that was met instead."""

    def save(self, path: Path) -> None:
        """Write the proof to a file; the file is complete or absent."""


class DesignedLoop(Protocol):
    """Figures of one plant under the designed gain."""

    @property
    def gamma(self) -> float:
        """H-infinity norm from disturbance to performance output."""

    @property
    def certificate(self) -> _NormProof | None:
        """Proof of the norm; None where there is none in double precision."""

    @property
    def disk_margin(self) -> float:
        """Balanced disk margin at the control, 0 to 2."""

    @property
    def norms_agree(self) -> bool:
        """Whether two independent computations of the norm agree to 1e-6."""


class SynthesisedDesign(Protocol):
    """A static output feedback with the loops that it closes, one per plant; figures are those of the worst loop."""

    @property
    def gain(self) -> Array:
        """Gain (controls, measurements) in the user's units."""

    @property
    def measures(self) -> Sequence[str]:
        """Names of what is measured, in the order of the gain's columns; empty where the plant has none."""

    @property
    def max_gain(self) -> float:
        """Largest magnitude that an entry of the gain may have."""

    @property
    def gamma(self) -> float:
        """Largest H-infinity norm of the loops."""

    @property
    def lower_bound(self) -> float:
        """Lower bound of the norm for linear controllers of any order."""

    @property
    def certificate(self) -> _NormProof | None:
        """Proof of `gamma`."""

    @property
    def peak_frequency(self) -> float:
        """Frequency in rad/s at which the norm is attained."""

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Poles in rad/s."""

    @property
    def loops(self) -> Sequence[DesignedLoop]:
        """Every plant under the gain."""

    @property
    def clipping(self) -> Clipping | None:
        """What the limits of the damper cost on a run, where one was simulated."""

    @property
    def proof(self) -> BoxProof | None:
        """Whether any permitted gain is better by more than 0.1 %, where `prove` was asked."""

    def prove(self, progress: _Progress) -> SynthesisedDesign:
        """Return the design with its `proof`."""

    def with_clipping(self, clipping: Clipping | None) -> SynthesisedDesign:
        """Return the design with what the limits of the damper cost."""

    def save(self, path: str | Path) -> None:
        """Write the design to a file; the file is complete or absent."""


@runtime_checkable
class SynthesisedLaw(Protocol):
    """A law whose gain is synthesised from weights and whose design can be reported and saved."""

    def synthesis(self, plant: Plant, floors: Floors, progress: _Progress) -> SynthesisedDesign:
        """Return the design for a seat on some floors."""


@runtime_checkable
class TravelLimitedLaw(Protocol):
    """A law whose weight of the travel may be left to what the seat's end stops permit."""

    @property
    def is_limited_by_travel(self) -> bool:
        """Whether the weight is still to be found."""

    def with_travel_weight(self, weight: float) -> Law:
        """Return the law with a weight in 1/s^2."""


@runtime_checkable
class DescribedLaw(Protocol):
    """A law that says what its synthesis found."""

    def describe(self, plant: Plant, coil: Coil, floors: Floors) -> str:
        """Return a line on gain, norm and margins of the design; empty where nothing was synthesised."""


@runtime_checkable
class CheckedLaw(Protocol):
    """A law whose loop can be judged with the gain of a design."""

    def margins(self, plant: Plant, coil: Coil, gain: Array) -> str:
        """Return in words the margins of the loop that a gain closes with seat and coil."""

    def with_gain(self, gain: Array) -> Law:
        """Return the law with a stated gain."""

    def promise(self, plant: Plant, coil: Coil, gain: Array, floor: FloorRecord) -> Array:
        """Return the driver's acceleration in m/s^2 on a floor, shape (N,), with all of the wanted force."""
