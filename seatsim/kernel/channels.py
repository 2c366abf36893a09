"""Columns of a history: their names for readers, and what the compiled loop writes into a row of them."""

from __future__ import annotations

from typing import NamedTuple

from seatsim.compilation.jit import jit
from seatsim.kernel.step import IntegratorState
from seatsim.rig.state import (
    CUSHION_DISPLACEMENT,
    CUSHION_VELOCITY,
    CUSHION_WORK,
    DAMPER_WORK,
    DISPLACEMENT,
    FLOOR_WORK,
    SUSPENSION_WORK,
    VELOCITY,
)
from seatsim.schema.arrays import Array

UNITS = {
    "floor_acceleration": "m/s^2",
    "frame_acceleration": "m/s^2",
    "driver_acceleration": "m/s^2",
    "suspension_displacement": "m",
    "suspension_velocity": "m/s",
    "cushion_displacement": "m",
    "cushion_velocity": "m/s",
    "damper_force": "N",
    "wanted_force": "N",
    "force_served": "-",
    "coil_current": "A",
    "current_command": "A",
    "damper_temperature": "degC",
    "energy_floor": "J",
    "energy_damper": "J",
    "energy_suspension": "J",
    "energy_cushion": "J",
}
"""Unit of every column of a history, in the order of the columns."""
CHANNELS = tuple(UNITS)
CURRENT_COMMAND = CHANNELS.index("current_command")
"""Column from which the loop reads the commands that act later."""


class Sample(NamedTuple):
    """What is known at a sample beside the state of the rig: in m/s^2, N (NaN: no force is wanted), A and degC."""

    floor: float
    wanted: float
    served: float
    current: float
    command: float
    temperature: float


@jit
def write_row(row: Array, now: IntegratorState, sample: Sample) -> None:
    """Write a sample into its row, shape (len(CHANNELS),), in the order of `CHANNELS`."""
    s, frame = now.state, now.rates[VELOCITY] + sample.floor
    values = (
        sample.floor,
        frame,
        frame + now.rates[CUSHION_VELOCITY],
        s[DISPLACEMENT],
        s[VELOCITY],
        s[CUSHION_DISPLACEMENT],
        s[CUSHION_VELOCITY],
        now.forces.damper_force,
        sample.wanted,
        sample.served,
        sample.current,
        sample.command,
        sample.temperature,
        s[FLOOR_WORK],
        s[DAMPER_WORK],
        s[SUSPENSION_WORK],
        s[CUSHION_WORK],
    )
    for column in range(len(values)):
        row[column] = values[column]
