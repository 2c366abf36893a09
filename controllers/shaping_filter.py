"""Shaping filter of a floor: it turns white noise into an acceleration with the spectrum of the floor's."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_toeplitz

from controllers.linear_systems import LinearSystem
from seatsim.rig.control import FloorRecord
from seatsim.schema.errors import InputError

_ORDER = 4
"""Order of the model: a peak with its two flanks, and a slope beside it. Every order costs the synthesis time."""
_RATE = 40.0
"""Sample rate of the model in Hz: below half of it lies nearly all that shakes a driver."""


class ShapingFilter(NamedTuple):
    """Autoregressive model `a_k = c1 a_(k-1) + ... + cn a_(k-n) + deviation e_k` of an acceleration of 1 m/s^2 RMS.

    `coefficients` are c1 ... cn, at 40 Hz; e_k is white with variance 1.
    """

    coefficients: tuple[float, ...]
    deviation: float

    def as_system(self) -> LinearSystem:
        """Return G of `z0'' = G w` in continuous time by the bilinear transformation; w has a density of 1 per Hz."""
        n, k = len(self.coefficients), 2.0 * _RATE
        A = np.vstack([self.coefficients, np.eye(n - 1, n)])
        B, C = np.eye(n, 1) * self.deviation / math.sqrt(_RATE), np.array([self.coefficients])
        inverse = np.linalg.inv(np.eye(n) + A)
        return LinearSystem(
            k * inverse @ (A - np.eye(n)),
            math.sqrt(2.0 * k) * inverse @ B,
            math.sqrt(2.0 * k) * C @ inverse,
            B[:1] - C @ inverse @ B,
        )


def fit_shaping_filter(floor: FloorRecord) -> ShapingFilter:
    """Return the model of a floor's acceleration by the Yule-Walker equations, which always give a stable one.

    The record fades in and out: cut ends leak into the model's stop bands, which another draw of the floor then moves.

    Raises:
        InputError: the floor rests, or its record is too short.
    """
    # Imported here: it takes long, and most designs are for a white floor.
    from scipy.signal import resample_poly

    rate = 1.0 / floor.step
    acceleration = resample_poly(floor.acceleration, round(_RATE), round(rate))
    acceleration = (acceleration - acceleration.mean()) * np.hanning(len(acceleration))
    power = float(np.mean(acceleration**2))
    if len(acceleration) < 10 * _ORDER or power == 0.0:
        raise InputError("floor: excitation: the floor rests, or its record is too short to have a spectrum")
    count = len(acceleration)
    correlation = [float(acceleration[: count - lag] @ acceleration[lag:]) / count / power for lag in range(_ORDER + 1)]
    coefficients = solve_toeplitz(correlation[:-1], correlation[1:])
    deviation = math.sqrt(1.0 - float(coefficients @ correlation[1:]))
    return ShapingFilter(tuple(coefficients.tolist()), deviation)
