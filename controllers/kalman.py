"""A steady Kalman filter of the seat's state, out of suspension displacement, driver acceleration and damper force."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm, solve_discrete_are

from controllers.linear import held
from seatsim.compilation.jit import jit
from seatsim.rig.control import Measurement
from seatsim.rig.plant import Plant, PlantMatrices, state_space
from seatsim.schema.fields import param

Array = NDArray[np.float64]
State = tuple[float, ...]
Rows = tuple[State, ...]
REST: State = (0.0, 0.0, 0.0, 0.0)


class Noise(NamedTuple):
    """What the filter takes for noise: the floor's motion, the damper force between samples, the readings."""

    floor: Annotated[
        float, param("(m/s^2)^2/Hz", "two-sided density of the floor's acceleration, taken as white", above=0, high=1e4)
    ] = 0.05
    force: Annotated[float, param("N", "RMS error of the damper force held over a sample", low=0, high=1e5)] = 50.0
    displacement: Annotated[float, param("m", "RMS noise of the displacement", above=0, high=1)] = 2e-4
    acceleration: Annotated[float, param("m/s^2", "RMS noise of the driver's acceleration", above=0, high=1e3)] = 0.05


class Estimator(NamedTuple):
    """Compiled form: `x <- x + correction (y - seen x)`, then `x <- flow x + push Fd`, both at every sample."""

    flow: Rows
    push: State
    seen: Rows
    correction: Rows


def estimator(plant: Plant, noise: Noise, sample_time: float) -> Estimator:
    """Return the steady filter of the sampled seat, from the discrete Riccati equation."""
    s = state_space(plant)
    flow, push = held(s.A, s.B2, sample_time)
    spread = _spread(s, sample_time, noise.floor) + noise.force**2 * push @ push.T
    reading = np.diag([noise.displacement**2, noise.acceleration**2])
    p = solve_discrete_are(flow.T, s.C1.T, spread, reading)
    correction = np.linalg.solve(s.C1 @ p @ s.C1.T + reading, s.C1 @ p).astype(np.float64)
    return Estimator(_rows(flow), _rows(push.T)[0], _rows(s.C1), _rows(correction))


def _spread(s: PlantMatrices, time: float, density: float) -> Array:
    """Return the covariance (4, 4) that a floor of white noise adds to the state over a sample (Van Loan 1978)."""
    n = len(s.A)
    both = expm(np.block([[-s.A, density * s.B1 @ s.B1.T], [np.zeros((n, n)), s.A.T]]) * time)
    spread: Array = both[n:, n:].T @ both[:n, n:]
    return spread


def _rows(matrix: Array) -> Rows:
    return tuple(tuple(float(value) for value in row) for row in matrix)


@jit
def dot(a: State, b: State) -> float:
    """Return the product of two rows of four."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]


@jit
def corrected(e: Estimator, y: Measurement, x: State) -> State:
    """Return the estimated (x, v, zc - zs, its rate) with a sample's readings, from its prediction."""
    first, second = e.correction
    a = y.displacement - dot(e.seen[0], x)
    b = y.driver_acceleration - dot(e.seen[1], x)
    return (
        x[0] + first[0] * a + second[0] * b,
        x[1] + first[1] * a + second[1] * b,
        x[2] + first[2] * a + second[2] * b,
        x[3] + first[3] * a + second[3] * b,
    )


@jit
def predicted(e: Estimator, y: Measurement, x: State) -> State:
    """Return the prediction for the next sample from that for this one; the damper force read is held until then."""
    now, force = corrected(e, y, x), y.damper_force
    return (
        dot(e.flow[0], now) + e.push[0] * force,
        dot(e.flow[1], now) + e.push[1] * force,
        dot(e.flow[2], now) + e.push[2] * force,
        dot(e.flow[3], now) + e.push[3] * force,
    )
