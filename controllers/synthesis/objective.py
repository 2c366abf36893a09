"""What the search minimises, with gradients: the spectral abscissa, then the H-infinity norm.

For a simple eigenvalue s with left and right eigenvectors l, r:    ds = l* B2 dK C2 r / l* r.
For a simple singular value of T(j omega) with vectors u, v:        dsigma = Re(p* dK q),
    p = (D12 + C Phi B2)* u,   q = (D21 + C2 Phi B) v,   Phi = (j omega - A)^-1   (A, B, C of the closed loop).
At the peak frequency the norm has this gradient, since moving the peak changes it to second order only.
Source: Apkarian & Noll 2006, IEEE Trans. Autom. Control 51:71; Burke, Henrion, Lewis & Overton 2006 (HIFOO).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from controllers.synthesis.norm import find_highest_norm, frequency_response
from controllers.synthesis.plant import GeneralisedPlant, LinearSystem
from seatsim.schema.arrays import Array

# In scaled time: loops this close to the edge of stability count as unstable.
STABILITY_MARGIN = 1e-7
# At the limit itself the angle has no slope, and a search could not leave.
_INSIDE = 0.999
# The smallest natural size of an entry, as a share of the largest, in units.
_LEAST = 0.01


class NormObjective:
    """Abscissa and norm, the worst of one or several plants, by the free gains, in scaled coordinates.

    The free gains, a vector of length `size`, are no larger than `limit` (nu, ny). The search runs over angles theta
    with gain = limit sin(theta / limit): nearly the identity for small gains, and a limit is an ordinary stationary
    point. `unit` (nu, ny) is one of the user's units in scaled coordinates.
    """

    def __init__(self, plants: Sequence[GeneralisedPlant], limit: Array, unit: Array) -> None:
        self.plants = list(plants)
        self.free = plants[0].free
        self._scales = limit, unit
        self.limit, self.unit = limit[self.free], unit[self.free]
        self.size = len(self.limit)

    def on(self, plants: Sequence[GeneralisedPlant]) -> NormObjective:
        """Return the same objective on other plants."""
        return NormObjective(plants, *self._scales)

    def gain(self, entries: Array) -> Array:
        """Return the gain matrix with these free entries."""
        K = np.zeros(self.free.shape)
        K[self.free] = entries
        return K

    def sizes(self, entries: Array) -> Array:
        """Return the natural sizes of changes of some entries: their own, none far below the largest's in `unit`."""
        largest = float(np.max(np.abs(entries) / self.unit))
        return np.maximum(np.abs(entries), _LEAST * largest * self.unit) if largest > 0 else self.unit

    def loops(self, entries: Array) -> list[LinearSystem]:
        """Return the closed loop of every plant with these free entries."""
        gain = self.gain(entries)
        return [plant.close(gain) for plant in self.plants]

    def entries(self, theta: Array) -> Array:
        """Return the free entries of the gain at angles theta."""
        return np.asarray(self.limit * np.sin(theta / self.limit))

    def angles(self, entries: Array) -> Array:
        """Return the angles of free entries; beyond the limits, of the nearest entries within."""
        return np.asarray(self.limit * np.arcsin(np.clip(entries / self.limit, -_INSIDE, _INSIDE)))

    def abscissa(self, theta: Array, ceiling: float = np.inf) -> tuple[float, Array]:
        """Return the largest spectral abscissa and its gradient by theta; above `ceiling` there is no gradient."""
        loops = self.loops(self.entries(theta))
        worst = max(range(len(loops)), key=lambda i: loops[i].abscissa) if len(loops) > 1 else 0
        value, slope = _abscissa(self.plants[worst], loops[worst], ceiling)
        return value, self._by_theta(slope, theta)

    def norm(self, entries: Array) -> float:
        """Return the H-infinity norm with these free entries; infinity where not stable enough."""
        return find_highest_norm(self.loops(entries), margin=STABILITY_MARGIN)[1].value

    def log_norm(self, theta: Array, ceiling: float = np.inf) -> tuple[float, Array]:
        """Return the logarithm of the H-infinity norm and its gradient by theta; infinity where not stable.

        Above `ceiling` the value may be too small, but stays above, and there is no gradient.
        """
        nothing, enough = np.zeros(self.size), np.exp(ceiling)
        loops = self.loops(self.entries(theta))
        worst, highest = find_highest_norm(loops, tolerance=1e-9, enough=enough, margin=STABILITY_MARGIN)
        if highest.value > enough or highest.value == np.inf:
            return max(float(np.log(highest.value)), np.nextafter(ceiling, np.inf)), nothing
        if highest.value < 1e-300:
            return -np.inf, nothing
        values, slopes = differentiate_singular_values(self.plants[worst], loops[worst], highest.frequency, 1)
        return float(np.log(highest.value)), self._by_theta(slopes[0, 0] / values[0, 0], theta)

    def _by_theta(self, slope: Array, theta: Array) -> Array:
        return np.asarray(slope[self.free] * np.cos(theta / self.limit))


def differentiate_singular_values(
    plant: GeneralisedPlant, loop: LinearSystem, frequencies: ArrayLike, count: int
) -> tuple[Array, Array]:
    """Return the `count` largest singular values of T, (m, count), and their gradients by K, (m, count, nu, ny)."""
    U, values, Vh = np.linalg.svd(frequency_response(loop, frequencies), full_matrices=False)
    from_control = frequency_response(LinearSystem(loop.A, plant.B2, loop.C, plant.D12), frequencies)
    to_measured = frequency_response(LinearSystem(loop.A, loop.B, plant.C2, plant.D21), frequencies)
    p = np.einsum("mzk,mzu->mku", U[:, :, :count].conj(), from_control)
    q = np.einsum("myw,mkw->mky", to_measured, Vh[:, :count].conj())
    return values[:, :count], np.real(p[..., :, None] * q[..., None, :])


def _abscissa(plant: GeneralisedPlant, loop: LinearSystem, ceiling: float) -> tuple[float, Array]:
    """Spectral abscissa and its gradient by K."""
    # Its stubs do not tell how many arrays it returns.
    values, left, right = cast("tuple[NDArray[np.complex128], ...]", scipy.linalg.eig(loop.A, left=True, right=True))
    place = int(values.real.argmax())
    if values.real[place] > ceiling:
        return float(values.real[place]), np.zeros(plant.free.shape)
    row, column = left[:, place].conj() @ plant.B2, plant.C2 @ right[:, place]
    overlap = left[:, place].conj() @ right[:, place]
    # A defective eigenvalue has an infinite slope; a large finite one leads the search away just as well.
    kept = 1e-12 if abs(overlap) < 1e-12 else overlap
    return float(values.real[place]), np.real(np.outer(row, column) / kept)
