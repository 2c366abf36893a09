"""Linear-quadratic control of the seat: a regulator that trades acceleration, travel and force, and a Kalman filter.

The filter is steady, and estimates the state out of suspension displacement, driver acceleration and damper force. A
Riccati equation that has no solution in double precision is one clear error.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, NamedTuple

import numpy as np
from scipy.linalg import expm, solve_discrete_are

from seatsim.compilation.jit import jit
from seatsim.rig.control import Measurement, State
from seatsim.rig.plant import Plant, state_space, zero_order_hold
from seatsim.schema.arrays import Array
from seatsim.schema.errors import SynthesisError
from seatsim.schema.fields import param


@contextmanager
def solving(what: str) -> Iterator[None]:
    """Raise SynthesisError where the equation of `what`, which is solved meanwhile, has no solution in numbers.

    Its weights, or its noise, then lie so many orders of magnitude apart that an eigenvalue is lost in rounding.
    """
    try:
        yield
    except (np.linalg.LinAlgError, ValueError) as error:
        raise SynthesisError(
            f"the Riccati equation of the {what} has no solution in numbers ({error}); choose values of its weights or"
            " of its noise that are less far apart"
        ) from error


class QuadraticWeights(NamedTuple):
    """Weights of `J = integral of (acceleration zc'')^2 + (travel x)^2 + (force Fd)^2 dt`."""

    travel: Annotated[float, param("1/s^2", "weight of the suspension displacement", above=0, high=1e6)] = 20.0
    acceleration: Annotated[float, param("-", "weight of the driver's acceleration", low=0, high=1e6)] = 1.0
    force: Annotated[float, param("1/kg", "weight of the damper force", above=0, high=1e3)] = 7e-3


def solve_regulator(plant: Plant, weights: QuadraticWeights) -> State:
    """Return the gain k of `Fd = k . (x, v, zc - zs, its rate)` that minimises the cost, from the Riccati equation.

    Raises:
        SynthesisError: the weights are so far apart that it has no solution in numbers.
    """
    import control

    s = state_space(plant)
    z = s.C1 * [[weights.travel], [weights.acceleration]]
    with solving("regulator"):
        gain, _, _ = control.lqr(s.A, s.B2, z.T @ z, np.array([[weights.force**2]]))
    return _rows(-gain)[0]


Rows = tuple[State, ...]
AT_REST: State = (0.0, 0.0, 0.0, 0.0)


class Noise(NamedTuple):
    """What the filter takes for noise: the floor's motion, the damper force between samples, the readings."""

    floor: Annotated[
        float, param("(m/s^2)^2/Hz", "two-sided density of the floor's acceleration, taken as white", above=0, high=1e4)
    ] = 0.05
    force: Annotated[float, param("N", "RMS error of the damper force held over a sample", low=0, high=1e5)] = 50.0
    displacement: Annotated[float, param("m", "RMS noise of the displacement", above=0, high=1)] = 2e-4
    acceleration: Annotated[float, param("m/s^2", "RMS noise of the driver's acceleration", above=0, high=1e3)] = 0.05


class KalmanFilter(NamedTuple):
    """Compiled form: at every sample `x <- x + correction (y - output x)`, then `x <- transition x + input_gain Fd`."""

    transition: Rows
    input_gain: State
    output: Rows
    correction: Rows


def design_kalman_filter(plant: Plant, noise: Noise, sample_time: float) -> KalmanFilter:
    """Return the steady filter of the sampled seat, from the discrete Riccati equation.

    Args:
        plant: the seat, with state (x, v, zc - zs, its rate).
        noise: densities and RMS values of what is not known.
        sample_time: in s, over which the damper force is taken as held.

    Raises:
        SynthesisError: the noises are so far apart that the equation has no solution in numbers.
    """
    s = state_space(plant)
    transition, input_gain = zero_order_hold(s.A, s.B2, sample_time)
    n, density = len(s.A), noise.floor
    # The covariance that a floor of white noise adds to the state over a sample (Van Loan 1978).
    both = expm(np.block([[-s.A, density * s.B1 @ s.B1.T], [np.zeros((n, n)), s.A.T]]) * sample_time)
    process_noise = both[n:, n:].T @ both[:n, n:] + noise.force**2 * input_gain @ input_gain.T
    reading = np.diag([noise.displacement**2, noise.acceleration**2])
    with solving("Kalman filter"):
        p = solve_discrete_are(transition.T, s.C1.T, process_noise, reading)
        correction = np.linalg.solve(s.C1 @ p @ s.C1.T + reading, s.C1 @ p).astype(np.float64)
    return KalmanFilter(_rows(transition), _rows(input_gain.T)[0], _rows(s.C1), _rows(correction))


def _rows(matrix: Array) -> Rows:
    return tuple(map(tuple, matrix.tolist()))


@jit
def dot(a: State, b: State) -> float:
    """Return the product of two rows of four."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]


@jit
def correct(e: KalmanFilter, y: Measurement, x: State) -> State:
    """Return the estimated (x, v, zc - zs, its rate) with a sample's readings, from its prediction."""
    first, second = e.correction
    a = y.displacement - dot(e.output[0], x)
    b = y.driver_acceleration - dot(e.output[1], x)
    return (
        x[0] + first[0] * a + second[0] * b,
        x[1] + first[1] * a + second[1] * b,
        x[2] + first[2] * a + second[2] * b,
        x[3] + first[3] * a + second[3] * b,
    )


@jit
def predict(e: KalmanFilter, y: Measurement, x: State) -> State:
    """Return the prediction for the next sample from that for this one; the damper force read is held until then."""
    now, force = correct(e, y, x), y.damper_force
    return (
        dot(e.transition[0], now) + e.input_gain[0] * force,
        dot(e.transition[1], now) + e.input_gain[1] * force,
        dot(e.transition[2], now) + e.input_gain[2] * force,
        dot(e.transition[3], now) + e.input_gain[3] * force,
    )
