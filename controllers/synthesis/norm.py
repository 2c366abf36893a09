"""The H-infinity norm of a loop, twice: from a Hamiltonian matrix, and from a dense frequency grid.

    ||T|| = sup over omega of sigma_max(D + C (j omega - A)^-1 B)

Sources: Boyd & Balakrishnan 1990, Syst. Control Lett. 15:1 and Bruinsma & Steinbuch 1990, Syst. Control Lett. 14:287.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from controllers.synthesis.plant import LinearSystem
from seatsim.schema.arrays import Array

# Bisection converges quadratically: so many rounds are a guard against rounding that keeps it from settling.
_ITERATIONS = 60
# From three decades below the slowest pole to three above the fastest; peaks are then closed in upon by 4^_ZOOMS.
_GRID_POINTS = 600
_ZOOMS = 12
_ROUNDING = 1e-9
# With the norm of D this far below gamma, the Hamiltonian matrix is as accurate as the pencil, and cheaper.
_WELL_BELOW = 0.7


class Peak(NamedTuple):
    """A largest singular value and the frequency in rad/s (0 to infinity) where it stands."""

    value: float
    frequency: float


def frequency_response(loop: LinearSystem, frequencies: ArrayLike) -> NDArray[np.complex128]:
    """Return T(j omega), shape (frequencies, nz, nw), at frequencies in rad/s; infinity is allowed."""
    omega = np.atleast_1d(np.asarray(frequencies, dtype=float))
    finite = np.isfinite(omega)
    resolvent = np.multiply.outer(1j * np.where(finite, omega, 1.0), np.eye(len(loop.A))) - loop.A
    dynamic = loop.C @ np.linalg.solve(resolvent, loop.B[None])
    return np.asarray(dynamic * finite[:, None, None] + loop.D)


def largest_singular_values(loop: LinearSystem, frequencies: ArrayLike) -> Array:
    """Return sigma_max(T(j omega)) at frequencies in rad/s."""
    T = frequency_response(loop, frequencies)
    if min(T.shape[1:]) == 1:
        return np.asarray(np.linalg.norm(T, axis=(1, 2)), dtype=float)
    return np.linalg.svd(T, compute_uv=False)[:, 0].astype(float)


def balance(loop: LinearSystem) -> tuple[LinearSystem, Array]:
    """Return the loop in balanced states x~, and the factors of x = diag(factors) x~."""
    states: Array = scipy.linalg.lapack.dgebal(loop.A, scale=1, permute=0)[3]
    return LinearSystem(loop.A * states / states[:, None], loop.B / states[:, None], loop.C * states, loop.D), states


def hinf_norm(loop: LinearSystem, guesses: ArrayLike = ()) -> Peak:
    """Return the H-infinity norm of one loop, as `find_highest_norm` does."""
    return find_highest_norm([loop], guesses)[1]


def find_highest_norm(
    loops: Sequence[LinearSystem],
    guesses: ArrayLike = (),
    tolerance: float = 1e-10,
    enough: float = np.inf,
    margin: float = 0.0,
) -> tuple[int, Peak]:
    """Return which loop has the highest H-infinity norm, and its peak, by bisection on Hamiltonian matrices.

    The value is attained at the frequency returned; no frequency of any loop exceeds it by more than `tolerance`
    (relative) or the rounding of the Hamiltonian's eigenvalues. `guesses` are frequencies to look at first. The search
    for a higher peak ends early above `enough`. A loop with a pole right of `-margin` has an infinite norm.
    """
    balanced, peaks = [balance(loop)[0] for loop in loops], []
    for place, loop in enumerate(balanced):
        poles = np.linalg.eigvals(loop.A)
        if poles.real.max() >= -margin:
            return place, Peak(np.inf, float(abs(poles[poles.real.argmax()].imag)))
        start = np.concatenate([[0.0, np.inf], np.abs(poles), np.abs(poles.imag), np.ravel(guesses)])
        peaks.append(_find_highest_peak(loop, np.unique(start)))
    # The highest one is followed first: of the others it is then asked only whether they reach as high.
    order = sorted(range(len(loops)), key=lambda place: -peaks[place].value)
    worst, best = order[0], peaks[order[0]]
    for place in order:
        for _ in range(_ITERATIONS if best.value > 0 else 0):
            if best.value > enough:
                return worst, best
            crossings = _find_crossings(balanced[place], best.value * (1 + tolerance))
            if not len(crossings):
                break
            middles = (crossings[1:] + crossings[:-1]) / 2
            found = _find_highest_peak(balanced[place], np.concatenate([crossings, middles]))
            if found.value <= best.value * (1 + tolerance):
                break
            worst, best = place, found
    return worst, best


def _find_highest_peak(loop: LinearSystem, frequencies: Array) -> Peak:
    """Highest peak at some frequencies; only where the Frobenius norm is larger can a singular value be so."""
    T = frequency_response(loop, frequencies)
    sizes = np.linalg.norm(T, axis=(1, 2))
    place = int(sizes.argmax())
    value = float(np.linalg.svd(T[place], compute_uv=False)[0])
    rivals = np.flatnonzero(sizes > value)
    if len(rivals) > 1:
        values = np.linalg.svd(T[rivals], compute_uv=False)[:, 0]
        place, value = int(rivals[values.argmax()]), float(values.max())
    return Peak(value, float(frequencies[place]))


def _find_crossings(loop: LinearSystem, gamma: float) -> Array:
    """Frequencies where a singular value may equal gamma: Hamiltonian eigenvalues on or near the imaginary axis."""
    scaled = LinearSystem(loop.A, loop.B / np.sqrt(gamma), loop.C / np.sqrt(gamma), loop.D / gamma)
    values = _hamiltonian_eigenvalues(scaled) if np.linalg.norm(scaled.D) < _WELL_BELOW else _pencil_eigenvalues(scaled)
    # Generous: a frequency too many costs one evaluation, a missed one would under-report the norm.
    return np.unique(np.abs(values.imag[np.abs(values.real) <= 1e-2 * np.abs(values)]))


def _hamiltonian_eigenvalues(loop: LinearSystem) -> NDArray[np.complex128]:
    """Eigenvalues of the Hamiltonian matrix for gamma = 1."""
    A, B, C, D = loop
    n, nw = B.shape
    inverse = np.linalg.inv(np.eye(nw) - D.T @ D)
    shared, flow = B @ inverse, np.empty((2 * n, 2 * n))
    flow[:n, :n] = A + shared @ D.T @ C
    flow[:n, n:], flow[n:, n:] = shared @ B.T, -flow[:n, :n].T
    flow[n:, :n] = -C.T @ (C + D @ inverse @ (D.T @ C))
    return np.linalg.eigvals(flow).astype(np.complex128)


def _pencil_eigenvalues(loop: LinearSystem) -> NDArray[np.complex128]:
    """Eigenvalues of the Hamiltonian matrix as those of a pencil in states, costates, w and z.

    No inverse of I - D'D is formed, which is nearly singular where the norm is attained at infinity. An orthogonal
    complement takes w and z out again.
    """
    A, B, C, D = loop
    n, nw, nz = len(A), B.shape[1], len(C)
    static = np.zeros((2 * n + nz + nw, nw + nz))
    static[:n, :nw], static[n : 2 * n, nw:] = B, -C.T
    static[2 * n : -nw, :nw], static[2 * n : -nw, nw:] = D, -np.eye(nz)
    static[-nw:, :nw], static[-nw:, nw:] = -np.eye(nw), D.T
    dynamic = np.zeros((2 * n + nz + nw, 2 * n))
    dynamic[:n, :n], dynamic[n : 2 * n, n:] = A, -A.T
    dynamic[2 * n : -nw, :n], dynamic[-nw:, n:] = C, B.T
    rest = np.linalg.qr(static, mode="complete")[0][:, nw + nz :].T
    alpha, beta = scipy.linalg.eigvals(rest @ dynamic, rest[:, : 2 * n], homogeneous_eigvals=True, check_finite=False)
    finite = np.abs(beta) > 1e-14 * np.abs(alpha)
    return np.asarray(alpha[finite] / beta[finite])


def grid_norm(loop: LinearSystem) -> Peak:
    """Return the H-infinity norm of a stable loop from a dense frequency grid, refined at its highest peaks.

    Shares nothing with `hinf_norm` but the frequency response. It never over-reports; a peak far narrower than the
    damping of the poles could escape it.
    """
    return max(find_local_peaks(loop, 0.5))


def find_local_peaks(loop: LinearSystem, level: float) -> list[Peak]:
    """Return the peaks of sigma_max over frequency that reach `level` times the highest, zero and infinity included."""
    omega = build_frequency_grid(loop)
    values = largest_singular_values(loop, omega)
    left, right = np.append(-np.inf, values[:-1]), np.append(values[1:], -np.inf)
    # On a plateau, rounding alone makes tops: one side at least must fall off by more.
    clear = (values >= np.maximum(left, right)) & (values > np.minimum(left, right) * (1 + _ROUNDING))
    tops = np.union1d(np.flatnonzero(clear & (values >= level * values.max())), values.argmax())
    # The grid ends with infinity, which has no neighbourhood to refine.
    inner = tops[tops < len(omega) - 2]
    refined = _refine_peaks(loop, omega[np.maximum(inner - 1, 0)], omega[inner + 1])
    return refined + [Peak(float(values[top]), float(omega[top])) for top in tops]


def build_frequency_grid(loop: LinearSystem) -> Array:
    """Return frequencies from zero to infinity: dense on a logarithmic scale, and denser about every pole."""
    poles = loop.poles
    rates = np.abs(poles[np.abs(poles) > 0])
    wide = np.geomspace(rates.min() / 1e3, rates.max() * 1e3, _GRID_POINTS)
    offsets = np.concatenate([-np.geomspace(10, 0.05, 12), [0.0], np.geomspace(0.05, 10, 12)])
    about = np.abs(poles.imag)[:, None] + np.abs(poles.real)[:, None] * offsets
    return np.unique(np.concatenate([[0.0, np.inf], wide, about[about > 0]]))


def _refine_peaks(loop: LinearSystem, low: Array, high: Array) -> list[Peak]:
    """Close in on the peak between each `low` and `high`, all at once, by a factor of four a round."""
    if not len(low):
        return []
    spread, rows = np.linspace(0, 1, 9), np.arange(len(low))
    for _ in range(_ZOOMS):
        omega = low[:, None] + (high - low)[:, None] * spread
        values = largest_singular_values(loop, omega.ravel()).reshape(omega.shape)
        best = np.clip(values.argmax(axis=1), 1, len(spread) - 2)
        low, high = omega[rows, best - 1], omega[rows, best + 1]
    return [Peak(float(v), float(w)) for v, w in zip(values[rows, best], omega[rows, best], strict=True)]
