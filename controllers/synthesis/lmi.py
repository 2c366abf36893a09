"""Linear matrix inequalities: the only module that imports cvxpy, so import it where it is used.

All problems are posed in states where a known Lyapunov matrix is about the identity, with gamma near 1: in raw
units solvers fail.
"""

from __future__ import annotations

import time
import warnings

import cvxpy as cp
import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from controllers.synthesis.plant import GeneralisedPlant
from seatsim.schema.arrays import Array

# The bound is solved again in the coordinates of its own solution until it settles.
_PASSES, _SETTLED = 4, 1e-5
# Eigenvalues of the Lyapunov matrix stay between 1 / width and width, in states where it is about the identity.
_WIDTH = 1e3
# A gain from the edge of the feasible set is badly conditioned; at twice the optimal g there is room to step back.
_RELAXED = 2.0
_STRICT = 1e-7  # margin that turns < into <=, above the rounding of the solver


def compute_full_order_bound(plant: GeneralisedPlant, factor: Array, gamma: float, deadline: float) -> float:
    """Return the best gamma that any linear controller reaches (order n suffices); 0 where the solver fails.

        minimise g over R, S:  [R I; I S] >= 0,
        NR' [A R + R A', R C1', B1; C1 R, -g I, D11; B1', D11', -g I] NR <= 0,   NR = kernel of [B2' D12' 0],
        NS' [A'S + S A, S B1, C1'; B1'S, -g I, D11'; C1, D11, -g I] NS <= 0,     NS = kernel of [C2 D21 0].

    `factor` (n, n), with factor' factor the Lyapunov matrix, certifies a static gain at `gamma`, so that in its states
    R = S = I is feasible at g = 1. R and S often run to 1e5: solved again with R = r R~ r', S = s S~ s' until the
    value settles.
    Source: Gahinet & Apkarian 1994, Int. J. Robust Nonlinear Control 4:421, theorem 4.3.
    """
    p = _recentre(plant, factor, gamma)
    one = np.eye(p.order)
    r, s, value = one, one, 0.0
    for _ in range(_PASSES):
        R, S = cp.Variable(one.shape, symmetric=True), cp.Variable(one.shape, symmetric=True)
        g, ri, si = cp.Variable(), np.linalg.inv(r), np.linalg.inv(s)
        constraints = [
            cp.bmat([[R, ri @ si.T], [si @ ri.T, S]]) >> 0,
            _project(_change_states(_transpose(p), ri.T), R, g) << 0,
            _project(_change_states(p, si.T), S, g) << 0,
        ]
        if not _solve(g, constraints, deadline):
            break
        r, s = r @ _symmetric_root(R.value), s @ _symmetric_root(S.value)
        settled = abs(value - float(g.value)) <= _SETTLED * float(g.value)
        value = float(g.value)
        if settled:
            break
    return gamma * value


def find_single_step_gain(plant: GeneralisedPlant, gamma: float, deadline: float) -> Array | None:
    """Return a stabilising gain (nu, ny) from two convex problems, None where they have no solution.

        minimise g over X > 0, Y:
        [A X + X A' + B2 Y + Y'B2', B1, X C1' + Y'D12'; B1', -g I, D11'; C1 X + D12 Y, D11, -g I] < 0,

    first with X, Y free (state feedback, solution X*), then in states where X* = I with X = Q XQ Q' + R XR R',
    Y = YR R', C2 Q = 0, C2 R = I: then Y = K C2 X with K = YR XR^-1. `gamma` sets the scale of g. The effect of D21
    on the norm is left out, unless D12 = 0, where the transposed problem takes it in. Not every plant that can be
    stabilised has such a gain; none is sought for structured gains or linearly dependent measurements.
    Source: Rubio-Massegu, Palacios-Quinonero, Rossell & Karimi 2013, Math. Probl. Eng. 2013:907056.
    """
    if np.any(plant.D21) and not np.any(plant.D12):
        swapped = find_single_step_gain(_transpose(plant), gamma, deadline)
        return None if swapped is None else swapped.T
    if not plant.free.all() or np.linalg.matrix_rank(plant.C2) < plant.measured_count:
        return None
    X, Y = cp.Variable((plant.order, plant.order), symmetric=True), cp.Variable((plant.control_count, plant.order))
    if not _minimise_norm(plant, gamma, X, Y, deadline):
        return None
    moved, ny = _change_states(plant, _symmetric_root(X.value)), plant.measured_count
    R, Q = np.linalg.pinv(moved.C2), scipy.linalg.null_space(moved.C2)
    XR, YR = cp.Variable((ny, ny), symmetric=True), cp.Variable(plant.free.shape)
    X = R @ XR @ R.T
    if Q.shape[1]:
        X = X + Q @ cp.Variable((Q.shape[1], Q.shape[1]), symmetric=True) @ Q.T
    if not _minimise_norm(moved, gamma, X, YR @ R.T, deadline):
        return None
    return np.asarray(YR.value @ np.linalg.inv(XR.value))


def _minimise_norm(plant: GeneralisedPlant, gamma: float, X: cp.Expression, Y: cp.Expression, deadline: float) -> bool:
    """Minimise g over X and Y; then, at a somewhat larger g, move them away from the edge and its extremes."""
    g, margin = cp.Variable(), cp.Variable()
    one = np.eye(plant.order)
    sizes = [X >> one / _WIDTH, X << one * _WIDTH]
    H = _bounded_real(plant, gamma, X, Y, g)
    if not _solve(g, [H << -_STRICT * np.eye(H.shape[0]), *sizes], deadline):
        return False
    H = _bounded_real(plant, gamma, X, Y, _RELAXED * float(g.value))
    return _solve(-margin, [H << -margin * np.eye(H.shape[0]), *sizes], deadline)


def _bounded_real(
    plant: GeneralisedPlant, gamma: float, X: cp.Expression, Y: cp.Expression, g: cp.Expression | float
) -> cp.Expression:
    flow, seen = plant.A @ X + plant.B2 @ Y, (plant.C1 @ X + plant.D12 @ Y) / np.sqrt(gamma)
    H = _stack(flow + flow.T, plant.B1 / np.sqrt(gamma), seen, plant.D11 / gamma, g)
    return (H + H.T) / 2


def _project(plant: GeneralisedPlant, X: cp.Expression, g: cp.Expression) -> cp.Expression:
    """N' [A'X + X A, X B1, C1'; B1'X, -g I, D11'; C1, D11, -g I] N with N the kernel of [C2, D21, 0]."""
    full = _stack(plant.A.T @ X + X @ plant.A, X @ plant.B1, plant.C1, plant.D11, g)
    kernel = scipy.linalg.null_space(np.hstack([plant.C2, plant.D21]))
    N = scipy.linalg.block_diag(kernel, np.eye(len(plant.C1)))
    product = N.T @ full @ N
    return (product + product.T) / 2


def _stack(
    flow: cp.Expression, drive: cp.Expression, seen: cp.Expression, through: Array, g: cp.Expression | float
) -> cp.Expression:
    """[flow, drive, seen'; drive', -g I, through'; seen, through, -g I]."""
    nz, nw = through.shape
    return cp.bmat([[flow, drive, seen.T], [drive.T, -g * np.eye(nw), through.T], [seen, through, -g * np.eye(nz)]])


def _recentre(plant: GeneralisedPlant, factor: Array, gamma: float) -> GeneralisedPlant:
    """Return the plant in the states `factor` x, in time such that ||A|| = 1, with w and z such that gamma = 1.

    Columns of B2 and rows of C2 have unit length; gains are not kept track of.
    """
    p = _change_states(plant, np.linalg.inv(factor))
    rate = np.linalg.norm(p.A, 2)
    state, size = np.sqrt(rate), np.sqrt(gamma)
    controls, measured = _column_lengths(p.B2) / state, _column_lengths(p.C2.T)[:, None] / state
    B1, B2 = p.B1 / (state * size), p.B2 / state / controls
    C1, C2 = p.C1 / (state * size), p.C2 / state / measured
    D11, D12, D21 = p.D11 / gamma, p.D12 / size / controls, p.D21 / size / measured
    return GeneralisedPlant(p.A / rate, B1, B2, C1, C2, D11, D12, D21)


def _change_states(plant: GeneralisedPlant, T: NDArray[np.floating]) -> GeneralisedPlant:
    """Return the plant in states x~ with x = T x~."""
    inverse = np.linalg.inv(T)
    A, B1, B2 = inverse @ plant.A @ T, inverse @ plant.B1, inverse @ plant.B2
    C1, C2 = plant.C1 @ T, plant.C2 @ T
    return GeneralisedPlant(A, B1, B2, C1, C2, plant.D11, plant.D12, plant.D21, plant.structure)


def _transpose(plant: GeneralisedPlant) -> GeneralisedPlant:
    p = plant
    return GeneralisedPlant(p.A.T, p.C1.T, p.C2.T, p.B1.T, p.B2.T, p.D11.T, p.D21.T, p.D12.T, p.free.T)


def _column_lengths(columns: Array) -> Array:
    lengths: Array = np.linalg.norm(columns, axis=0)
    return np.where(lengths > 0, lengths, 1.0)


def _symmetric_root(matrix: Array) -> Array:
    """Symmetric square root, kept invertible."""
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 1e-9 * values[-1])) @ vectors.T)


def _solve(objective: cp.Expression, constraints: list[cp.Constraint], deadline: float) -> bool:
    left = deadline - time.monotonic()
    if left <= 0:
        return False
    problem = cp.Problem(cp.Minimize(objective), constraints)
    with warnings.catch_warnings():
        # Starts and bounds may be inaccurate: starts are descended from, bounds are solved again until they settle.
        warnings.filterwarnings("ignore", message="Solution may be inaccurate")
        try:
            problem.solve(solver=cp.CLARABEL, time_limit=left, chordal_decomposition_enable=False)
        except cp.SolverError:
            return False
    return problem.status in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE)
