"""What drives a rig, as values, whether they were measured, designed or disturbed on purpose."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from seatsim.excitations.base import Floor
from seatsim.schema.arrays import Array

NONE = np.zeros(0)


class Forces(NamedTuple):
    """Forces on `frame` and `driver` in N, sampled every step, shape (N,) each; of length 0 where there is none."""

    frame: Array = NONE
    driver: Array = NONE


class SeatInputs(NamedTuple):
    """What drives a seat.

    floor: motion of the floor with the command or current of the coil and the damper's temperature, sampled every step
        of the simulation. interval: seconds between the rows at which the sensors are read, a whole number of steps.
        forces: on frame and driver, in addition to those of the effects.
    """

    floor: Floor
    interval: float
    forces: Forces = Forces()


class BenchInputs(NamedTuple):
    """What drives a damper on a bench, shape (N,) each, as the sensors read it every `interval` seconds.

    displacement: in m, read with an RMS noise of `displacement_noise` in m. velocity: in m/s, taken from the
        displacement where it is None. current_command: in A, or command_voltage: in V, which commands `voltage_gain`
        A/V; held from its row until the next. coil_current: in A; drives the damper where nothing commands the coil,
        and is the coil's current at row 0 otherwise. damper_temperature: in degC, the scenario's where it is None.
    """

    interval: float
    displacement: Array
    displacement_noise: float = 0.0
    velocity: Array | None = None
    current_command: Array | None = None
    command_voltage: Array | None = None
    voltage_gain: float | None = None
    coil_current: Array | None = None
    damper_temperature: Array | None = None


RigInputs = SeatInputs | BenchInputs
