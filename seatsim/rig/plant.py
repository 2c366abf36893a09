"""The 2-DOF seat/driver plant: its parameters, its state-space matrices, the paper's variant of them, and sampling."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import numpy as np
from scipy.linalg import expm

from seatsim.schema.arrays import Array
from seatsim.schema.fields import param

if TYPE_CHECKING:
    import control

USUAL_TRAVEL = (0.01, 0.12)
"""m; how far from mid-stroke the end stops of seats are."""


class Plant(NamedTuple):
    """Seat frame on its suspension, driver on the cushion (Yu et al. 2019, eqs 13 and 14).

        ms zs'' = -kf x - cf v + kc (zc - zs) + cc (zc' - zs') - Fd,   x = zs - z0,  v = x'
        m  zc'' = -kc (zc - zs) - cc (zc' - zs')

    Upward positive about static equilibrium; the damper force Fd is positive when it opposes extension.
    """

    frame_mass: Annotated[
        float, param("kg", "mass ms of seat frame and moving suspension", above=0, high=1e4, usual=(2, 200))
    ]
    driver_mass: Annotated[
        float, param("kg", "mass m of the driver on the cushion", above=0, high=1e4, usual=(20, 250))
    ]
    suspension_stiffness: Annotated[
        float, param("N/m", "spring and gas stiffness kf", low=0, high=1e8, usual=(200, 1e6))
    ]
    suspension_damping: Annotated[float, param("N s/m", "uncontrolled damping cf", low=0, high=1e7, usual=(2, 2e4))]
    cushion_stiffness: Annotated[float, param("N/m", "cushion stiffness kc", above=0, high=1e8, usual=(1e3, 1e6))]
    cushion_damping: Annotated[float, param("N s/m", "cushion damping cc", low=0, high=1e7, usual=(10, 5e4))]
    travel: Annotated[
        tuple[
            Annotated[float, param("m", "lower stop", high=0, low=-10, usual=USUAL_TRAVEL)],
            Annotated[float, param("m", "upper stop", low=0, high=10, usual=USUAL_TRAVEL)],
        ],
        param("m", "travel between the end stops, where suspension.end_stop states none", usual=USUAL_TRAVEL),
    ] = (-10.0, 10.0)
    damper_ratio: Annotated[
        float, param("-", "damper stroke per suspension displacement", above=0, high=10, usual=(0.1, 3))
    ] = 1.0

    @property
    def end_stops(self) -> tuple[float, float] | None:
        """Displacements in m, (low, high), at which the suspension meets its end stops; None where none are stated."""
        return None if self.travel == Plant._field_defaults["travel"] else self.travel


class PlantMatrices(NamedTuple):
    """Matrices of `x' = A x + B1 z0'' + B2 Fd`, `y = C2 x`, with x = (zs - z0, its rate, zc - zs, its rate).

    `C1 x` is (suspension displacement, driver acceleration); `B2` belongs to the damper force Fd of the sign
    convention, so that a positive gain on the velocity adds damping.
    """

    A: Array
    B1: Array
    B2: Array
    C1: Array
    C2: Array


def state_space(plant: Plant, variant: Literal["exact", "yu2019"] = "exact") -> PlantMatrices:
    """Return the plant's matrices, shapes A (4, 4), B1 (4, d), B2 (4, 1), C1 (2, 4), C2 (2, 4).

    `exact` follows from eqs 13 and 14 with one disturbance, the floor acceleration (d = 1). `yu2019` is what eq 15 of
    the paper prints: d = (z0'', zs''), so that the frame's own acceleration counts as an outside disturbance and row 4
    loses its coupling to suspension and damper; the transfer to the driver's acceleration then does not depend on the
    controller at all. Its B2 is given the sign with which eq 13 reads. For reproductions only.
    """
    ms, m = plant.frame_mass, plant.driver_mass
    kf, cf, kc, cc = plant[2:6]
    ratio = plant.damper_ratio
    frame = [-kf / ms, -cf / ms, kc / ms, cc / ms]
    driver = [0.0, 0.0, -kc / m, -cc / m]
    c1 = np.array([[1.0, 0.0, 0.0, 0.0], driver])
    if variant == "yu2019":
        cushion, coupling = driver, 0.0
        b1 = np.array([[0.0, 0.0], [-1.0, 0.0], [0.0, 0.0], [0.0, -1.0]])
    else:
        cushion, coupling = [d - f for d, f in zip(driver, frame, strict=True)], ratio / ms
        b1 = np.array([[0.0], [-1.0], [0.0], [0.0]])
    a = np.array([[0.0, 1.0, 0.0, 0.0], frame, [0.0, 0.0, 0.0, 1.0], cushion])
    return PlantMatrices(a, b1, np.array([[0.0], [-ratio / ms], [0.0], [coupling]]), c1, np.eye(2, 4))


def zero_order_hold(A: Array, B: Array, time: float) -> tuple[Array, Array]:
    """Return the exact (F, G) of `x <- F x + G u` over `time` seconds of `x' = A x + B u` with u held.

    Shapes: A, F (n, n), B, G (n, m).
    """
    n, m = B.shape
    step = expm(np.block([[A, B], [np.zeros((m, n + m))]]) * time)
    return step[:n, :n], step[:n, n:]


def control_system(plant: Plant) -> control.StateSpace:
    """Return the exact plant as a `control.StateSpace` with named signals.

    Inputs: floor acceleration, damper force. Outputs: suspension displacement and velocity, frame and driver
    acceleration.
    """
    import control

    s = state_space(plant)
    c = np.vstack([s.C2, s.A[1], s.C1[1]])
    d = np.array([[0.0, 0.0], [0.0, 0.0], [0.0, -plant.damper_ratio / plant.frame_mass], [0.0, 0.0]])
    inputs = ["floor_acceleration", "damper_force"]
    outputs = ["suspension_displacement", "suspension_velocity", "frame_acceleration", "driver_acceleration"]
    return control.ss(s.A, np.hstack([s.B1, s.B2]), c, d, inputs=inputs, outputs=outputs)


def natural_frequencies(plant: Plant) -> tuple[float, float]:
    """Return the two undamped natural frequencies in Hz, lower first."""
    kf, kc = plant.suspension_stiffness, plant.cushion_stiffness
    mass = np.diag([plant.frame_mass, plant.driver_mass])
    stiffness = np.array([[kf + kc, -kc], [-kc, kc]])
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)
    low, high = (math.sqrt(max(w2, 0.0)) / (2 * math.pi) for w2 in squares)
    return low, high
