"""The seat as a generalised plant for synthesis: weights, lag of the actuator, and what may vary."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from controllers.linear_systems import (
    LinearSystem,
    connect_in_parallel,
    connect_in_series,
    frequency_weighting,
    pass_through,
    second_order_section,
)
from controllers.shaping_filter import ShapingFilter
from seatsim.rig.plant import Plant, state_space
from seatsim.rig.sensors import Sensors
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param

if TYPE_CHECKING:
    from controllers.synthesis import GeneralisedPlant


Measure = Literal[
    "displacement", "velocity", "frame_velocity", "driver_velocity", "frame_acceleration", "driver_acceleration"
]
"""What a feedback may measure: suspension x and v, absolute velocities and accelerations of frame and driver."""
TRAVEL_AND_RATE: tuple[Measure, ...] = ("displacement", "velocity")


class Weights(NamedTuple):
    """Weights of the performance output `z = (travel x, acceleration H zc'')` (Yu et al. 2019, eq 17).

    H is 1 or the frequency weighting of ISO 2631-1. The disturbance w is the floor's acceleration, white, or coloured:
    `z0'' = G w`, with G fitted to the spectrum of every floor of the scenario (`controllers.shaping_filter`). The
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
    from controllers.synthesis import GeneralisedPlant

    if weights.travel == "limit":
        raise InputError("travel: limit is found by simulation of a scenario; state a number here")
    if "frame_acceleration" in measures and lag is None:
        raise InputError("frame_acceleration: the wanted force acts on it at once; state the coil's lag under lag")
    seat = _seat(plant, measures)
    if lag is not None:
        seat = connect_in_series(connect_in_parallel(pass_through(1), build_actuator(lag)), seat)
    if floor is not None:
        seat = connect_in_series(connect_in_parallel(floor.as_system(), pass_through(1)), seat)
    if weights.comfort != "none":
        weighting = frequency_weighting(weights.comfort)
        seat = connect_in_series(seat, connect_in_parallel(pass_through(1), weighting, pass_through(len(measures))))
    scale = np.diag([weights.travel, weights.acceleration, *[1.0] * len(measures)])
    A, B, C = seat.A, seat.B * [1.0, force_factor], scale @ seat.C
    return GeneralisedPlant(
        A,
        B[:, :1],
        B[:, 1:],
        C[:2],
        C[2:],
        np.zeros((2, 1)),
        np.zeros((2, 1)),
        np.zeros((len(measures), 1)),
        None if displacement_gain else np.array([[measure != "displacement" for measure in measures]]),
    )


def _seat(plant: Plant, measures: Sequence[Measure]) -> LinearSystem:
    """Return the seat from (z0'', Fd) to x, zc'' and what is measured."""
    s = state_space(plant)
    # Of the two accelerations only the frame's feels the force at once; z0'' acts on neither.
    frame, at_once = s.A[1:2], np.array([[0.0, float(s.B2[1, 0])]])
    driver, nothing = s.C1[1:2], np.zeros((1, 2))
    paths = {
        "displacement": (s.C2[:1], nothing),
        "velocity": (s.C2[1:], nothing),
        "frame_velocity": (frame, at_once),
        "frame_acceleration": (frame, at_once),
        "driver_velocity": (driver, nothing),
        "driver_acceleration": (driver, nothing),
    }
    measured = [paths[measure] for measure in measures]
    C, D = (np.vstack(parts) for parts in zip((s.C1, np.zeros((2, 2))), *measured, strict=True))
    seat = LinearSystem(s.A, np.hstack([s.B1, s.B2]), C, D)
    if not any(measure.endswith("_velocity") for measure in measures):
        return seat
    leak = LinearSystem(*(np.array([[value]]) for value in (-math.tau * Sensors().corner, 1.0, 1.0, 0.0)))
    behind = [leak if measure.endswith("_velocity") else pass_through(1) for measure in measures]
    return connect_in_series(seat, connect_in_parallel(pass_through(2), *behind))


def build_actuator(lag: ActuatorLag) -> LinearSystem:
    """Return the lag from the wanted force to the damper's."""
    coil = LinearSystem(*(np.array([[value]]) for value in (-lag.rate, lag.rate, 1.0, 0.0)))
    if lag.delay == 0:
        return coil
    d = lag.delay
    return connect_in_series(second_order_section((1.0, -d / 2, d * d / 12), (1.0, d / 2, d * d / 12)), coil)
