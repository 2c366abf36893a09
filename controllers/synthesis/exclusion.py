"""Why no gain in a box is good enough: inequalities that hold in the whole box where they hold at its corners.

A gain is good enough where all loops are stable with H-infinity norms below a `level`. For a stable loop the norm
bounds the transfer matrix in the whole right half-plane (maximum modulus). Hence a gain is not good enough where one of
these functions of it, each concave in every entry of K by itself, is at least zero:

*at a point s*, Re s >= 0: with P(s) = [[P11, P12], [P21, P22]] from (w, u) to (z, y), L = I - K P22, d = det L and
    N = d P11 + P12 adj(L) K P21, so that the closed loop is T(s) = N / d, and any vectors p, q,
    `g(K) = Re(p* N(K) q) - level |d(K)| |p| |q|  <=  (||T(s)|| - level) |d| |p| |q|`;
    N and d are affine in each entry of K.
*a coefficient* of the characteristic polynomial of A + B2 K C2, which is affine in each entry: `g(K) = -c(K)`.

Where a sum of such functions with weights >= 0 is at least zero, one of them is. A sum is smallest at a corner of a
box. The weights are those of a matrix game, found by a linear program: near the best gain, where several peaks are
equally high, their slopes cancel in the sum.

A third reason holds without a level: `F(K) = A + B2 K C2 - shift I` is affine in K. Where a symmetric X that is not
positive semidefinite has F'X + X F < 0 at all corners, every loop of the box has a pole right of the shift, by the
inertia theorem (Ostrowski and Schneider 1962, J. Math. Anal. Appl. 4:72).
"""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.optimize
from numpy.typing import NDArray

from controllers.synthesis.norm import hinf_norm
from controllers.synthesis.plant import GeneralisedPlant
from seatsim.schema.arrays import Array

Complex = NDArray[np.complex128]
# How many points of the half-plane every box is looked at, by their angle from the real axis in degrees.
_POINTS = {90.0: 60, 60.0: 20, 0.0: 20}
_ROUNDING = 1e-10
# Vectors and weights are kept with so many binary digits, points with more, since resonances may be sharp: the
# inequalities hold for any, and fractions stay short.
_DIGITS = 14
_POINT_DIGITS = 40


class AtPoint(NamedTuple):
    """The inequality at a point s in rad/s (inf allowed) with vectors p (nz,) and q (nw,), for a plant by number."""

    plant: int
    s: complex
    p: Complex
    q: Complex


class _OfCoefficient(NamedTuple):
    """The inequality of the coefficient of s^power, for a plant by number."""

    plant: int
    power: int


_Inequality = AtPoint | _OfCoefficient


class WeightedSum(NamedTuple):
    """Inequalities of which a sum with weights > 0 holds in a box."""

    weights: tuple[float, ...]
    inequalities: tuple[_Inequality, ...]


class Unstable(NamedTuple):
    """A box in which every loop of a plant has a pole right of `shift` in 1/s, with the matrix X (n, n)."""

    plant: int
    shift: float
    X: Array


class Inequalities(NamedTuple):
    """Inequalities by row: their values at the corners of a box over the size of their terms (rows, corners); sizes."""

    values: Array
    sizes: Array
    rows: list[_Inequality]


class BoxView:
    """What one plant says of boxes of gains for a `level` of the norm."""

    def __init__(self, number: int, plant: GeneralisedPlant, level: float) -> None:
        self.number, self.plant, self.level = number, plant, level
        self._corners = np.array(list(itertools.product((0.0, 1.0), repeat=int(plant.free.sum()))))
        poles = np.abs(np.linalg.eigvals(plant.A))
        scale = poles[poles > 0] if np.any(poles > 0) else np.ones(1)
        ends = scale.min() / 10, scale.max() * 10
        grid = [np.geomspace(*ends, n) * np.exp(1j * np.radians(angle)) for angle, n in _POINTS.items()]
        self._points, self._responses = _respond(plant, np.concatenate([[0.0, np.inf], *grid]))

    def gain(self, values: Array) -> Array:
        """Return the gains (boxes, nu, ny) of values of the free entries (boxes, free)."""
        K = np.zeros((len(values), *self.plant.free.shape))
        K[:, self.plant.free] = values
        return K

    def _middle_and_corners(self, low: Array, high: Array) -> Array:
        return self.gain(np.vstack([(low + high) / 2, low + self._corners * (high - low)]))

    def norm_at(self, values: Array) -> tuple[float, Complex]:
        """Return the norm of a gain, infinite where it is unstable, and the points that matter around it."""
        loop = self.plant.close(self.gain(values[None])[0])
        poles = loop.poles
        if poles[0].real >= 0:
            return np.inf, np.where(poles.real > 0, poles, 1j * poles.imag)[poles.imag >= 0]
        peak = hinf_norm(loop, enough=self.level)
        nearest = poles[np.argsort(-poles.real)[:2]]
        frequencies = np.append(np.abs(nearest.imag), peak.frequency)
        return peak.value, 1j * frequencies[np.isfinite(frequencies)]  # infinity is a common point

    def list_inequalities(self, low: Array, high: Array, points: Complex) -> Inequalities:
        """Return the inequalities of a box at the common points and at its own ones."""
        K = self._middle_and_corners(low, high)
        coefficients, terms = self._coefficients(K[1:])
        of_coefficients = [_OfCoefficient(self.number, power) for power in range(self.plant.order)]
        if np.isinf(self.level):  # only instability counts, which no transfer matrix shows
            sizes = terms.max(axis=1)
            return Inequalities((-coefficients - _ROUNDING * terms) / sizes[:, None], sizes, [*of_coefficients])
        own, responses = _respond(self.plant, points)
        s = np.concatenate([self._points, own])
        N, d = _numerators(K, *(np.concatenate(both) for both in zip(self._responses, responses, strict=True)))
        left, _, right = np.linalg.svd(N[:, 0])
        p, q = _shorten_complex(left[:, :, 0]), _shorten_complex(right[:, 0].conj())
        along = np.einsum("fi,fvij,fj->fv", p.conj(), N[:, 1:], q).real
        across = (np.linalg.norm(p, axis=1) * np.linalg.norm(q, axis=1))[:, None]
        bound = self.level * np.abs(d[:, 1:]) * across
        size = bound + np.linalg.norm(N[:, 1:], axis=(2, 3)) * across
        values = np.vstack([along - bound - _ROUNDING * size, -coefficients - _ROUNDING * terms])
        sizes = np.concatenate([size.max(axis=1), terms.max(axis=1)])
        rows: list[_Inequality] = [AtPoint(self.number, *row) for row in zip(s.tolist(), p, q, strict=True)]
        return Inequalities(values / sizes[:, None], sizes, [*rows, *of_coefficients])

    def _coefficients(self, K: Array) -> tuple[Array, Array]:
        """Return the coefficients of s^0 to s^(n-1) by corner, shape (n, corners), and the size of their terms."""
        poles = np.linalg.eigvals(self.plant.A + self.plant.B2 @ K @ self.plant.C2)
        found = np.array([np.poly(row).real for row in poles])
        sizes = np.array([np.poly(-np.abs(row)) for row in poles])
        return found[:, :0:-1].T, sizes[:, :0:-1].T

    def prove_unstable(self, low: Array, high: Array) -> Unstable | None:
        """Return the proof that all loops of a box are unstable, if that in its middle gives one."""
        K = self._middle_and_corners(low, high)
        A = self.plant.A + self.plant.B2 @ K @ self.plant.C2
        for shift in _gaps(np.linalg.eigvals(A[0]).real):
            F = A - shift * np.eye(self.plant.order)
            X = _lyapunov(F[0])
            if X is None:
                continue
            values = np.linalg.eigvalsh(np.swapaxes(F[1:], 1, 2) @ X + X @ F[1:])
            if np.all(values[:, -1] < -_ROUNDING * np.abs(values).max(axis=1)) and np.linalg.eigvalsh(X)[0] < 0:
                return Unstable(self.number, shift, X)
        return None


def weigh(inequalities: Inequalities) -> tuple[WeightedSum, Array]:
    """Return the sum of inequalities whose smallest value at the corners is largest, and its values at the corners.

    Of a matrix game with the corners as the opponent's choices: max t with `weights @ values >= t`, weights of sum 1.
    """
    values, sizes, rows = inequalities
    alone = values.min(axis=1)
    weights = np.zeros(len(rows))
    weights[alone.argmax()] = 1.0
    if alone.max() < 0:
        count, corners = values.shape
        solved = scipy.optimize.linprog(
            np.append(np.zeros(count), -1.0), bounds=[(0, None)] * count + [(None, None)],
            A_ub=np.hstack([-values.T, np.ones((corners, 1))]), b_ub=np.zeros(corners),
            A_eq=np.append(np.ones(count), 0.0)[None], b_eq=[1.0],
        )  # fmt: skip
        weights = weights if solved.x is None else solved.x[:-1]
    used = np.flatnonzero(weights > 0)
    stated = _shorten(weights[used] / sizes[used])
    return WeightedSum(tuple(stated.tolist()), tuple(rows[i] for i in used)), (stated * sizes[used]) @ values[used]


def _gaps(parts: Array) -> Iterator[float]:
    """Yield values between the real parts of poles and below the largest, widest gap first; they are not negative."""
    edges = np.unique(np.concatenate([[0.0], parts[parts > 0]]))
    widths = np.diff(edges)
    for i in np.argsort(-widths)[:3]:
        yield float(_shorten(np.array([edges[i] + widths[i] / 2]))[0])


def _lyapunov(F: Array) -> Array | None:
    """Return X with F'X + XF = -W for a W > 0 that suits the states' units; None where there is none."""
    _, (scale, _) = scipy.linalg.matrix_balance(F, permute=False, separate=True)
    try:
        with warnings.catch_warnings():  # of poles that mirror each other: what comes out is checked at the corners
            warnings.simplefilter("ignore", RuntimeWarning)
            X = scipy.linalg.solve_continuous_lyapunov((F * scale / scale[:, None]).T, -np.eye(len(F)))
    except (np.linalg.LinAlgError, ValueError):
        return None
    X = (X + X.T) / 2 / np.outer(scale, scale)
    return X if np.isfinite(X).all() else None


def _respond(plant: GeneralisedPlant, points: Complex) -> tuple[Complex, tuple[Complex, ...]]:
    """Return the points in rad/s, in few digits, at which the plant has no pole, and P11, P12, P21, P22 there."""
    B, C = np.hstack([plant.B1, plant.B2]), np.vstack([plant.C1, plant.C2])
    D = np.block([[plant.D11, plant.D12], [plant.D21, np.zeros((plant.measured_count, plant.control_count))]])
    kept, found = [], []
    for s in _shorten_complex(points, _POINT_DIGITS):
        try:
            states = np.linalg.solve(s * np.eye(plant.order) - plant.A, B) if np.isfinite(s) else np.zeros(B.shape)
        except np.linalg.LinAlgError:
            continue
        kept.append(s)
        found.append(D + C @ states)
    P: Complex = np.array(found, dtype=complex).reshape(-1, *D.shape)
    z, w = len(plant.C1), plant.B1.shape[1]
    return np.array(kept, dtype=complex), (P[:, :z, :w], P[:, :z, w:], P[:, z:, :w], P[:, z:, w:])


def _numerators(K: Array, P11: Complex, P12: Complex, P21: Complex, P22: Complex) -> tuple[Complex, Complex]:
    """Return N, shape (points, gains, nz, nw), and d, shape (points, gains)."""
    L = np.eye(K.shape[1]) - K[None] @ P22[:, None]
    d = np.linalg.det(L)
    return d[..., None, None] * P11[:, None] + P12[:, None] @ adjugate(L) @ K[None] @ P21[:, None], d


def adjugate(L: Complex) -> Complex:
    """Return adj(L) of square matrices, `L adj(L) = det(L) I`, also where L is singular; shape (..., n, n)."""
    if L.shape[-1] == 1:
        return np.ones_like(L)
    U, s, V = np.linalg.svd(L)
    others = np.stack([np.prod(np.delete(s, i, axis=-1), axis=-1) for i in range(s.shape[-1])], axis=-1)
    phase = np.linalg.det(U) * np.linalg.det(V)
    right = np.swapaxes(V.conj(), -1, -2) * (phase[..., None] * others)[..., None, :]
    answer: Complex = right @ np.swapaxes(U.conj(), -1, -2)
    return answer


def _shorten(values: Array, digits: int = _DIGITS) -> Array:
    """Return numbers with few binary digits."""
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.round(mantissa * 2.0**digits) / 2.0**digits, exponent)


def _shorten_complex(values: NDArray[np.number], digits: int = _DIGITS) -> Complex:
    """Return complex numbers whose parts have few binary digits."""
    return _shorten(values.real, digits) + 1j * _shorten(values.imag, digits)
