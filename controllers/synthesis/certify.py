"""The certificate of a design: a Lyapunov matrix that proves the bound by the bounded-real lemma.

    P > 0,   M(P) = [A'P + PA, PB, C'; B'P, -gamma I, D'; C, D, -gamma I] < 0

proves ||T|| < gamma and stability; whoever has P need only look at eigenvalues. P comes from the equation

    A'P + PA + C'C / gamma + e I + (PB + C'D / gamma) (gamma I - D'D / gamma)^-1 (PB + C'D / gamma)' = 0

whose slack e > 0 makes M(P) < 0 strict. Source: Boyd, El Ghaoui, Feron & Balakrishnan 1994, section 2.7.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from controllers.synthesis.norm import balanced, hinf_norm
from controllers.synthesis.plant import Array, Loop

_DELTAS = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)


@dataclass(frozen=True, eq=False)
class Certificate:
    """Proof that the closed loop is stable with H-infinity norm below `gamma`.

    `matrix` is P (n, n) in the user's states, `gamma` is (1 + delta) times the design's, and `largest_eigenvalue`,
    negative, is that of M(P) as `largest_lmi_eigenvalue` defines it.
    """

    matrix: Array
    gamma: float
    delta: float
    largest_eigenvalue: float


def certify(loop: Loop, gamma: float) -> Certificate | None:
    """Return the certificate with the smallest delta of 1e-7 ... 1e-2 that double precision can verify, else None."""
    for delta in _DELTAS if gamma > 0 else ():
        level = gamma * (1 + delta)
        matrix = _bounded_real_matrix(loop, level, delta)
        if matrix is None:
            continue
        largest = largest_lmi_eigenvalue(loop, matrix, level)
        if largest < 0:
            return Certificate(matrix, level, delta, largest)
    return None


def largest_lmi_eigenvalue(loop: Loop, matrix: Array, gamma: float) -> float:
    """Return the largest eigenvalue of M(P) in scaled coordinates: gamma = 1, states with P = I, time with ||A|| = 1.

    Its sign is that of the LMI in raw units. An allowance for rounding, 10 eps times the condition of the change of
    coordinates, is added. Infinity where P is not positive definite.
    """
    try:
        loop = recentre(loop, matrix)
    except np.linalg.LinAlgError:
        return np.inf
    diagonal = np.sqrt(np.diag(matrix))
    allowance = 10 * np.finfo(float).eps * np.sqrt(np.linalg.cond(matrix / np.outer(diagonal, diagonal)))
    rate = float(np.linalg.norm(loop.A, 2))
    A, B, C, D = loop.A / rate, loop.B / np.sqrt(gamma * rate), loop.C / np.sqrt(gamma * rate), loop.D / gamma
    M = np.block([[A + A.T, B, C.T], [B.T, -np.eye(B.shape[1]), D.T], [C, D, -np.eye(len(C))]])
    return float(np.linalg.eigvalsh(M)[-1] + allowance)


def recentre(loop: Loop, matrix: Array) -> Loop:
    """Return the loop in the states L'x, P = L L', in which P becomes the identity."""
    L = np.linalg.cholesky(matrix)
    return Loop(
        scipy.linalg.solve_triangular(L, (L.T @ loop.A).T, lower=True).T,
        L.T @ loop.B,
        scipy.linalg.solve_triangular(L, loop.C.T, lower=True).T,
        loop.D,
    )


def _bounded_real_matrix(loop: Loop, level: float, delta: float) -> Array | None:
    """Solve the Riccati equation in balanced states, then once more in those where its solution is the identity."""
    states = balanced(loop)[1]
    matrix = np.diag(states**-2.0)
    try:
        for _ in range(2):
            L = np.linalg.cholesky(matrix)
            P = _riccati(recentre(loop, matrix), level, delta)
            matrix = L @ P @ L.T
            matrix = (matrix + matrix.T) / 2
    except (np.linalg.LinAlgError, ValueError):
        return None
    return matrix


def _riccati(loop: Loop, level: float, delta: float) -> Array:
    n, nw = loop.B.shape
    B, C, D = loop.B / np.sqrt(level), loop.C / np.sqrt(level), loop.D / level
    # With the output sqrt(slack) x added, the squared norm grows by slack * reach^2 <= delta, and stays below 1.
    reach = hinf_norm(Loop(loop.A, B, np.eye(n), np.zeros((n, nw)))).value
    slack = delta / max(reach, 1.0) ** 2
    P: Array = scipy.linalg.solve_continuous_are(
        loop.A, B, C.T @ C + slack * np.eye(n), D.T @ D - np.eye(nw), s=C.T @ D
    )
    return P
