"""The seat as a generalised plant for synthesis: linear systems connected, weights, the actuator's lag, loop margins.

For its margins a loop under static output feedback is broken at the damper force, with the damper taken as delivering
the wanted force through the coil's lag (the linear view of the semi-active loop; the clip to what a damper can do only
takes energy out).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import reduce
from typing import Annotated, Literal, NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from pydantic import Field
from scipy.linalg import block_diag, solve_toeplitz

from controllers.synthesis.norm import frequency_response
from controllers.synthesis.plant import GeneralisedPlant, LinearSystem
from seatsim.metrics.weighting import sections
from seatsim.rig.control import FloorRecord
from seatsim.rig.plant import Plant, state_space
from seatsim.rig.sensors import Sensors
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param

Coefficients = tuple[float, float, float]


def _pass_through(size: int) -> LinearSystem:
    """Return what passes `size` signals on as they are."""
    return LinearSystem(np.zeros((0, 0)), np.zeros((0, size)), np.zeros((size, 0)), np.eye(size))


def _connect_in_series(first: LinearSystem, second: LinearSystem) -> LinearSystem:
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
    return reduce(_connect_in_series, (second_order_section(*factor) for factor in sections(weighting)))


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
        inverse, size = np.linalg.inv(np.eye(n) + A), math.sqrt(2.0 * k)
        flow = k * inverse @ (A - np.eye(n))
        return LinearSystem(flow, size * inverse @ B, size * C @ inverse, B[:1] - C @ inverse @ B)


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
    count = len(acceleration)
    acceleration = (acceleration - acceleration.mean()) * np.hanning(count)
    power = float(np.mean(acceleration**2))
    if count < 10 * _ORDER or power == 0.0:
        raise InputError("floor: excitation: the floor rests, or its record is too short to have a spectrum")
    correlation = [float(acceleration[: count - lag] @ acceleration[lag:]) / count / power for lag in range(_ORDER + 1)]
    coefficients = solve_toeplitz(correlation[:-1], correlation[1:])
    deviation = math.sqrt(1.0 - float(coefficients @ correlation[1:]))
    return ShapingFilter(tuple(coefficients.tolist()), deviation)


Measure = Literal[
    "displacement", "velocity", "frame_velocity", "driver_velocity", "frame_acceleration", "driver_acceleration"
]
"""What a feedback may measure: suspension x and v, absolute velocities and accelerations of frame and driver."""
TRAVEL_AND_RATE: tuple[Measure, ...] = ("displacement", "velocity")


class Weights(NamedTuple):
    """Weights of the performance output `z = (travel x, acceleration H zc'')` (Yu et al. 2019, eq 17).

    H is 1 or the frequency weighting of ISO 2631-1. The disturbance w is the floor's acceleration, white, or coloured:
    `z0'' = G w`, with G fitted to the spectrum of every floor of the scenario (`fit_shaping_filter`). The
    travel weight `limit` is the least whose clipped, inverted and lagging seat stays within its stops in simulation.
    """

    travel: Annotated[
        Annotated[float, param("1/s^2", "weight e1 of the suspension displacement", low=0, high=1e6)]
        | Literal["limit"],
        Field(description="weight e1 of the suspension displacement, or 'limit': what the travel of the seat permits"),
    ] = 22.6
    acceleration: Annotated[float, param("-", "weight e2 of the driver's acceleration", low=0, high=1e6)] = 1.0
    comfort: Annotated[Literal["none", "Wk"], Field(description="frequency weighting of the driver's acceleration")] = (
        "none"
    )
    floor: Annotated[
        Literal["white", "excitation"],
        Field(description="spectrum of the floor's acceleration: white, or that of the scenario's floors"),
    ] = "white"


class ActuatorLag(NamedTuple):
    """What the design knows of the way from the wanted force to the damper's: `exp(-delay s) rate / (s + rate)`.

    A controller that holds its command for a sample time T delays by about T/2: add it to the transport delay.
    """

    rate: Annotated[float, param("1/s", "rate of the coil", above=0, high=1e5)] = 130.0
    delay: Annotated[float, param("s", "transport delay and half the sample time", low=0, high=0.1)] = 0.0


def build_generalised_plant(
    plant: Plant,
    weights: Weights,
    lag: ActuatorLag | None = None,
    displacement_gain: bool = True,
    force_factor: float = 1.0,
    measures: Sequence[Measure] = TRAVEL_AND_RATE,
    floor: ShapingFilter | None = None,
) -> GeneralisedPlant:
    """Return the exact seat plant for synthesis: disturbance z0'', control Fd, y as in `measures`, z as in `Weights`.

    With `floor` the disturbance is the white noise w of its shaping filter, `z0'' = G w`. With `lag` the control is the
    wanted force, and the delay is a Pade approximation of order 2, whose phase is right to 0.1 degrees up to
    `delay omega = 1`. The damper delivers `force_factor` of what is wanted, at every temperature. An absolute velocity
    is the leaky integral of an acceleration, `1 / (s + wc)`, with the default corner of `seatsim.rig.sensors.Sensors`.

    Raises:
        InputError: the frame's acceleration is measured without a `lag`: the force would act on it at once; or the
            travel weight is still `limit`.
    """
    if weights.travel == "limit":
        raise InputError("travel: limit is found by simulation of a scenario; state a number here")
    if "frame_acceleration" in measures and lag is None:
        raise InputError("frame_acceleration: the wanted force acts on it at once; state the coil's lag under lag")
    seat = _seat(plant, measures)
    if lag is not None:
        seat = _connect_in_series(connect_in_parallel(_pass_through(1), build_actuator(lag)), seat)
    if floor is not None:
        seat = _connect_in_series(connect_in_parallel(floor.as_system(), _pass_through(1)), seat)
    if weights.comfort != "none":
        weighting = frequency_weighting(weights.comfort)
        seat = _connect_in_series(seat, connect_in_parallel(_pass_through(1), weighting, _pass_through(len(measures))))
    scale = np.diag([weights.travel, weights.acceleration, *[1.0] * len(measures)])
    # No path is direct: what is measured and weighed follows the force through the lag, or the seat's states.
    system = LinearSystem(seat.A, seat.B * [1.0, force_factor], scale @ seat.C, np.zeros_like(seat.D))
    structure = None if displacement_gain else [[measure != "displacement" for measure in measures]]
    return GeneralisedPlant.from_system(system, 1, 2, structure)


def _seat(plant: Plant, measures: Sequence[Measure]) -> LinearSystem:
    """Return the seat from (z0'', Fd) to x, zc'' and what is measured."""
    s = state_space(plant)
    # Of the two accelerations only the frame's feels the force at once; z0'' acts on neither.
    nothing, at_once = np.zeros((1, 2)), np.array([[0.0, float(s.B2[1, 0])]])
    frame, driver = (s.A[1:2], at_once), (s.C1[1:2], nothing)
    paths = {"displacement": (s.C2[:1], nothing), "velocity": (s.C2[1:], nothing)}
    paths |= {"frame_velocity": frame, "frame_acceleration": frame}
    paths |= {"driver_velocity": driver, "driver_acceleration": driver}
    measured = [paths[measure] for measure in measures]
    C, D = (np.vstack(parts) for parts in zip((s.C1, np.zeros((2, 2))), *measured, strict=True))
    seat = LinearSystem(s.A, np.hstack([s.B1, s.B2]), C, D)
    if not any(measure.endswith("_velocity") for measure in measures):
        return seat
    leak = _first_order(-math.tau * Sensors().corner, 1.0)
    behind = [leak if measure.endswith("_velocity") else _pass_through(1) for measure in measures]
    return _connect_in_series(seat, connect_in_parallel(_pass_through(2), *behind))


def _first_order(a: float, b: float) -> LinearSystem:
    """Return `x' = a x + b u`, `y = x`."""
    return LinearSystem(*(np.array([[value]]) for value in (a, b, 1.0, 0.0)))


def build_actuator(lag: ActuatorLag) -> LinearSystem:
    """Return the lag from the wanted force to the damper's."""
    coil, d = _first_order(-lag.rate, lag.rate), lag.delay
    if d == 0:
        return coil
    return _connect_in_series(second_order_section((1.0, -d / 2, d * d / 12), (1.0, d / 2, d * d / 12)), coil)
