"""Interfaces of a control law's design, for code that reports and saves it.

The classes that implement them stand with the synthesis, which `seatsim` never imports.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from seatsim.rig.coil import Coil
from seatsim.rig.control import Law
from seatsim.rig.plant import Plant
from seatsim.schema.arrays import Array

_Progress = Callable[[str], object]
"""Callback that gets a line on the progress of a long computation."""


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
    def proof(self) -> BoxProof | None:
        """Whether any permitted gain is better by more than 0.1 %, where `prove` was asked."""

    def prove(self, progress: _Progress) -> SynthesisedDesign:
        """Return the design with its `proof`."""

    def save(self, path: str | Path) -> None:
        """Write the design to a file; the file is complete or absent."""


@runtime_checkable
class SynthesisedLaw(Protocol):
    """A law whose gain is synthesised from weights and whose design can be reported and saved."""

    def synthesis(self, plant: Plant, progress: _Progress) -> SynthesisedDesign:
        """Return the design for a seat."""


@runtime_checkable
class CheckedLaw(Protocol):
    """A law whose loop can be judged with the gain of a design."""

    def margins(self, plant: Plant, coil: Coil, gain: Array) -> str:
        """Return in words the margins of the loop that a gain closes with seat and coil."""

    def with_gain(self, gain: Array) -> Law:
        """Return the law with a stated gain."""
