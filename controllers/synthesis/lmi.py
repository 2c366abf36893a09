"""Linear matrix inequalities: the only module that imports cvxpy (2.5 s), so import it where it is used.

All problems are posed in states where a known Lyapunov matrix is the identity, with gamma near 1: in raw units solvers fail.
"""

from __future__ import annotations

import warnings
from typing import Any

import cvxpy as cp
import numpy as np
import scipy.linalg

from controllers.synthesis.plant import Array, GeneralisedPlant

_STRICT = 1e-7


def full_order_bound(plant: GeneralisedPlant, lyapunov: Array, gamma: float, time_limit: float) -> float:
    """Return the best gamma that any linear controller of order up to n reaches; 0 where the solver fails.

        minimise g over R, S:  [R I; I S] >= 0,
        NR' [A R + R A', R C1', B1; C1 R, -g I, D11; B1', D11', -g I] NR <= 0,   NR spans the kernel of [B2' D12' 0],
        NS' [A'S + S A, S B1, C1'; B1'S, -g I, D11'; C1, D11, -g I] NS <= 0,     NS spans the kernel of [C2 D21 0].

    `lyapunov` (n, n) certifies some static gain at `gamma`, so that in its coordinates R = S = I is feasible at g = 1.
    Source: Gahinet & Apkarian 1994, Int. J. Robust Nonlinear Control 4:421, theorem 4.3.
    """
    p = recentred(plant, lyapunov, gamma)
    n = p.order
    R, S, g = cp.Variable((n, n), symmetric=True), cp.Variable((n, n), symmetric=True), cp.Variable()
    one = np.eye(n)
    constraints = [
        cp.bmat([[R, one], [one, S]]) >> 0,
        _projected(p.A.T, p.C1, p.B1, p.D11, np.hstack([p.B2.T, p.D12.T]), R, g) << 0,
        _projected(p.A, p.B1.T, p.C1.T, p.D11.T, np.hstack([p.C2, p.D21]), S, g) << 0,
    ]
    return gamma * float(g.value) if _solve(g, constraints, time_limit) else 0.0


def _projected(A: Array, inner: Array, outer: Array, D: Array, blocked: Array, X: Any, g: Any) -> Any:
    """N' [A'X + X A, X inner', outer; inner X, -g I, D; outer', D', -g I] N with N the kernel of [blocked, 0]."""
    rows, columns = D.shape
    full = cp.bmat(
        [
            [A.T @ X + X @ A, X @ inner.T, outer],
            [inner @ X, -g * np.eye(rows), D],
            [outer.T, D.T, -g * np.eye(columns)],
        ]
    )
    N = scipy.linalg.block_diag(scipy.linalg.null_space(blocked), np.eye(columns))
    product = N.T @ full @ N
    return (product + product.T) / 2


def recentred(plant: GeneralisedPlant, lyapunov: Array, gamma: float) -> GeneralisedPlant:
    """Return the plant in states L'x (lyapunov = L L') and time such that ||A|| = 1, w and z scaled so that `gamma` becomes 1.

    Columns of B2 and rows of C2 have unit length; gains are not kept track of.
    """
    L = np.linalg.cholesky(lyapunov)
    A = scipy.linalg.solve_triangular(L, (L.T @ plant.A).T, lower=True).T
    time, size = np.sqrt(np.linalg.norm(A, 2)), np.sqrt(gamma)
    B2, C2 = L.T @ plant.B2 / time, scipy.linalg.solve_triangular(L, plant.C2.T, lower=True).T / time
    controls, measured = 1 / np.linalg.norm(B2, axis=0), 1 / np.linalg.norm(C2, axis=1)[:, None]
    return GeneralisedPlant(
        A / time**2,
        L.T @ plant.B1 / (time * size),
        B2 * controls,
        scipy.linalg.solve_triangular(L, plant.C1.T, lower=True).T / (time * size),
        C2 * measured,
        plant.D11 / gamma,
        plant.D12 * controls / size,
        plant.D21 * measured / size,
    )


def _solve(objective: Any, constraints: list[Any], time_limit: float) -> bool:
    problem = cp.Problem(cp.Minimize(objective), constraints)
    with warnings.catch_warnings():
        # An inaccurate solution is still usable here: every caller verifies or rounds.
        warnings.filterwarnings("ignore", message="Solution may be inaccurate")
        try:
            problem.solve(solver=cp.CLARABEL, time_limit=max(time_limit, 0.1))
        except cp.SolverError:
            return False
    return problem.status in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE)
