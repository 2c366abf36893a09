"""Seat, weighting and criterion as a linear-quadratic problem in a damper force that is held over each interval.

The run is that of the seat without damper, shaken by the floor, plus the response of seat and Wk filter to the force:

    s[k+1] = A s[k] + B F[k],   s = (x, v, xc, vc, eight filter states) of the response, s[0] = 0
    w[k]   = velocity . (s[k], F[k]) + w0[k],   mean velocity of the damper over the interval
    J      = J0 + sum over k of (s, F)' Q (s, F) + 2 q[k]' (s, F)

J = mean(aw^2) + mu mean(x^2) over all samples of the record, aw the Wk-weighted acceleration of the driver.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from controllers.linear_systems import (
    LinearSystem,
    connect_in_parallel,
    connect_in_series,
    frequency_weighting,
    pass_through,
)
from seatsim.metrics.weighting import weight
from seatsim.rig.plant import Plant, state_space, zero_order_hold
from seatsim.schema.arrays import Array


class _Criterion(NamedTuple):
    """A mean square as a quadratic form of the state and force: `free` without force, `Q` (n+1, n+1), `q` (N, n+1)."""

    free: float
    Q: Array
    q: Array


class Transcription(NamedTuple):
    """The matrices of the module's equations for N intervals of `step` seconds."""

    step: float
    A: Array
    B: Array
    velocity: Array
    free_velocity: Array
    acceleration: _Criterion
    travel: _Criterion


def transcribe(plant: Plant, floor: Array, sample: float, every: int, start: tuple[float, float]) -> Transcription:
    """Return the problem of a seat on a floor acceleration in m/s^2, shape (M,), linear between samples.

    The force is held over `every` samples of `sample` seconds. Samples after the last whole interval count as zero,
    which only lowers the criterion.
    """
    s = state_space(plant)
    # Takes half a second to load, which runs without bounds do without.
    import scipy.signal

    count = (len(floor) - 1) // every
    used = count * every + 1
    time = sample * np.arange(used)
    response = scipy.signal.lsim((s.A, s.B1, s.C1, np.zeros((2, 1))), floor[:used], time, [*start, 0.0, 0.0])[1]
    travel, acceleration = np.ascontiguousarray(response.T)
    seat = LinearSystem(s.A, s.B2, s.C1, np.zeros((2, 1)))
    A, B, C, _ = connect_in_series(seat, connect_in_parallel(pass_through(1), frequency_weighting("Wk")))
    steps = [np.hstack(zero_order_hold(A, B, (j + 1) * sample)) for j in range(every)]
    last = steps[-1]
    rows = np.array([C @ step for step in steps])  # travel, weighted acceleration
    ratio = plant.damper_ratio / (every * sample)
    aw = weight(acceleration, 1 / sample)
    total = len(floor)
    return Transcription(
        every * sample,
        last[:, :-1],
        last[:, -1],
        ratio * (last[0] - np.eye(len(A) + 1)[0]),
        ratio * np.diff(travel[::every]),
        _criterion(aw, rows[:, 1], total),
        _criterion(travel, rows[:, 0], total),
    )


def _criterion(free: Array, rows: Array, total: int) -> _Criterion:
    """Return the mean square of `free[1 + k every + j] + rows[j] . (s[k], F[k])`, all samples weighing 1 / total."""
    inside = free[1:].reshape(-1, len(rows))
    return _Criterion(float(np.sum(free**2)) / total, rows.T @ rows / total, inside @ rows / total)
