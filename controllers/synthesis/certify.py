"""The certificate of a design: a Lyapunov matrix that proves the bound by the bounded-real lemma.

    P > 0,   M(P) = [A'P + PA, PB, C'; B'P, -gamma I, D'; C, D, -gamma I] < 0

proves ||T|| < gamma and stability; whoever has P need only look at signs. P comes from the equation

    A'P + PA + C'C / gamma + e I + (PB + C'D / gamma) (gamma I - D'D / gamma)^-1 (PB + C'D / gamma)' = 0

whose slack e > 0 makes M(P) < 0 strict. The signs are those of matrices without rounding: doubles are whole numbers
over powers of two, hence decimals of finitely many digits, and so are their sums and products.
Source: Boyd, El Ghaoui, Feron & Balakrishnan 1994, section 2.7.3.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import MAX_EMAX, MAX_PREC, MIN_EMIN, Context, Decimal, Inexact, localcontext
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from controllers.synthesis.norm import balance, hinf_norm
from controllers.synthesis.plant import MATRICES, GeneralisedPlant, LinearSystem, close_loop
from seatsim.schema.arrays import Array

# Sums and products take as many digits as they need; a rounded one would be an error.
EXACT = Context(prec=MAX_PREC, Emin=MIN_EMIN, Emax=MAX_EMAX, traps=[Inexact])


def _without_rounding(matrix: Array) -> NDArray[np.object_]:
    """Return a matrix of doubles as one of decimals, to be used under the context `EXACT`."""
    return np.array([[Decimal(value) for value in row] for row in matrix.tolist()], dtype=object)


def rounded(matrix: NDArray[Any]) -> Array:
    """Return the nearest doubles."""
    return matrix.astype(float) + 0.0  # no zero keeps a sign


def _close_exactly(plant: GeneralisedPlant, gain: Array) -> LinearSystem:
    """Return A, B, C, D of the closed loop as `GeneralisedPlant.close` does, without rounding."""
    *matrices, K = (_without_rounding(matrix) for matrix in (*(getattr(plant, name) for name in MATRICES), gain))
    return close_loop(matrices, K)


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
        with localcontext(EXACT):
            T, back, one = _invert(factor)
            A, B, C, D = _close_exactly(plant, gain)
            flow, drive, seen = (rounded(part) for part in (one.T @ T @ A @ back, one.T @ T @ B, C @ back))
    except np.linalg.LinAlgError:
        return np.inf
    rate = float(np.linalg.norm(flow, 2))
    flow, drive, seen = flow / rate, drive / np.sqrt(gamma * rate), seen / np.sqrt(gamma * rate)
    through = rounded(D) / gamma
    inputs, outputs = np.eye(drive.shape[1]), np.eye(len(seen))
    M = np.block([[flow + flow.T, drive, seen.T], [drive.T, -inputs, through.T], [seen, through, -outputs]])
    # P > 0 where factor is regular, which its product with about its inverse shows.
    if not np.isfinite(M).all() or np.linalg.norm(rounded(one) - np.eye(plant.order), 2) > _REGULAR:
        return np.inf
    allowance = _ROUNDING * len(M) * np.finfo(float).eps * float(np.linalg.norm(M, 2))
    return float(np.linalg.eigvalsh(M)[-1] + allowance)


def _invert(factor: Array) -> tuple[NDArray[np.object_], NDArray[np.object_], NDArray[np.object_]]:
    """Return a matrix, about its inverse, and their product; raise LinAlgError where it is singular."""
    inverse = np.asarray(np.linalg.inv(factor), dtype=float)
    if not np.isfinite(inverse).all():
        raise np.linalg.LinAlgError
    T, back = _without_rounding(factor), _without_rounding(inverse)
    return T, back, T @ back


def _recentre(plant: GeneralisedPlant, gain: Array, factor: Array) -> LinearSystem:
    """Return the closed loop in the states `factor` x, in which P becomes the identity, free of the loop's rounding."""
    identity = np.eye(len(factor))
    with localcontext(EXACT):
        A, B, C, D = _close_exactly(plant, gain)
        T, back, one = _invert(factor)
        # The inverse of factor is back (I + E)^-1, with E = factor back - I as small as rounding.
        correction = np.linalg.inv(identity + rounded(one - _without_rounding(identity)))
        flow, seen = rounded(T @ A @ back) @ correction, rounded(C @ back) @ correction
        return LinearSystem(flow, rounded(T @ B), seen, rounded(D))


def _bounded_real_factor(plant: GeneralisedPlant, gain: Array, level: float, delta: float) -> Array | None:
    """Solve the Riccati equation in balanced states, then again in those where its solution is the identity."""
    start = factor = np.diag(1 / balance(plant.close(gain))[1])
    for _ in range(_RECENTRED):
        try:
            P = _riccati(_recentre(plant, gain, factor), level, delta)
            factor = np.asarray(np.linalg.qr(np.linalg.cholesky(P).T @ factor, mode="r"))
        except (np.linalg.LinAlgError, ValueError):
            break
    return None if factor is start else factor


def _riccati(loop: LinearSystem, level: float, delta: float) -> Array:
    n, nw = loop.B.shape
    B, C, D = loop.B / np.sqrt(level), loop.C / np.sqrt(level), loop.D / level
    # With the output sqrt(slack) x added, the squared norm grows by slack * reach^2 <= delta, and stays below 1.
    reach = hinf_norm(LinearSystem(loop.A, B, np.eye(n), np.zeros((n, nw)))).value
    slack = delta / max(reach, 1.0) ** 2
    Q, R = C.T @ C + slack * np.eye(n), D.T @ D - np.eye(nw)
    P: Array = scipy.linalg.solve_continuous_are(loop.A, B, Q, R, s=C.T @ D)
    return (P + P.T) / 2
