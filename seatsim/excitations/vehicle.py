"""From the road to the cab floor: tyre, axle, suspended body and cab on its mounts.

    axle:  mu*zu'' = kt*(zr - zu) + ks*(zb - zu) + cs*(zb' - zu')
    body:  mb*zb'' = ks*(zu - zb) + cs*(zu' - zb') + kc*(z0 - zb) + cc*(z0' - zb')
    cab:   mc*z0'' = kc*(zb - z0) + cc*(zb' - z0')

`zr` is the road, `z0` the cab floor. Linear, one wheel, point contact: no pitch, no frame bending, no engine.
Valid for ride up to about 20 Hz; by then the floor has lost nearly all of the road's content.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.excitations.spectra import Spectrum
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param

LONGEST_RING_DOWN = 600.0


class Vehicle(NamedTuple):
    """One front wheel of a heavy truck with its share of body and cab.

    The values are chosen by us, typical of a heavy truck; they are not from a published source. Coupled, they
    give modes at 1.15 Hz (body, 29 % of critical damping), 1.96 Hz (cab, 49 %) and 8.8 Hz (wheel, 53 %).
    """

    axle_mass: Annotated[float, param("kg", "unsprung mass at one wheel", above=0)] = 350.0
    body_mass: Annotated[float, param("kg", "frame and load carried by one wheel, without the cab", above=0)] = 2600.0
    cab_mass: Annotated[float, param("kg", "share of the cab above one wheel", above=0)] = 450.0
    tyre_stiffness: Annotated[float, param("N/m", "vertical stiffness of the tyre", above=0)] = 1.0e6
    suspension_stiffness: Annotated[float, param("N/m", "stiffness of the axle suspension", above=0)] = 2.0e5
    suspension_damping: Annotated[float, param("N s/m", "damping of the axle suspension", low=100)] = 2.0e4
    mount_stiffness: Annotated[float, param("N/m", "stiffness of the cab mounts", above=0)] = 5.0e4
    mount_damping: Annotated[float, param("N s/m", "damping of the cab mounts", low=100)] = 4.0e3


TRUCK = Vehicle()


def floor_response(frequency: Array, vehicle: Vehicle = TRUCK) -> Spectrum:
    """Return the complex response `z0/zr` of the cab floor to the road, shape of `frequency`.

    Built from the cab down: a mass `m` on a spring with the transmissibility `T = (k + c s)/(m s^2 + k + c s)`
    adds `m T` to the mass below it; `z0/zr` is the product of the three T.

    Args:
        frequency: in Hz, any shape.
        vehicle: its parameters.
    """
    s = (2j * np.pi * frequency).astype(np.complex128)
    response = np.ones_like(s)
    carried = np.zeros_like(s)
    for mass, link in _stages(s, vehicle):
        total = mass + carried
        transmissibility = link / (total * s**2 + link)
        carried = total * transmissibility
        response = response * transmissibility
    return response


def state_space(vehicle: Vehicle = TRUCK) -> tuple[Array, Array, Array, Array]:
    """Return `A (6,6)`, `B (6,1)`, `C (3,6)` and `D (3,1)` from the road to the floor.

    States: displacements of axle, body and cab in m, then their velocities in m/s. Made for
    `control.ss(*state_space())`.
    """
    v = vehicle
    masses = np.array([v.axle_mass, v.body_mass, v.cab_mass])
    stiffness = _chain(v.suspension_stiffness, v.mount_stiffness)
    stiffness[0, 0] += v.tyre_stiffness
    damping = _chain(v.suspension_damping, v.mount_damping)
    accelerations = -np.hstack([stiffness, damping]) / masses[:, None]
    A = np.vstack([np.hstack([np.zeros((3, 3)), np.eye(3)]), accelerations])
    B = np.zeros((6, 1))
    B[3, 0] = v.tyre_stiffness / v.axle_mass
    C = np.vstack([np.eye(6)[2], np.eye(6)[5], A[5]])
    return A, B, C, np.zeros((3, 1))


def ring_down(vehicle: Vehicle) -> float:
    """Return the time in s in which every free vibration of the vehicle falls below a millionth.

    Raises:
        InputError: it takes longer than ten minutes, so some stiffness or damping must be wrong.
    """
    slowest = np.linalg.eigvals(state_space(vehicle)[0]).real.max()
    if slowest > -np.log(1e6) / LONGEST_RING_DOWN:
        raise InputError(
            f"vehicle {vehicle}: it still sways after {LONGEST_RING_DOWN:g} s; "
            "check that stiffnesses are in N/m and dampings in N s/m"
        )
    return float(-np.log(1e6) / slowest)


def _stages(s: Spectrum, v: Vehicle) -> tuple[tuple[float, NDArray[np.complex128]], ...]:
    return (
        (v.cab_mass, v.mount_stiffness + v.mount_damping * s),
        (v.body_mass, v.suspension_stiffness + v.suspension_damping * s),
        (v.axle_mass, v.tyre_stiffness + 0 * s),
    )


def _chain(lower: float, upper: float) -> Array:
    return np.array([[lower, -lower, 0.0], [-lower, lower + upper, -upper], [0.0, -upper, upper]])
