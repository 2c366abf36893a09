"""Linear systems: connected, and frequency weightings with states."""

from __future__ import annotations

import math
from functools import reduce
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from seatsim.metrics.weighting import sections
from seatsim.schema.arrays import Array

Coefficients = tuple[float, float, float]


class LinearSystem(NamedTuple):
    """A linear system `x' = A x + B u`, `y = C x + D u`; shapes (n, n), (n, m), (p, n), (p, m)."""

    A: Array
    B: Array
    C: Array
    D: Array


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
