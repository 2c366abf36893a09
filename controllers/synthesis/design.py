"""A finished design: what is true of its gain, whatever search it came from, and the YAML file it is kept in.

Reading the file needs neither solver nor plant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, NotRequired, TypedDict, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from controllers.synthesis.certify import Certificate, certify
from controllers.synthesis.global_proof import FACTOR, GlobalProof, prove_no_better
from controllers.synthesis.norm import Peak, grid_norm, hinf_norm
from controllers.synthesis.plant import MATRICES, GeneralisedPlant, Loop
from seatsim.rig.designs import Clipping
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.files import write_text
from seatsim.schema.yaml_source import Source
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
    controller of any order can go below. `gamma`, `certificate`, `peak_frequency`, `poles` and `plant` are those of
    the worst loop. `measures` names what is measured, where its user has names for it; `proof`, where it was asked for,
    says whether any gain within `max_gain` is better (`prove_no_better`), and `clipping` what a damper's limits cost.
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

    @property
    def peak_frequency(self) -> float:
        """Frequency in rad/s at which the worst loop's norm stands."""
        return self.worst.peak_frequency

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Poles of the worst loop in rad/s."""
        return self.worst.poles

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
        order = {"order": self.order} if self.order else {}
        proof = {"global": _to_plain_global(self.proof)} if self.proof else {}
        clipping = {"clipping": self.clipping._asdict()} if self.clipping else {}
        write_text(Path(path), dump({**order, **_to_plain(self), **proof, **clipping}))

    @classmethod
    def load(cls, path: str | Path) -> Design:
        """Read a design that `save` wrote.

        Raises:
            InputError: the file is missing, is not YAML, or lacks a key; file and key are named.
        """
        plain = Source(Path(path)).data
        try:
            return _from_plain(cast("_PlainDesign", plain))
        except KeyError as error:
            raise InputError(f"{path}: the design lacks the key {error}") from error
        except (TypeError, ValueError, IndexError, AttributeError, InputError) as error:
            raise InputError(f"{path}: not a design: {error}") from error


class _PlainProof(TypedDict):
    """A certificate as it stands in the file."""

    factor: list[list[float]]
    gamma: float
    delta: float
    largest_eigenvalue: float


class _ReadableProof(TypedDict):
    """The worst loop's certificate as one reads it: P itself, rounded."""

    gamma: float
    delta: float
    matrix: list[list[float]]


class _PlainLoop(TypedDict):
    """A loop as it stands in the file; `plant` holds its matrices and its structure by name."""

    gamma: float
    peak_frequency: float
    norms_agree: bool
    disk_margin: float
    poles: list[list[float]]
    certificate: _PlainProof | None
    plant: dict[str, list[list[float]] | None]


class _PlainDesign(TypedDict):
    """A design as it stands in the file; a static one states no order."""

    order: NotRequired[int]
    measures: NotRequired[list[str]]
    gain: list[list[float]]
    gamma: float
    max_gain: float
    lower_bound: float
    certificate: _ReadableProof | None
    loops: list[_PlainLoop]


def _to_plain(design: Design) -> _PlainDesign:
    return {
        "measures": list(design.measures),
        "gain": design.gain.tolist(),
        "gamma": design.gamma,
        "max_gain": design.max_gain,
        "lower_bound": design.lower_bound,
        "certificate": _to_readable_proof(design.certificate),
        "loops": [_to_plain_loop(loop) for loop in design.loops],
    }


def _to_plain_global(proof: GlobalProof) -> dict[str, object]:
    """Return the box of the free gains, the level over gamma, the number of boxes, and whether all are excluded."""
    box = [proof.low.tolist(), proof.high.tolist()]
    return {"box": box, "factor": FACTOR, "boxes": proof.boxes, "proven": proof.is_proven}


def _to_readable_proof(proof: Certificate | None) -> _ReadableProof | None:
    """Return the worst loop's proof as one reads it: P, rounded; that which `load` reads stands with the loop."""
    return None if proof is None else {"gamma": proof.gamma, "delta": proof.delta, "matrix": proof.matrix.tolist()}


def _to_plain_loop(loop: ClosedLoop) -> _PlainLoop:
    proof, free = loop.certificate, loop.plant.structure
    return {
        "gamma": loop.gamma,
        "peak_frequency": loop.peak_frequency,
        "norms_agree": loop.norms_agree,
        "disk_margin": loop.disk_margin,
        "poles": [[float(pole.real), float(pole.imag)] for pole in loop.poles],
        "certificate": None if proof is None else _to_plain_proof(proof),
        "plant": {name: getattr(loop.plant, name).tolist() for name in MATRICES}
        | {"structure": None if free is None else free.astype(int).tolist()},
    }


def _to_plain_proof(proof: Certificate) -> _PlainProof:
    return {
        "factor": proof.factor.tolist(),
        "gamma": proof.gamma,
        "delta": proof.delta,
        "largest_eigenvalue": proof.largest_eigenvalue,
    }


def _from_plain(plain: _PlainDesign) -> Design:
    gain, loops = np.array(plain["gain"], dtype=float), tuple(_from_plain_loop(loop) for loop in plain["loops"])
    if not np.isfinite(gain).all():
        raise ValueError("an entry of gain is not a finite number")
    if not loops:
        raise ValueError("loops is empty")
    wanted = (loops[0].plant.B2.shape[1], loops[0].plant.C2.shape[0])
    if gain.shape != wanted:
        raise ValueError(f"gain has the shape {gain.shape}; the plant of its loop has {wanted}, a row for each control")
    measures = tuple(map(str, plain.get("measures", ())))
    order = int(plain.get("order", 0))
    return Design(gain, float(plain["max_gain"]), float(plain["lower_bound"]), loops, measures, order=order)


def _from_plain_loop(plain: _PlainLoop) -> ClosedLoop:
    poles = np.array(plain["poles"], dtype=float)
    matrices = [cast(ArrayLike, plain["plant"][name]) for name in MATRICES]
    return ClosedLoop(
        plant=GeneralisedPlant.from_matrices(matrices, plain["plant"]["structure"]),
        gamma=float(plain["gamma"]),
        peak_frequency=float(plain["peak_frequency"]),
        norms_agree=bool(plain["norms_agree"]),
        certificate=plain["certificate"] and _from_plain_proof(plain["certificate"]),
        disk_margin=float(plain["disk_margin"]),
        poles=poles[:, 0] + 1j * poles[:, 1],
    )


def _from_plain_proof(plain: _PlainProof) -> Certificate:
    return Certificate(
        factor=np.array(plain["factor"], dtype=float),
        gamma=float(plain["gamma"]),
        delta=float(plain["delta"]),
        largest_eigenvalue=float(plain["largest_eigenvalue"]),
    )


# Two frequencies of equal height differ by rounding; a grid higher by more has found what bisection missed.
_ROUNDING = 1e-10
_AGREEMENT = 1e-6  # what the documentation states of the norm


def verify(plant: GeneralisedPlant, gain: Array, order: int = 0) -> ClosedLoop:
    """Return what is known of a plant under a stabilising gain (nu, ny); the last `order` controls are not physical."""
    loop = plant.close(gain)
    peak, agree = _compute_verified_norm(loop)
    certificate, margin = certify(plant, gain, peak.value), disk_margin(plant, gain, plant.control_count - order)
    return ClosedLoop(plant, peak.value, peak.frequency, agree, certificate, margin, loop.poles)


def _compute_verified_norm(loop: Loop) -> tuple[Peak, bool]:
    """Return the larger H-infinity norm of bisection and frequency grid, and whether the two agree to 1e-6."""
    norm, grid = hinf_norm(loop), grid_norm(loop)
    if norm.value < grid.value * (1 - _ROUNDING):
        norm = hinf_norm(loop, guesses=[grid.frequency])
    return norm, norm.value - grid.value <= _AGREEMENT * norm.value


def disk_margin(plant: GeneralisedPlant, gain: Array, controls: int) -> float:
    """Return the balanced disk margin at the first `controls`, 2 / ||2 S - I||, with S = (I - K G)^-1; at most 2."""
    A = plant.A + plant.B2 @ gain @ plant.C2
    return 2 / hinf_norm(Loop(A, plant.B2[:, :controls], 2 * gain[:controls] @ plant.C2, np.eye(controls))).value
