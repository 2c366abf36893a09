"""The certificate of a design: a Lyapunov matrix that proves the bound by the bounded-real lemma.

    P > 0,   M(P) = [A'P + PA, PB, C'; B'P, -gamma I, D'; C, D, -gamma I] < 0

proves ||T|| < gamma and stability; whoever has P need only look at signs. P comes from the equation

    A'P + PA + C'C / gamma + e I + (PB + C'D / gamma) (gamma I - D'D / gamma)^-1 (PB + C'D / gamma)' = 0

whose slack e > 0 makes M(P) < 0 strict. The signs are those of matrices without rounding (`ExactMatrix`): doubles are
whole numbers over powers of two, and so are their sums and products.
Source: Boyd, El Ghaoui, Feron & Balakrishnan 1994, section 2.7.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from controllers.synthesis.norm import balance, hinf_norm
from controllers.synthesis.plant import GeneralisedPlant, Loop
from seatsim.schema.arrays import Array


@dataclass(frozen=True, eq=False)
class ExactMatrix:
    """The matrix `whole / 2^bits`, `whole` an array of Python's integers; `@`, `+`, `-` and `.T` are exact."""

    whole: NDArray[np.object_]
    bits: int

    @classmethod
    def of(cls, matrix: Array) -> ExactMatrix:
        """Return a matrix of doubles as it is."""
        ratios = [[value.as_integer_ratio() for value in row] for row in matrix.tolist()]
        bits = max((bottom.bit_length() - 1 for row in ratios for _, bottom in row), default=0)
        whole = np.empty(matrix.shape, dtype=object)
        for i, row in enumerate(ratios):
            for j, (top, bottom) in enumerate(row):
                whole[i, j] = top << (bits - bottom.bit_length() + 1)
        return cls(whole, bits)

    def __matmul__(self, other: ExactMatrix) -> ExactMatrix:
        # Python's integers grow as they must: numpy multiplies and adds them as objects, without overflow.
        return ExactMatrix(self.whole @ other.whole, self.bits + other.bits)

    def __add__(self, other: ExactMatrix) -> ExactMatrix:
        bits = max(self.bits, other.bits)
        return ExactMatrix(self.whole * 2 ** (bits - self.bits) + other.whole * 2 ** (bits - other.bits), bits)

    def __sub__(self, other: ExactMatrix) -> ExactMatrix:
        return self + ExactMatrix(-other.whole, other.bits)

    @property
    def T(self) -> ExactMatrix:  # noqa: N802 - as in NumPy
        """The transposed matrix."""
        return ExactMatrix(self.whole.T, self.bits)

    def rounded(self) -> Array:
        """Return the nearest doubles."""
        bottom = 1 << self.bits
        return np.array([[top / bottom for top in row] for row in self.whole.tolist()], dtype=float)


def close_exactly(plant: GeneralisedPlant, gain: Array) -> tuple[ExactMatrix, ExactMatrix, ExactMatrix, ExactMatrix]:
    """Return A, B, C, D of the closed loop as `GeneralisedPlant.close` does, without rounding."""
    A, B1, B2, C1, C2, D11, D12, D21 = (
        ExactMatrix.of(m) for m in (plant.A, plant.B1, plant.B2, plant.C1, plant.C2, plant.D11, plant.D12, plant.D21)
    )
    left, right = B2 @ ExactMatrix.of(gain), D12 @ ExactMatrix.of(gain)
    return A + left @ C2, B1 + left @ D21, C1 + right @ C2, D11 + right @ D21


# Excess of the certified gamma over the norm: the smallest that double precision can prove is taken.
_DELTAS = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 5e-2)
# In states where the solution is the identity, the Riccati equation is best conditioned; three rounds settle.
_RECENTRED = 3
# Rounding of the eigenvalues of a symmetric matrix of order n, in units of n eps times its norm.
_ROUNDING = 4
# ||factor inverse - I|| below 1 proves that factor is regular; half of that leaves room for rounding.
_REGULAR = 0.5


@dataclass(frozen=True, eq=False)
class Certificate:
    """Proof that the closed loop is stable with H-infinity norm below `gamma`.

    P = factor' factor without rounding, `factor` (n, n), in the user's states; `gamma` is (1 + delta) times the
    design's, and `largest_eigenvalue`, negative, is that of M(P) as `largest_lmi_eigenvalue` defines it.
    """

    factor: Array
    gamma: float
    delta: float
    largest_eigenvalue: float

    @property
    def matrix(self) -> Array:
        """P (n, n), rounded."""
        return self.factor.T @ self.factor


def certify(plant: GeneralisedPlant, gain: Array, gamma: float) -> Certificate | None:
    """Return the certificate with the smallest delta of 1e-7 ... 0.05 that exact products verify, else None.

    `gain` (nu, ny) closes the loop, whose norm is `gamma`.
    """
    for delta in _DELTAS if gamma > 0 else ():
        level = gamma * (1 + delta)
        factor = _bounded_real_factor(plant, gain, level, delta)
        if factor is None:
            continue
        largest = largest_lmi_eigenvalue(plant, gain, factor, level)
        if largest < 0:
            return Certificate(factor, level, delta, largest)
    return None


def largest_lmi_eigenvalue(plant: GeneralisedPlant, gain: Array, factor: Array, gamma: float) -> float:
    """Return the largest eigenvalue of M(P), P = factor' factor, in scaled coordinates, where negative proves P.

    In these gamma = 1, P is about I and ||A|| = 1. M(P) is formed without rounding, moved by a congruence, rounded once
    to doubles, and the rounding of its eigenvalues is added. Infinity where `factor` is singular.
    """
    try:
        W = np.asarray(np.linalg.inv(factor), dtype=float)
    except np.linalg.LinAlgError:
        return np.inf
    if not np.isfinite(W).all():
        return np.inf
    A, B, C, D = close_exactly(plant, gain)
    T, back = ExactMatrix.of(factor), ExactMatrix.of(W)
    one = T @ back
    flow, drive, seen = (one.T @ T @ A @ back).rounded(), (one.T @ T @ B).rounded(), (C @ back).rounded()
    rate = float(np.linalg.norm(flow, 2))
    flow, drive, seen = flow / rate, drive / np.sqrt(gamma * rate), seen / np.sqrt(gamma * rate)
    through = D.rounded() / gamma
    M = np.block(
        [
            [flow + flow.T, drive, seen.T],
            [drive.T, -np.eye(drive.shape[1]), through.T],
            [seen, through, -np.eye(len(seen))],
        ]
    )
    # P > 0 where factor is regular, which its product with about its inverse shows.
    if not np.isfinite(M).all() or np.linalg.norm(one.rounded() - np.eye(plant.order), 2) > _REGULAR:
        return np.inf
    allowance = _ROUNDING * len(M) * np.finfo(float).eps * float(np.linalg.norm(M, 2))
    return float(np.linalg.eigvalsh(M)[-1] + allowance)


def recentre(plant: GeneralisedPlant, gain: Array, factor: Array) -> Loop:
    """Return the closed loop in the states `factor` x, in which P becomes the identity, free of the loop's rounding."""
    A, B, C, D = close_exactly(plant, gain)
    inverse = np.asarray(np.linalg.inv(factor), dtype=float)
    T, back = ExactMatrix.of(factor), ExactMatrix.of(inverse)
    # The inverse of factor is back (I + E)^-1, with E = factor back - I as small as rounding.
    E = (T @ back - ExactMatrix.of(np.eye(len(factor)))).rounded()
    correction = np.linalg.inv(np.eye(len(factor)) + E)
    flow, seen = (T @ A @ back).rounded() @ correction, (C @ back).rounded() @ correction
    return Loop(flow, (T @ B).rounded(), seen, D.rounded())


def _bounded_real_factor(plant: GeneralisedPlant, gain: Array, level: float, delta: float) -> Array | None:
    """Solve the Riccati equation in balanced states, then again in those where its solution is the identity."""
    factor = np.diag(1 / balance(plant.close(gain))[1])
    answer = None
    for _ in range(_RECENTRED):
        try:
            P = _riccati(recentre(plant, gain, factor), level, delta)
            factor = np.asarray(np.linalg.qr(np.linalg.cholesky(P).T @ factor, mode="r"))
        except (np.linalg.LinAlgError, ValueError):
            break
        answer = factor
    return answer


def _riccati(loop: Loop, level: float, delta: float) -> Array:
    n, nw = loop.B.shape
    B, C, D = loop.B / np.sqrt(level), loop.C / np.sqrt(level), loop.D / level
    # With the output sqrt(slack) x added, the squared norm grows by slack * reach^2 <= delta, and stays below 1.
    reach = hinf_norm(Loop(loop.A, B, np.eye(n), np.zeros((n, nw)))).value
    slack = delta / max(reach, 1.0) ** 2
    Q, R = C.T @ C + slack * np.eye(n), D.T @ D - np.eye(nw)
    P: Array = scipy.linalg.solve_continuous_are(loop.A, B, Q, R, s=C.T @ D)
    return (P + P.T) / 2
