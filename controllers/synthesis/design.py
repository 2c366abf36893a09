"""A finished design: what is true of its gain, whatever search it came from, and the YAML file it is kept in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from controllers.synthesis.certify import Certificate, certify
from controllers.synthesis.global_proof import FACTOR, GlobalProof, prove_no_better
from controllers.synthesis.norm import grid_norm, hinf_norm
from controllers.synthesis.plant import MATRICES, GeneralisedPlant, LinearSystem
from seatsim.rig.designs import Clipping
from seatsim.schema.arrays import Array
from seatsim.schema.files import write_text
from seatsim.schema.yaml_text import dump

if TYPE_CHECKING:
    import control


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """What is known of one plant with the design's gain.

    `gamma` is the H-infinity norm from w to z, attained at `peak_frequency` in rad/s (0 to infinity); `norms_agree`
    says whether bisection and frequency grid find the same to 1e-6. `certificate` proves it by the bounded-real lemma;
    None where double precision cannot. `disk_margin` is the balanced disk margin a at the control: the loop stays
    stable while every control is multiplied by its own factor of (2 - a) / (2 + a) ... (2 + a) / (2 - a), or turned by
    a phase of up to 2 atan(a / 2). `poles` are in rad/s.

    Source of the margin: Seiler, Packard & Gahinet 2020, IEEE Control Syst. 40(5):78.
    """

    plant: GeneralisedPlant
    gamma: float
    peak_frequency: float
    norms_agree: bool
    certificate: Certificate | None
    disk_margin: float
    poles: NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Design:
    """An output feedback `u = gain @ y`, static or of some `order`, and what is known of its loops, one a plant.

    `gain` (nu, ny) is in the user's units, every entry at most `max_gain` in magnitude. `lower_bound` is what no linear
    controller of any order can go below. `gamma` and `certificate` are those of the `worst` loop. `measures` names what
    is measured, where its user has names for it; `proof`, where it was asked for, says whether any gain within
    `max_gain` is better (`prove_no_better`), and `clipping` what a damper's limits cost.
    With an order the loops' plants have the controller's states, and the gain is [[D_K, C_K], [B_K, A_K]]
    (`GeneralisedPlant.with_controller_states`).
    """

    gain: Array
    max_gain: float
    lower_bound: float
    loops: tuple[ClosedLoop, ...]
    measures: tuple[str, ...] = ()
    proof: GlobalProof | None = None
    clipping: Clipping | None = None
    order: int = 0

    @property
    def controller(self) -> control.StateSpace:
        """The controller from y to u in continuous time."""
        import control

        u, y = (size - self.order for size in self.gain.shape)
        return control.ss(self.gain[u:, y:], self.gain[u:, :y], self.gain[:u, y:], self.gain[:u, :y])

    @property
    def worst(self) -> ClosedLoop:
        """The loop with the largest norm."""
        return max(self.loops, key=lambda loop: loop.gamma)

    @property
    def gamma(self) -> float:
        """Largest H-infinity norm of the loops."""
        return self.worst.gamma

    @property
    def certificate(self) -> Certificate | None:
        """Certificate of the worst loop."""
        return self.worst.certificate

    def prove(self, progress: Callable[[str], object] = lambda text: None) -> Design:
        """Return the design with the proof that no gain within `max_gain` is better by more than 0.1 %.

        Raises:
            InputError: it has more free gains than are searched over their whole box.
        """
        bounds = np.full(int(self.worst.plant.free.sum()), self.max_gain)
        plants = [loop.plant for loop in self.loops]
        return replace(self, proof=prove_no_better(plants, self.gamma * FACTOR, -bounds, bounds, progress=progress))

    def with_clipping(self, clipping: Clipping | None) -> Design:
        """Return the design with what the limits of a damper cost on a run."""
        return replace(self, clipping=clipping)

    def save(self, path: str | Path) -> None:
        """Write the design as YAML; the file appears whole or not at all."""
        write_text(Path(path), dump(_to_plain(self)))


# Fields of a loop and of its certificate that stand in the file as they are.
_OF_LOOP = ("gamma", "peak_frequency", "norms_agree", "disk_margin")
_OF_PROOF = ("factor", "gamma", "delta", "largest_eigenvalue")


def _to_plain(design: Design) -> dict[str, object]:
    """Return a design as it stands in the file; a static one states no order.

    `certificate` is the worst loop's as one reads it: P itself, rounded. Its factor stands with the loop.
    """
    plain: dict[str, object] = {"order": design.order} if design.order else {}
    plain |= {"measures": list(design.measures), **_list_fields(design, ("gain", "gamma", "max_gain", "lower_bound"))}
    plain["certificate"] = design.certificate and _list_fields(design.certificate, ("gamma", "delta", "matrix"))
    plain["loops"] = [_to_plain_loop(loop) for loop in design.loops]
    if (proof := design.proof) is not None:
        box = [proof.low.tolist(), proof.high.tolist()]
        plain["global"] = {"box": box, "factor": FACTOR, "boxes": proof.boxes, "proven": proof.is_proven}
    if design.clipping:
        plain["clipping"] = design.clipping._asdict()
    return plain


def _to_plain_loop(loop: ClosedLoop) -> dict[str, object]:
    free = loop.plant.structure
    return _list_fields(loop, _OF_LOOP) | {
        "poles": [[float(pole.real), float(pole.imag)] for pole in loop.poles],
        "certificate": loop.certificate and _list_fields(loop.certificate, _OF_PROOF),
        "plant": _list_fields(loop.plant, MATRICES)
        | {"structure": None if free is None else free.astype(int).tolist()},
    }


def _list_fields(record: object, names: Sequence[str]) -> dict[str, object]:
    """Return some fields of a record, arrays as lists."""
    values = {name: getattr(record, name) for name in names}
    return {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in values.items()}


# Two frequencies of equal height differ by rounding; a grid higher by more has found what bisection missed.
_ROUNDING = 1e-10
_AGREEMENT = 1e-6  # what the documentation states of the norm


def verify(plant: GeneralisedPlant, gain: Array, order: int = 0) -> ClosedLoop:
    """Return what is known of a plant under a stabilising gain (nu, ny); the last `order` controls are not physical."""
    loop = plant.close(gain)
    norm, grid = hinf_norm(loop), grid_norm(loop)
    if norm.value < grid.value * (1 - _ROUNDING):
        norm = hinf_norm(loop, guesses=[grid.frequency])
    agree = norm.value - grid.value <= _AGREEMENT * norm.value
    certificate, margin = certify(plant, gain, norm.value), disk_margin(plant, gain, plant.control_count - order)
    return ClosedLoop(plant, norm.value, norm.frequency, agree, certificate, margin, loop.poles)


def disk_margin(plant: GeneralisedPlant, gain: Array, controls: int) -> float:
    """Return the balanced disk margin at the first `controls`, 2 / ||2 S - I||, with S = (I - K G)^-1; at most 2."""
    A = plant.A + plant.B2 @ gain @ plant.C2
    return (
        2 / hinf_norm(LinearSystem(A, plant.B2[:, :controls], 2 * gain[:controls] @ plant.C2, np.eye(controls))).value
    )
