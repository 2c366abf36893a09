"""Seat, weighting and criterion as a linear-quadratic problem in a damper force that is held over each interval.

The run is that of the seat without damper, shaken by the floor, plus the response of seat and Wk filter to the force:

    s[k+1] = A s[k] + B F[k],   s = (x, v, xc, vc, eight filter states) of the response, s[0] = 0
    w[k]   = velocity . (s[k], F[k]) + w0[k],   mean velocity of the damper over the interval
    J      = J0 + sum over k of (s, F)' Q (s, F) + 2 q[k]' (s, F)

J = mean(aw^2) + mu mean(x^2) over all samples of the record, aw the Wk-weighted acceleration of the driver.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.signal
from numpy.typing import NDArray

from seatsim.metrics.weighting import WEIGHTINGS, weight
from seatsim.plant import Plant, StateSpace, state_space

Array = NDArray[np.float64]


class Criterion(NamedTuple):
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
    acceleration: Criterion
    travel: Criterion


def transcribe(plant: Plant, floor: Array, sample: float, every: int, start: tuple[float, float]) -> Transcription:
    """Return the problem of a seat on a floor acceleration in m/s^2, shape (M,), linear between samples.

    The force is held over `every` samples of `sample` seconds. Samples after the last whole interval count as zero,
    which only lowers the criterion.
    """
    s = state_space(plant)
    count = (len(floor) - 1) // every
    used = count * every + 1
    time = sample * np.arange(used)
    response = scipy.signal.lsim((s.A, s.B1, s.C1, np.zeros((2, 1))), floor[:used], time, [*start, 0.0, 0.0])[1]
    travel, acceleration = np.ascontiguousarray(response.T)
    A, B, C = _weighted(s)
    held = [_held(A, B, (j + 1) * sample) for j in range(every)]
    last = held[-1]
    readings = [C @ np.column_stack(pair) for pair in held]
    ratio = plant.damper_ratio / (every * sample)
    aw = weight(acceleration, 1 / sample)
    total = len(floor)
    return Transcription(
        every * sample, last[0], last[1],
        ratio * (np.column_stack(last)[0] - np.eye(len(A) + 1)[0]), ratio * np.diff(travel[::every]),
        _criterion(aw, [rows[0] for rows in readings], total),
        _criterion(travel, [rows[1] for rows in readings], total),
    )  # fmt: skip


def _criterion(free: Array, rows: list[Array], total: int) -> Criterion:
    """Return the mean square of `free[1 + k every + j] + rows[j] . (s[k], F[k])`, all samples weighing 1 / total."""
    R = np.array(rows)
    inside = free[1:].reshape(-1, len(rows))
    return Criterion(float(np.sum(free**2)) / total, R.T @ R / total, inside @ R / total)


def _held(A: Array, B: Array, length: float) -> tuple[Array, Array]:
    """Return the exact transition over `length` seconds under a constant input."""
    n = len(A)
    flow = np.zeros((n + 1, n + 1))
    flow[:n, :n], flow[:n, n] = A, B
    step = scipy.linalg.expm(length * flow)
    return step[:n, :n], step[:n, n]


def _weighted(seat: StateSpace) -> tuple[Array, Array, Array]:
    """Return (A, B, C) from the damper force to the Wk-weighted acceleration of the driver and the travel."""
    a, b, c, d = _wk()
    A = np.block([[seat.A, np.zeros((4, len(a)))], [np.outer(b, seat.C1[1]), a]])
    B = np.concatenate([seat.B2[:, 0], np.zeros(len(a))])
    C = np.vstack([np.concatenate([d * seat.C1[1], c]), np.eye(1, len(A))])
    return A, B, C


def _wk() -> tuple[Array, Array, Array, float]:
    """Return a state space (a, b, c, d) of the weighting Wk: its four factors in series, states of one size."""
    w = WEIGHTINGS["Wk"]
    step = w.step
    if step is None:
        raise AssertionError("Wk has an upward step")
    rise = step.f5 / step.f6
    factors = (
        (w.f1, math.sqrt(0.5), (0.0, 0.0, 1.0)),
        (w.f2, math.sqrt(0.5), (1.0, 0.0, 0.0)),
        (w.f4, w.Q4, (1.0, w.f4 / w.f3, 0.0)),
        (step.f6, step.Q6, (rise**2, rise / step.Q5, 1.0)),
    )
    a, b, c, d = np.zeros((0, 0)), np.zeros(0), np.zeros(0), 1.0
    for corner, quality, numerator in factors:
        af, bf, cf, df = _factor(2 * math.pi * corner, quality, numerator)
        a = np.block([[a, np.zeros((len(a), 2))], [np.outer(bf, c), af]])
        b, c, d = np.concatenate([b, bf * d]), np.concatenate([df * c, cf]), df * d
    return a, b, c, d


def _factor(w: float, quality: float, n: tuple[float, float, float]) -> tuple[Array, Array, Array, float]:
    """Return the state space of (n0 + n1 u + n2 u^2) / (1 + u / quality + u^2), u = s / w."""
    a = w * np.array([[0.0, 1.0], [-1.0, -1.0 / quality]])
    return a, np.array([0.0, w]), np.array([n[0] - n[2], n[1] - n[2] / quality]), n[2]
