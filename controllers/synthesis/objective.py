"""What the search minimises, with gradients: the spectral abscissa, then the H-infinity norm.

For a simple eigenvalue s with left and right eigenvectors l, r:    ds = l* B2 dK C2 r / l* r.
For a simple singular value of T(j omega) with vectors u, v:        dsigma = Re(p* dK q),
    p = (D12 + C Phi B2)* u,   q = (D21 + C2 Phi B) v,   Phi = (j omega - A)^-1   (A, B, C of the closed loop).
At the peak frequency the norm has this gradient, since moving the peak changes it to second order only.
Source: Apkarian & Noll 2006, IEEE Trans. Autom. Control 51:71; Burke, Henrion, Lewis & Overton 2006 (HIFOO).
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from controllers.synthesis.norm import hinf_norm, response
from controllers.synthesis.plant import Array, GeneralisedPlant, Loop

# In scaled time: loops this close to the edge of stability count as unstable.
STABILITY_MARGIN = 1e-7
# At the limit itself the angle has no slope, and a search could not leave.
_INSIDE = 0.999


class Objective:
    """Abscissa and norm as functions of the free gains, a vector of length `size`, in scaled coordinates.

    `limits` (nu, ny) bounds the magnitude of every gain. The search runs over angles theta with gain =
    limit sin(theta / limit): nearly the identity for small gains, and a limit is an ordinary stationary point.
    """

    def __init__(self, plant: GeneralisedPlant, limits: Array) -> None:
        self.plant = plant
        self.free = plant.free
        self.limits: Array = limits[self.free]
        self.size = len(self.limits)

    def gain(self, entries: Array) -> Array:
        """Return the gain matrix with these free entries."""
        K = np.zeros(self.free.shape)
        K[self.free] = entries
        return K

    def loop(self, entries: Array) -> Loop:
        """Return the closed loop with these free entries."""
        return self.plant.close(self.gain(entries))

    def entries(self, theta: Array) -> Array:
        """Return the free entries of the gain at angles theta."""
        values: Array = self.limits * np.sin(theta / self.limits)
        return values

    def angles(self, entries: Array) -> Array:
        """Return the angles of free entries; beyond the limits, of the nearest entries within."""
        values: Array = self.limits * np.arcsin(np.clip(entries / self.limits, -_INSIDE, _INSIDE))
        return values

    def abscissa(self, theta: Array, ceiling: float = np.inf) -> tuple[float, Array]:
        """Return the spectral abscissa and its gradient by theta."""
        loop = self.loop(self.entries(theta))
        values, left, right = cast(Any, scipy.linalg.eig(loop.A, left=True, right=True))
        place = int(values.real.argmax())
        if values.real[place] > ceiling:
            return float(values.real[place]), np.zeros(self.size)
        row, column = left[:, place].conj() @ self.plant.B2, self.plant.C2 @ right[:, place]
        overlap = left[:, place].conj() @ right[:, place]
        # A defective eigenvalue has an infinite slope; a large finite one leads the search away just as well.
        if abs(overlap) < 1e-12:
            overlap = 1e-12
        slope = np.real(np.outer(row, column) / overlap)
        return float(values.real[place]), self._by_theta(slope, theta)

    def log_norm(self, theta: Array, ceiling: float = np.inf) -> tuple[float, Array]:
        """Return the logarithm of the H-infinity norm and its gradient by theta; infinity where not stable.

        Above `ceiling` the value may be too small, but stays above, and there is no gradient.
        """
        loop = self.loop(self.entries(theta))
        if loop.abscissa >= -STABILITY_MARGIN:
            return np.inf, np.zeros(self.size)
        peak = hinf_norm(loop, tolerance=1e-9, enough=np.exp(ceiling))
        if peak.value < 1e-300:
            return -np.inf, np.zeros(self.size)
        if np.log(peak.value) > ceiling:
            return float(np.log(peak.value)), np.zeros(self.size)
        values, slopes = self.singular_values(loop, peak.frequency, 1)
        return float(np.log(peak.value)), self._by_theta(slopes[0, 0] / values[0, 0], theta)

    def singular_values(self, loop: Loop, frequencies: ArrayLike, count: int) -> tuple[Array, Array]:
        """Return the `count` largest singular values of T, (m, count), and their gradients by K, (m, count, nu, ny)."""
        plant = self.plant
        U, values, Vh = np.linalg.svd(response(loop, frequencies), full_matrices=False)
        from_control = response(Loop(loop.A, plant.B2, loop.C, plant.D12), frequencies)
        to_measured = response(Loop(loop.A, loop.B, plant.C2, plant.D21), frequencies)
        p = np.einsum("mzk,mzu->mku", U[:, :, :count].conj(), from_control)
        q = np.einsum("myw,mkw->mky", to_measured, Vh[:, :count].conj())
        return values[:, :count], np.real(p[..., :, None] * q[..., None, :])

    def _by_theta(self, slope: Array, theta: Array) -> Array:
        answer: Array = slope[self.free] * np.cos(theta / self.limits)
        return answer
