"""How much a seat's loop under static output feedback can take: its margins.

The loop is broken at the damper force, with the damper taken as delivering the wanted force through the coil's lag (the
linear view of the semi-active loop; the clip to what a damper can do only takes energy out).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from controllers.linear_systems import LinearSystem
from controllers.synthesis.norm import frequency_response
from controllers.synthesis.plant import Loop
from seatsim.schema.arrays import Array

_ROUNDING = 1e-6
"""Real part of a zero, as a share of its size, up to which it lies on the imaginary axis."""


class Margins(NamedTuple):
    """Factor by which the loop gain may rise (inf where any may), phase margin in degrees, delay margin in s."""

    gain: float
    phase: float
    delay: float


def compute_margins(seat: LinearSystem, gain: Array) -> Margins:
    """Return the margins of the loop `L(s) = -K G(s)`, with G, the `seat`, from the wanted force to what is measured.

    L is real where `L(s) = L(-s)`, and of magnitude 1 where `L(s) L(-s) = 1`: on the imaginary axis, both are the zeros
    of systems with the states of L twice. The delay margin is the least phase margin over its frequency (rad/rad/s),
    over all frequencies of magnitude 1.
    """
    loop = Loop(seat.A, seat.B, -np.atleast_2d(gain) @ seat.C, np.zeros((1, 1)))
    A, B, C, _ = loop
    nothing = np.zeros_like(A)
    odd = np.block([[A, nothing, B], [nothing, -A, B], [C, C, np.zeros((1, 1))]])
    turns = scipy.linalg.eigvals(odd, np.diag(np.append(np.ones(2 * len(A)), 0.0)))
    crossings = _find_on_axis(np.linalg.eigvals(np.block([[A, B @ B.T], [-C.T @ C, -A.T]])))
    at_real = frequency_response(loop, np.append(0.0, _find_on_axis(turns))).real.ravel()
    phases = np.pi + np.angle(frequency_response(loop, crossings).ravel())
    # Factors below 1 are reductions: the seat without control is stable, so the margin that is asked for is a rise.
    rises = -1.0 / at_real[(at_real < 0.0) & (at_real > -1.0)]
    return Margins(
        float(np.min(rises, initial=math.inf)),
        float(np.degrees(np.min(np.minimum(phases, 2.0 * np.pi - phases), initial=math.inf))),
        float(np.min(phases / crossings, initial=math.inf)),
    )


def _find_on_axis(zeros: NDArray[np.complexfloating]) -> Array:
    """Return the positive frequencies of zeros on the imaginary axis, to rounding."""
    found = zeros[np.isfinite(zeros)]
    return np.asarray(found.imag[(found.imag > 0.0) & (np.abs(found.real) <= _ROUNDING * np.abs(found))])
