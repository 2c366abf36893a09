"""A bound that no controller beats, whatever its order, from the frequency response alone.

With T the closed loop of any one gain, every other controller gives T + T12 Q T21 at each frequency, so that

    gamma >= sup over omega of max(sigma_max(N'T), sigma_max(T M)),  N'T12 = 0, T21 M = 0, N, M orthonormal.

Weaker than the full-order LMI bound, but exact to rounding and cheap at any order.
Source: Parrott's theorem, in Zhou, Doyle & Glover 1996, Robust and Optimal Control, section 2.11.
"""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from controllers.synthesis.certify import Certificate
from controllers.synthesis.norm import build_frequency_grid, frequency_response
from controllers.synthesis.plant import GeneralisedPlant, Loop
from seatsim.schema.arrays import Array

Response = NDArray[np.complex128]


def compute_lower_bound(
    plant: GeneralisedPlant, stabilising: Array, certificate: Certificate | None, deadline: float
) -> float:
    """Return the larger of the pointwise and the full-order LMI bound.

    `stabilising` is a gain (nu, ny) whose loop the certificate is for. The LMI is solved only where there is a
    certificate, in whose coordinates it is well scaled, and time left before `deadline` (`time.monotonic()`).
    """
    bound = compute_pointwise_bound(plant, stabilising)
    if certificate is not None and time.monotonic() < deadline:
        from controllers.synthesis.lmi import compute_full_order_bound

        bound = max(bound, compute_full_order_bound(plant, certificate.factor, certificate.gamma, deadline))
    return bound


def compute_pointwise_bound(plant: GeneralisedPlant, stabilising: Array) -> float:
    """Return the bound; `stabilising` is any stabilising gain (nu, ny)."""
    loop = plant.close(stabilising)
    omega = build_frequency_grid(loop)
    T = frequency_response(loop, omega)
    from_control = frequency_response(Loop(loop.A, plant.B2, loop.C, plant.D12), omega)
    to_measured = frequency_response(Loop(loop.A, loop.B, plant.C2, plant.D21), omega)
    adjoint = _largest_unreached(np.conj(np.swapaxes(to_measured, 1, 2)), np.conj(np.swapaxes(T, 1, 2)))
    return max(_largest_unreached(from_control, T), adjoint)


def _largest_unreached(path: Response, T: Response) -> float:
    """Largest singular value, over all frequencies, of what `path` (m, nz, nu) does not reach of T."""
    reached = path.shape[2]
    # With as many inputs as outputs nothing is out of reach.
    if path.shape[1] <= reached:
        return 0.0
    basis = np.linalg.svd(path)[0][:, :, reached:]
    return float(np.linalg.svd(np.conj(np.swapaxes(basis, 1, 2)) @ T, compute_uv=False).max())
