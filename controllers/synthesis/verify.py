"""What is true of a gain on a plant, whatever search it came from: norm twice, certificate, margin, poles."""

from __future__ import annotations

import numpy as np

from controllers.synthesis.certify import certify
from controllers.synthesis.design import ClosedLoop
from controllers.synthesis.norm import Peak, grid_norm, hinf_norm
from controllers.synthesis.plant import GeneralisedPlant, Loop
from seatsim.schema.arrays import Array

# Two frequencies of equal height differ by rounding; a grid higher by more has found what bisection missed.
_ROUNDING = 1e-10
_AGREEMENT = 1e-6  # what the documentation states of the norm


def verify(plant: GeneralisedPlant, gain: Array, order: int = 0) -> ClosedLoop:
    """Return what is known of a plant under a stabilising gain (nu, ny); the last `order` controls are not physical."""
    loop = plant.close(gain)
    peak, agree = _compute_verified_norm(loop)
    certificate, margin = certify(plant, gain, peak.value), disk_margin(plant, gain, plant.control_count - order)
    return ClosedLoop(plant, peak.value, peak.frequency, agree, certificate, margin, loop.poles)


def _compute_verified_norm(loop: Loop) -> tuple[Peak, bool]:
    """Return the larger H-infinity norm of bisection and frequency grid, and whether the two agree to 1e-6."""
    norm, grid = hinf_norm(loop), grid_norm(loop)
    if norm.value < grid.value * (1 - _ROUNDING):
        norm = hinf_norm(loop, guesses=[grid.frequency])
    return norm, norm.value - grid.value <= _AGREEMENT * norm.value


def disk_margin(plant: GeneralisedPlant, gain: Array, controls: int) -> float:
    """Return the balanced disk margin at the first `controls`, 2 / ||2 S - I||, with S = (I - K G)^-1; at most 2."""
    A = plant.A + plant.B2 @ gain @ plant.C2
    return 2 / hinf_norm(Loop(A, plant.B2[:, :controls], 2 * gain[:controls] @ plant.C2, np.eye(controls))).value
