"""Why no gain in a box is good enough: inequalities that hold in the whole box where they hold at its corners.

A gain is good enough where all loops are stable with H-infinity norms below a `level`. For a stable loop the norm
bounds the transfer matrix in the whole right half-plane (maximum modulus). Hence a gain is not good enough where one of
these functions of it, each concave in every entry of K by itself, is at least zero:

*at a point s*, Re s >= 0: with P(s) = [[P11, P12], [P21, P22]] from (w, u) to (z, y), L = I - K P22, d = det L and
    N = d P11 + P12 adj(L) K P21, so that the closed loop is T(s) = N / d, and any vectors p, q,
    `g(K) = Re(p* N(K) q) - level |d(K)| |p| |q|  <=  (||T(s)|| - level) |d| |p| |q|`;
    N and d are affine in each entry of K. At a real s the sign of d is that of det(s I - A) for every stable loop, so
    that +-d stands in for |d|.
*a coefficient* of the characteristic polynomial of A + B2 K C2, which is affine in each entry: `g(K) = -c(K)`.

Where a sum of such functions with weights >= 0 is at least zero, one of them is. A sum is smallest at a corner of a
box. The weights are those of a matrix game against the corners: near the best gain, where several peaks are equally
high, their slopes cancel in the sum. Of all vectors p, q those are taken that are best against the corners' present
mixture, the singular vectors of its mean N; where no inequality has a positive mean there, none helps.

A second reason holds without a level. In a box, p_K(s) = det(s I - A - B2 K C2) lies in the convex hull of its values
at the corners. Where Re(p_c conj(p_0)) > 0 at all corners c on a line Re s = shift, with p_0 their mean, no pole is on
it; where one loop has a pole right of it, all have. Source: zero exclusion and the mapping theorem, in Barmish 1994,
New Tools for Robustness of Linear Systems, chapters 7 and 14.

A third holds for all gains. Where p* P12(s) = 0, control leaves p* T(s) = p* P11(s) as it is; so does it T(s) q where
P21(s) q = 0 (`controllers.synthesis.solve.compute_pointwise_bound`). Where that is as large as the level, no controller
is better.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from controllers.synthesis.norm import Peak, hinf_norm
from controllers.synthesis.plant import GeneralisedPlant
from seatsim.schema.arrays import Array

Complex = NDArray[np.complex128]
# How many points of the half-plane every box is looked at, by their angle from the real axis in degrees.
_POINTS = {90.0: 60, 60.0: 20, 0.0: 20}
_ROUNDING = 1e-10
# Beside zero, where plants may have a pole: this share of the least of the points.
_SLOWEST = 1e-4
# A root is taken for a real one where its angle is less.
_CLOSE = 1e-3
# Distance of points from the plant's poles over their size: closer, rounding would decide.
_APART = 1e-3
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
    """A box in which every loop of a plant has a pole right of `shift` in 1/s."""

    plant: int
    shift: float


class OutOfReach(NamedTuple):
    """A direction in which no controller of any order changes a plant's response, already at the level, at s in rad/s.

    `vector` is of performance outputs where `at_output`, else of disturbances; what control reaches (or measurements
    see) of it is rounding, to be taken off.
    """

    plant: int
    s: complex
    at_output: bool
    vector: Complex


class Inequalities(NamedTuple):
    """Inequalities by row: their values at the corners of a box over the size of their terms (rows, corners); sizes."""

    values: Array
    sizes: Array
    rows: Sequence[_Inequality]

    def joined(self, others: Sequence[Inequalities]) -> Inequalities:
        """Return these inequalities and others."""
        values, sizes, rows = zip(self, *others, strict=True)
        return Inequalities(np.vstack(values), np.concatenate(sizes), list(itertools.chain(*rows)))


class BoxView:
    """What one plant says of boxes of gains for a `level` of the norm."""

    def __init__(self, number: int, plant: GeneralisedPlant, level: float) -> None:
        self.number, self.plant, self.level = number, plant, level
        poles = np.abs(np.linalg.eigvals(plant.A))
        moving = poles[poles > _ROUNDING * poles.max()] if poles.any() else np.ones(1)
        ends = moving.min() / 10, moving.max() * 10
        self._slowest = float(ends[0]) * _SLOWEST
        grid = [np.geomspace(*ends, n) * np.exp(1j * np.radians(angle)) for angle, n in _POINTS.items()]
        self._points = _respond(plant, np.concatenate([[0.0, self._slowest, np.inf], *grid]))

    def gain(self, values: Array) -> Array:
        """Return the gains (boxes, nu, ny) of values of the free entries (boxes, free)."""
        K = np.zeros((len(values), *self.plant.free.shape))
        K[:, self.plant.free] = values
        return K

    def norm_at(self, values: Array) -> Peak:
        """Return the norm of a gain, infinite where it is unstable."""
        return hinf_norm(self.plant.close(self.gain(values[None])[0]))

    def look(self, corners: Array, points: Complex) -> _CornerView:
        """Return the view of the box with these corners, at the common points and some more."""
        poles = self.plant.close(self.gain(corners.mean(axis=0)[None])[0]).poles
        own = np.where(poles.real > 0, poles, 1j * poles.imag)[poles.imag >= 0]
        more = _respond(self.plant, np.append(own[np.abs(own) > self._slowest], points))
        return _CornerView(self, self.gain(corners), self._points.joined(more))

    def prove_out_of_reach(self) -> OutOfReach | None:
        """Return the proof that no controller of any order is better than the level, from Parrott's theorem."""
        P = self._points
        for at_output, path, T in ((True, P.P12, P.P11), (False, _adjoint(P.P21), _adjoint(P.P11))):
            if path.shape[1] <= path.shape[2]:
                continue
            basis, reach, _ = np.linalg.svd(path)
            basis = basis[:, :, path.shape[2] :]
            left, values, _ = np.linalg.svd(_adjoint(basis) @ T)
            # Where control acts weakly in some direction, rounding decides what it does not reach.
            heights = np.where(reach[:, -1] > _APART * reach[:, 0], values[:, 0], 0.0)
            top = int(heights.argmax())
            if heights[top] >= self.level * (1 + _ROUNDING):
                return OutOfReach(self.number, complex(P.s[top]), at_output, basis[top] @ left[top, :, 0])
        return None

    def prove_unstable(self, corners: Array) -> Unstable | None:
        """Return the proof that all loops of the box with these corners are unstable, if there is one."""
        K = self.gain(np.vstack([corners.mean(axis=0), corners]))
        poles = np.linalg.eigvals(self.plant.A + self.plant.B2 @ K @ self.plant.C2)
        for shift in _gaps(poles[0].real):
            if _excludes_zero(poles - shift):
                return Unstable(self.number, shift)
        return None


class _CornerView:
    """The functions of a plant at the corners of a box."""

    def __init__(self, view: BoxView, K: Array, points: _Points) -> None:
        self._view, self._points = view, points
        loops = view.plant.A + view.plant.B2 @ K @ view.plant.C2
        poles = np.linalg.eigvals(loops)
        coefficients, terms = _polynomials(poles), _polynomials(-np.abs(poles))
        self._coefficient_sizes = terms.max(axis=1)
        self._coefficients = (-coefficients - _ROUNDING * terms) / self._coefficient_sizes[:, None]
        if np.isfinite(view.level):
            self._N, d, self._terms = _numerators(K, points)
            # At a real s the characteristic polynomials of stable loops are positive.
            self._bound = view.level * np.where(points.signs[:, None], points.signs[:, None] * d.real, np.abs(d))
            self._sizes = (np.abs(self._bound) + np.linalg.norm(self._N, axis=(2, 3))).max(axis=1)

    def list_inequalities(self, mixture: Array) -> Inequalities:
        """Return the inequalities whose mean over the corners, weighted by `mixture`, is positive."""
        view = self._view
        chosen = np.flatnonzero(self._coefficients @ mixture > 0)
        named = [_OfCoefficient(view.number, power) for power in chosen.tolist()]
        listed = Inequalities(self._coefficients[chosen], self._coefficient_sizes[chosen], named)
        if np.isinf(view.level):  # only instability counts, which no transfer matrix shows
            return listed
        N = np.einsum("c,fcij->fij", mixture, self._N)
        bound = (self._bound + _ROUNDING * (np.abs(self._bound) + self._terms)) @ mixture
        # The Frobenius norm is no less than the largest singular value.
        near = np.flatnonzero(np.linalg.norm(N, axis=(1, 2)) > bound)
        left, top, right = np.linalg.svd(N[near], full_matrices=False)
        kept = top[:, 0] > bound[near]
        near, p, q = near[kept], _shorten_complex(left[kept, :, 0]), _shorten_complex(right[kept, 0].conj())
        along = np.einsum("fi,fcij,fj->fc", p.conj(), self._N[near], q).real
        across = (np.linalg.norm(p, axis=1) * np.linalg.norm(q, axis=1))[:, None]
        bounds, sizes = self._bound[near], self._sizes[near]
        values = along - across * (bounds + _ROUNDING * (np.abs(bounds) + self._terms[near]))
        rows = [AtPoint(view.number, *row) for row in zip(self._points.s[near].tolist(), p, q, strict=True)]
        return Inequalities(values / sizes[:, None], sizes, rows).joined([listed])


def weigh(values: Array) -> tuple[Array, Array]:
    """Return weights >= 0 of rows whose sum comes nearest to at least one in every column, and the shortfalls.

    `values` has the shape (rows, corners). As a mixture of the corners the shortfalls `r` prove that no weights do
    better: `values @ r <= 0`, zero where there is a weight. Only a row with a positive mean there can help.
    """
    rows, corners = values.shape
    weights = scipy.optimize.nnls(np.hstack([values.T, -np.eye(corners)]), np.ones(corners))[0][:rows]
    return weights, np.maximum(1.0 - weights @ values, 0.0)


def state_sum(weights: Array, inequalities: Inequalities) -> tuple[WeightedSum, Array]:
    """Return a sum of inequalities with weights of few digits, and its values at the corners."""
    values, sizes, rows = inequalities
    used = np.flatnonzero(weights > 0)
    stated = _shorten(weights[used] / sizes[used], _POINT_DIGITS)
    named = WeightedSum(tuple(stated.tolist()), tuple(rows[i] for i in used.tolist()))
    return named, (stated * sizes[used]) @ values[used]


def corners_of(low: Array, high: Array) -> Array:
    """Return the corners of a box, the last entry fastest, shape (corners, gains)."""
    shares = np.array(list(itertools.product((0.0, 1.0), repeat=len(low))))
    return np.where(shares, high, low)


def _gaps(parts: Array) -> Iterator[float]:
    """Yield values between the real parts of poles and below the largest, widest gap first; they are not negative."""
    edges = np.unique(np.append(0.0, parts[parts > 0]))
    widths = np.diff(edges)
    for i in np.argsort(-widths)[:3]:
        yield float(_shorten(np.array([edges[i] + widths[i] / 2]))[0])


def _excludes_zero(poles: NDArray[np.number]) -> bool:
    """Whether Re(p_c conj(p_0)) > 0 on the imaginary axis; the first row of `poles` is of p_0, another one of a p_c."""
    n = poles.shape[1]
    poles = poles / np.exp(np.log(np.abs(poles[0]) + np.finfo(float).tiny).mean())
    # On the axis p_c(s) p_0(-s) has this real part, a polynomial of the squared frequency whose first term is 1.
    signs = (-1.0) ** (np.arange(n) + n)
    even = signs * _polynomials(np.hstack([poles[1:], np.broadcast_to(-poles[0], poles[1:].shape)]))[::2].T
    if np.any(even[:, 0] <= _ROUNDING):
        return False
    companion = np.tile(np.eye(n, k=-1), (len(even), 1, 1))
    companion[:, :, -1] -= even
    roots = np.linalg.eigvals(companion)
    return not np.any((roots.real > 0) & (np.abs(roots.imag) <= _CLOSE * np.abs(roots)))


class _Points(NamedTuple):
    """Points of the half-plane, (points,), signs of det(s I - A), 0 where not real; P11, P12, P21, P22."""

    s: Complex
    signs: Array
    P11: Complex
    P12: Complex
    P21: Complex
    P22: Complex

    def joined(self, other: _Points) -> _Points:
        """Return these points and others."""
        return _Points(*(np.concatenate(both) for both in zip(self, other, strict=True)))


def _adjoint(matrices: Complex) -> Complex:
    """Return the conjugate transposes."""
    return np.conj(np.swapaxes(matrices, -1, -2))


def _respond(plant: GeneralisedPlant, points: Complex) -> _Points:
    """Return the points in rad/s, in few digits, with the plant's response; none is close to a pole of the plant."""
    poles = np.linalg.eigvals(plant.A)
    sizes = np.maximum(np.abs(points), _ROUNDING * np.abs(poles).max())
    near = np.abs(points[:, None] - poles).min(axis=1) <= _APART * sizes
    s = _shorten_complex(points[~near | np.isinf(points)], _POINT_DIGITS)
    A, B, C, D = plant.system
    finite = np.isfinite(s)[:, None, None]
    resolvent = np.where(finite, s[:, None, None], 1.0) * np.eye(plant.order) - A * finite
    P = np.asarray(D + C @ (np.linalg.solve(resolvent, B[None]) * finite), dtype=np.complex128)
    z, w = len(plant.C1), plant.B1.shape[1]
    signs = np.where(s.imag == 0, np.sign(np.linalg.det(resolvent).real), 0.0)
    return _Points(s, signs, P[:, :z, :w], P[:, :z, w:], P[:, z:, :w], P[:, z:, w:])


def _numerators(K: Array, points: _Points) -> tuple[Complex, Complex, Array]:
    """Return N, shape (points, gains, nz, nw), d and the size of the terms of N, both of shape (points, gains)."""
    adjugate, d = _adjugate_and_determinant(np.eye(K.shape[1]) - K[None] @ points.P22[:, None])
    direct = d[..., None, None] * points.P11[:, None]
    fed_back = points.P12[:, None] @ (adjugate @ K) @ points.P21[:, None]
    terms = np.linalg.norm(direct, axis=(2, 3)) + np.linalg.norm(fed_back, axis=(2, 3))
    return direct + fed_back, d, terms


def _adjugate_and_determinant(L: Complex) -> tuple[Complex, Complex]:
    """Return adj(L) and det(L) of square matrices (..., n, n) by the recursion of Faddeev and LeVerrier."""
    n, identity = L.shape[-1], np.eye(L.shape[-1])
    M = np.broadcast_to(identity, L.shape).astype(complex)
    for k in range(1, n):
        product = L @ M
        M = product - np.trace(product, axis1=-2, axis2=-1)[..., None, None] / k * identity
    adjugate = (-1) ** (n - 1) * M
    return adjugate, np.trace(L @ adjugate, axis1=-2, axis2=-1) / n


def _polynomials(roots: NDArray[np.number]) -> Array:
    """Return the coefficients of s^0 to s^(n-1) of monic polynomials by their roots (polynomials, n), by column."""
    rising = np.ones((1, len(roots)), dtype=roots.dtype)
    for root in roots.T:
        rising = np.vstack([-root * rising[:1], rising[:-1] - root * rising[1:], rising[-1:]])
    return np.asarray(rising[:-1].real)


def _shorten(values: Array, digits: int = _DIGITS) -> Array:
    """Return numbers with few binary digits."""
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.round(mantissa * 2.0**digits) / 2.0**digits, exponent)


def _shorten_complex(values: NDArray[np.number], digits: int = _DIGITS) -> Complex:
    """Return complex numbers whose parts have few binary digits."""
    return _shorten(values.real, digits) + 1j * _shorten(values.imag, digits)
