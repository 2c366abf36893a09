"""Linear systems: connected, frequency weightings with states, and the margins of a seat's loop.

For its margins a loop under static output feedback is broken at the damper force, with the damper taken as delivering
the wanted force through the coil's lag (the linear view of the semi-active loop; the clip to what a damper can do only
takes energy out).
"""

from __future__ import annotations

import math
from functools import reduce
from typing import NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.linalg import block_diag

from controllers.synthesis.norm import frequency_response
from controllers.synthesis.plant import LinearSystem
from seatsim.metrics.weighting import sections
from seatsim.schema.arrays import Array

Coefficients = tuple[float, float, float]


def pass_through(size: int) -> LinearSystem:
    """Return what passes `size` signals on as they are."""
    return LinearSystem(np.zeros((0, 0)), np.zeros((0, size)), np.zeros((size, 0)), np.eye(size))


def connect_in_series(first: LinearSystem, second: LinearSystem) -> LinearSystem:
    """Return `first` followed by `second`; the states of `first` come first."""
    n, m = len(first.A), len(second.A)
    A = np.block([[first.A, np.zeros((n, m))], [second.B @ first.C, second.A]])
    B = np.vstack([first.B, second.B @ first.D])
    return LinearSystem(A, B, np.hstack([second.D @ first.C, second.C]), second.D @ first.D)


def connect_in_parallel(*systems: LinearSystem) -> LinearSystem:
    """Return systems side by side, each with its own inputs and outputs."""
    return LinearSystem(*(np.asarray(block_diag(*parts), dtype=float) for parts in zip(*systems, strict=True)))


def second_order_section(numerator: Coefficients, denominator: Coefficients) -> LinearSystem:
    """Return the system of `(b0 + b1 s + b2 s^2) / (a0 + a1 s + a2 s^2)`, with s in rad/s.

    With u = s / w and w^2 = a0 / a2 it is `(n0 + n1 u + n2 u^2) / (1 + u / Q + u^2)`, whose two states are of one size.
    """
    b, a = np.array(numerator) / denominator[0], np.array(denominator) / denominator[0]
    w = 1.0 / math.sqrt(a[2])
    n, loss = b * [1.0, w, w * w], a[1] * w
    A, B = w * np.array([[0.0, 1.0], [-1.0, -loss]]), np.array([[0.0], [w]])
    return LinearSystem(A, B, np.array([[n[0] - n[2], n[1] - n[2] * loss]]), np.array([[n[2]]]))


def frequency_weighting(weighting: str) -> LinearSystem:
    """Return a frequency weighting of ISO 2631-1 as a system: two states a factor, in the order of its equation.

    Raises:
        InputError: no weighting has this name.
    """
    return reduce(connect_in_series, (second_order_section(*factor) for factor in sections(weighting)))


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
    A, B, C, D = loop = LinearSystem(seat.A, seat.B, -np.atleast_2d(gain) @ seat.C, np.zeros((1, 1)))
    nothing = np.zeros_like(A)
    odd = np.block([[A, nothing, B], [nothing, -A, B], [C, C, D]])
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
