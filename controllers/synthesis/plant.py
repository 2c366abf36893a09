"""The generalised plant of static output feedback, and the loop that a gain closes.

    x' = A x + B1 w + B2 u        w: disturbances, u: control
    z  = C1 x + D11 w + D12 u     z: what is to stay small
    y  = C2 x + D21 w             y: what is measured (no direct path from u to y)
    u  = K y

B2, C2 are COMPleib's B, C.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError

if TYPE_CHECKING:
    import control

MATRICES = ("A", "B1", "B2", "C1", "C2", "D11", "D12", "D21")


class LinearSystem(NamedTuple):
    """A linear system `x' = A x + B u`, `y = C x + D u`; shapes (n, n), (n, m), (p, n), (p, m)."""

    A: Array
    B: Array
    C: Array
    D: Array

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A in rad/s, rightmost first."""
        poles = np.linalg.eigvals(self.A).astype(np.complex128)
        return poles[np.lexsort((-poles.imag, -poles.real))]

    @property
    def abscissa(self) -> float:
        """Largest real part of the poles in 1/s; negative where it is stable."""
        return float(np.linalg.eigvals(self.A).real.max())


def close_loop(matrices: Sequence[NDArray[Any]], K: NDArray[Any]) -> LinearSystem:
    """Return the loop of `u = K y` around a plant of eight matrices, as `GeneralisedPlant.close` states it."""
    A, B1, B2, C1, C2, D11, D12, D21 = matrices
    left, right = B2 @ K, D12 @ K
    return LinearSystem(A + left @ C2, B1 + left @ D21, C1 + right @ C2, D11 + right @ D21)


@dataclass(frozen=True, eq=False)
class GeneralisedPlant:
    """The eight matrices of the plant; `B2`, `C2` are COMPleib's `B`, `C`.

    Shapes: A (n, n), B1 (n, nw), B2 (n, nu), C1 (nz, n), C2 (ny, n), D11 (nz, nw), D12 (nz, nu), D21 (ny, nw).
    `structure` (nu, ny) marks with True or 1 the gains that are free; the others stay zero. Default: all free.
    Units are the user's own, time in seconds.

    Raises:
        InputError: a matrix is not a finite real matrix, or its shape does not fit the others.
    """

    A: Array
    B1: Array
    B2: Array
    C1: Array
    C2: Array
    D11: Array
    D12: Array
    D21: Array
    structure: NDArray[np.bool_] | None = None

    def __post_init__(self) -> None:
        for name in MATRICES:
            object.__setattr__(self, name, _matrix(name, getattr(self, name)))
        _check_shapes(self)
        shape = (self.control_count, self.measured_count)
        object.__setattr__(self, "structure", _structure(self.structure, shape))

    @property
    def order(self) -> int:
        """Number of states n."""
        return len(self.A)

    @property
    def control_count(self) -> int:
        """Number of control inputs nu."""
        return int(self.B2.shape[1])

    @property
    def measured_count(self) -> int:
        """Number of measurements ny."""
        return len(self.C2)

    @property
    def system(self) -> LinearSystem:
        """The plant with inputs [w; u] and outputs [z; y]."""
        through = np.zeros((self.measured_count, self.control_count))
        D = np.block([[self.D11, self.D12], [self.D21, through]])
        return LinearSystem(self.A, np.hstack([self.B1, self.B2]), np.vstack([self.C1, self.C2]), D)

    @property
    def free(self) -> NDArray[np.bool_]:
        """Which gains are free, (nu, ny)."""
        if self.structure is None:
            return np.ones((self.control_count, self.measured_count), dtype=bool)
        return self.structure

    def close(self, gain: ArrayLike) -> LinearSystem:
        """Return the loop of `u = gain @ y`: A + B2 K C2, B1 + B2 K D21, C1 + D12 K C2, D11 + D12 K D21."""
        return close_loop([getattr(self, name) for name in MATRICES], np.asarray(gain, dtype=float))

    def with_controller_states(self, order: int) -> GeneralisedPlant:
        """Return the plant whose static gain [[D_K, C_K], [B_K, A_K]] is a controller with `order` states.

        The controller is x_K' = A_K x_K + B_K y, u = C_K x_K + D_K y: integrators x_K' = u_K join the plant's states,
        u_K its controls and x_K its measurements. All of A_K, B_K, C_K is free.
        Source: El Ghaoui, Oustry & AitRami 1997, IEEE Trans. Autom. Control 42:1171.
        """
        A, B, C, D = (np.pad(part, (0, order)) for part in self.system)
        controls, measured = B.shape[1] - order, len(C) - order
        B[self.order :, controls:] = C[measured:, self.order :] = np.eye(order)
        free = np.pad(self.free, (0, order), constant_values=True)
        return GeneralisedPlant.from_system(LinearSystem(A, B, C, D), self.B1.shape[1], len(self.C1), free)

    @classmethod
    def from_state_space(
        cls, system: control.StateSpace, disturbances: int, performance: int, structure: ArrayLike | None = None
    ) -> GeneralisedPlant:
        """Split a continuous-time system with inputs [w; u] and outputs [z; y].

        The first `disturbances` inputs are w, the first `performance` outputs are z.

        Raises:
            InputError: the system is sampled, u reaches y directly, or the split leaves a part empty.
        """
        if system.dt:
            raise InputError(f"the plant is sampled (dt = {system.dt}); H-infinity synthesis wants continuous time")
        parts = LinearSystem(*(_matrix(name, getattr(system, name)) for name in "ABCD"))
        outputs, inputs = parts.D.shape
        sides = (("disturbance inputs", disturbances, inputs), ("performance outputs", performance, outputs))
        for name, count, total in sides:
            if not 0 < count < total:
                raise InputError(f"split: {count} {name} of {total}; at least one must be on each side")
        if np.any(parts.D[performance:, disturbances:]):
            raise InputError("u reaches y directly (D22 is not zero); subtract D22 @ u from the measurement first")
        return cls.from_system(parts, disturbances, performance, structure)

    @classmethod
    def from_system(
        cls, system: LinearSystem, disturbances: int, performance: int, structure: ArrayLike | None = None
    ) -> GeneralisedPlant:
        """Split a system whose first inputs are w and whose first outputs are z; the path from u to y is left out."""
        A, B, C, D = system
        w, z = slice(None, disturbances), slice(None, performance)
        u, y = slice(disturbances, None), slice(performance, None)
        return cls.from_matrices((A, B[:, w], B[:, u], C[z], C[y], D[z, w], D[z, u], D[y, w]), structure)

    @classmethod
    def from_matrices(cls, matrices: Sequence[ArrayLike], structure: ArrayLike | None = None) -> GeneralisedPlant:
        """Return the plant of eight matrices, in the order of `MATRICES`, given as arrays or as nested lists.

        Raises:
            InputError: as the class does.
        """
        A, B1, B2, C1, C2, D11, D12, D21 = (_matrix(*part) for part in zip(MATRICES, matrices, strict=True))
        # The structure is converted with the plant, after the shapes that it has to fit.
        return cls(A, B1, B2, C1, C2, D11, D12, D21, cast("NDArray[np.bool_] | None", structure))


def _matrix(name: str, value: ArrayLike) -> Array:
    if np.iscomplexobj(value):
        raise InputError(f"{name} is complex; a matrix of real numbers is wanted")
    try:
        matrix = np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is not a matrix of real numbers: {error}") from error
    if matrix.ndim != 2 or 0 in matrix.shape:
        raise InputError(f"{name} has shape {matrix.shape}; a matrix with a row and a column at least is wanted")
    if not np.isfinite(matrix).all():
        row, column = np.argwhere(~np.isfinite(matrix))[0]
        raise InputError(f"{name}[{row}, {column}] is {matrix[row, column]}; finite numbers are wanted")
    matrix.flags.writeable = False
    return matrix


def _check_shapes(plant: GeneralisedPlant) -> None:
    n, nw, nu = len(plant.A), plant.B1.shape[1], plant.B2.shape[1]
    nz, ny = len(plant.C1), len(plant.C2)
    wanted = ((n, n), (n, nw), (n, nu), (nz, n), (ny, n), (nz, nw), (nz, nu), (ny, nw))
    for name, shape in zip(MATRICES, wanted, strict=True):
        found = getattr(plant, name).shape
        if found != shape:
            raise InputError(
                f"{name} has shape {found}, wanted is {shape}: "
                f"{n} states, {nw} disturbances, {nu} controls, {nz} performance outputs, {ny} measurements"
            )


def _structure(value: ArrayLike | None, shape: tuple[int, int]) -> NDArray[np.bool_] | None:
    if value is None:
        return None
    mask = _matrix("structure", value)
    if mask.shape != shape or not np.isin(mask, (0.0, 1.0)).all():
        raise InputError(f"structure must be a {shape} matrix of True (free) and False (stays zero), got {value!r}")
    if not mask.any():
        raise InputError("structure leaves no gain free")
    return mask.astype(bool)
