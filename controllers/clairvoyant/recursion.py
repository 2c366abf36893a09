"""The Lagrangian of the held force, minimised by Riccati recursion; compiled.

    L = J + sum over k of  -(alpha + beta) (F w - c w^2) + (alpha - beta) f w + nu ((F - b w)^2 - a^2)

alpha, beta and nu are never negative, and for every force the damper can deliver the sum is not above zero: L <= J.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.jit import jit
from seatsim.schema.arrays import Array

ForceModes = NDArray[np.int64]

FREE, LOWER, UPPER, STUCK = 0, 1, 2, 3
"""What sets the force of an interval: nothing, the least or the largest force (negative: at w < 0), or w = 0."""


class ForceBand(NamedTuple):
    """Least force `f + c |w|` and largest force `a + b |w|` in N of a damper at the speed |w| in m/s."""

    c: float
    f: float
    b: float
    a: float


class StageMatrices(NamedTuple):
    """Transition `AB` (n, n+1), criterion `Q` (n+1, n+1) and `q` (N, n+1), damper velocity `V` (n+1), `w0` (N)."""

    AB: Array
    Q: Array
    q: Array
    V: Array
    w0: Array


def minimise_backwards(
    p: StageMatrices,
    band: ForceBand,
    multipliers: Array,
    modes: ForceModes,
    proximity: float,
    force: Array,
    gain: Array,
    pivot: Array,
) -> float:
    """Fill `gain` (N, n+1) of the minimiser F = gain . (s, 1) and `pivot` (N,), backwards; return the minimum.

    `multipliers` (3, N) are alpha, beta, nu. The cost-to-go follows F = gain . (s, 1) where an interval is FREE, and
    the damper's line or w = 0 elsewhere. `proximity` adds proximity (F - force)^2. Minus infinity: L has no minimum.
    """
    n, steps = p.AB.shape[0], len(p.w0)
    P, r, K = np.zeros((n, n)), np.zeros(n), np.zeros(n + 1)
    T, M, m = np.zeros((n, n + 1)), np.zeros((n + 1, n + 1)), np.zeros(n + 1)
    total = 0.0
    for k in range(steps - 1, -1, -1):
        _add_stage(p, P, r, k, T, M, m)
        total += _add_constraints(p, band, multipliers, k, M, m)
        M[n, n] += proximity
        m[n] -= proximity * force[k]
        if not M[n, n] > 0.0:
            return -math.inf
        pivot[k] = M[n, n]
        for i in range(n):
            K[i] = -M[i, n] / M[n, n]
        K[n] = -m[n] / M[n, n]
        gain[k] = K
        total -= float(m[n] * m[n] / M[n, n])
        if modes[k] != FREE:
            _constrain_force(p, band, modes[k], k, K)
        for i in range(n):
            for j in range(n):
                P[i, j] = M[i, j] + M[i, n] * K[j] + K[i] * (M[n, j] + M[n, n] * K[j])
            r[i] = m[i] + M[i, n] * K[n] + K[i] * (m[n] + M[n, n] * K[n])
    return total


@jit
def _add_stage(p: StageMatrices, P: Array, r: Array, k: int, T: Array, M: Array, m: Array) -> None:
    """Fill M and m with the criterion of interval k and the cost-to-go s' P s + 2 r' s behind it."""
    AB = p.AB
    n = AB.shape[0]
    T[:] = 0.0
    for i in range(n):
        for h in range(n):
            x = P[i, h]
            for j in range(n + 1):
                T[i, j] += x * AB[h, j]
    for i in range(n + 1):
        for j in range(n + 1):
            M[i, j] = p.Q[i, j]
        m[i] = p.q[k, i]
    for h in range(n):
        for i in range(n + 1):
            x = AB[h, i]
            for j in range(n + 1):
                M[i, j] += x * T[h, j]
            m[i] += x * r[h]


@jit
def _add_constraints(p: StageMatrices, band: ForceBand, multipliers: Array, k: int, M: Array, m: Array) -> float:
    """Add the terms of the multipliers to M and m; return their constant."""
    c, f, b, a = band
    n, V, o = p.AB.shape[0], p.V, p.w0[k]
    both, odd, nu = multipliers[0, k] + multipliers[1, k], multipliers[0, k] - multipliers[1, k], multipliers[2, k]
    linear = both * c * o + 0.5 * f * odd
    for i in range(n + 1):
        d = (1.0 if i == n else 0.0) - b * V[i]
        for j in range(n + 1):
            M[i, j] += both * c * V[i] * V[j] + nu * d * ((1.0 if j == n else 0.0) - b * V[j])
        m[i] += linear * V[i] - nu * b * o * d
        M[i, n] -= 0.5 * both * V[i]
        M[n, i] -= 0.5 * both * V[i]
    m[n] -= 0.5 * both * o
    constant: float = both * c * o * o + f * odd * o + nu * (b * b * o * o - a * a)
    return constant


@jit
def _constrain_force(p: StageMatrices, band: ForceBand, mode: int, k: int, K: Array) -> None:
    """Set K to the force on the damper's line at the sign of `mode`, or to that which holds w at 0."""
    n, V = p.AB.shape[0], p.V
    sign = 1.0 if mode > 0 else -1.0
    slope, offset = (band.c, band.f) if abs(mode) == LOWER else (band.b, band.a)
    scale = slope / (1.0 - V[n] * slope) if mode != STUCK else -1.0 / V[n]
    for i in range(n):
        K[i] = scale * V[i]
    K[n] = scale * p.w0[k] + (sign * offset / (1.0 - V[n] * slope) if mode != STUCK else 0.0)


def differentiate(p: StageMatrices, band: ForceBand, gain: Array, pivot: Array, barrier: float, out: Array) -> None:
    """Fill `out` (3, N) with the derivatives of min L + barrier sum log pivot by alpha, beta and nu.

    Those of the minimum are the constraints at the minimiser. Those of the sum, the log of the determinant of L's
    Hessian H, are the constraints' quadratic parts averaged over fluctuations of the force with covariance H^-1:
    the minimiser's law with white noise of variance 1 / pivot.
    """
    c, f, b, a = band
    n, steps, V = p.AB.shape[0], len(p.w0), p.V
    s, y = np.zeros(n), np.zeros(n + 1)
    S, R, closed = np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n))
    for k in range(steps):
        K, noise = gain[k], barrier / pivot[k]
        u, o = K[n], p.w0[k]
        for i in range(n):
            u += K[i] * s[i]
            o += V[i] * s[i]
        o += V[n] * u
        uu, uo, oo = u * u + noise, u * o + V[n] * noise, o * o + V[n] * V[n] * noise
        for i in range(n):
            along = V[i] + V[n] * K[i]
            x, z = 0.0, 0.0
            for j in range(n):
                x += S[i, j] * K[j]
                z += S[i, j] * (V[j] + V[n] * K[j])
            uu += K[i] * x
            uo += along * x
            oo += along * z
        power = c * oo - uo
        out[0, k], out[1, k] = power + f * o, power - f * o
        out[2, k] = uu - 2.0 * b * uo + b * b * oo - a * a
        for i in range(n):
            y[i] = s[i]
        y[n] = u
        for i in range(n):
            s[i] = 0.0
            for j in range(n + 1):
                s[i] += p.AB[i, j] * y[j]
            for j in range(n):
                closed[i, j] = p.AB[i, j] + p.AB[i, n] * K[j]
        _propagate_covariance(closed, noise, p.AB, S, R)


@jit
def _propagate_covariance(closed: Array, noise: float, AB: Array, S: Array, R: Array) -> None:
    """Carry the covariance S of the fluctuating state over one interval: closed S closed' + noise B B'."""
    n = AB.shape[0]
    R[:] = 0.0
    for i in range(n):
        for h in range(n):
            x = closed[i, h]
            for j in range(n):
                R[i, j] += x * S[h, j]
    for i in range(n):
        for j in range(n):
            x = noise * AB[i, n] * AB[j, n]
            for h in range(n):
                x += R[i, h] * closed[j, h]
            S[i, j] = x


def simulate_delivered(
    p: StageMatrices, band: ForceBand, gain: Array, force: Array, w: Array, states: Array, modes: ForceModes
) -> None:
    """Run the seat forward under what the damper delivers of the force `gain . (s, 1)`, and fill the rest.

    Delivered is the closest of the forces on either side of w = 0 between the damper's lines, or the force that holds
    w at 0 where the largest one can.
    """
    n, steps, V = p.AB.shape[0], len(p.w0), p.V
    y = np.zeros(n + 1)
    for k in range(steps):
        want, free = float(gain[k, n]), float(p.w0[k])
        for i in range(n):
            states[k, i] = y[i]
            want += gain[k, i] * y[i]
            free += V[i] * y[i]
        force[k], modes[k] = _find_closest_force(band, want, free, -float(V[n]))
        w[k] = free + V[n] * force[k] if modes[k] != STUCK else 0.0
        y[n] = force[k]
        s = p.AB @ y
        y[:n] = s


@jit
def _find_closest_force(band: ForceBand, want: float, free: float, give: float) -> tuple[float, int]:
    """Return the deliverable force closest to `want`, where w = free - give F, and what sets it."""
    c, f, b, a = band
    best, mode, distance = free / give, STUCK, math.inf
    if abs(best) <= a:
        distance = abs(best - want)
    for sign in (1, -1):
        low = (f + sign * c * free) / (1.0 + give * c)
        high = (a + sign * b * free) / (1.0 + give * b)
        size = min(max(sign * want, low), high)
        if sign * free - give * size > 0.0 and abs(sign * size - want) < distance:
            best, distance = sign * size, abs(sign * size - want)
            mode = sign * (LOWER if size == low else UPPER if size == high else FREE)
    return best, mode
