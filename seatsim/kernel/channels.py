"""Columns of a history: their names for readers, their numbers for the compiled loop."""

from __future__ import annotations

CHANNELS = (
    "floor_acceleration",
    "frame_acceleration",
    "driver_acceleration",
    "suspension_displacement",
    "suspension_velocity",
    "cushion_displacement",
    "cushion_velocity",
    "damper_force",
    "wanted_force",
    "force_served",
    "coil_current",
    "current_command",
    "damper_temperature",
    "energy_floor",
    "energy_damper",
    "energy_suspension",
    "energy_cushion",
)
"""Columns of a history, in order; SI units, degrees Celsius."""

(
    FLOOR_ACCELERATION,
    FRAME_ACCELERATION,
    DRIVER_ACCELERATION,
    SUSPENSION_DISPLACEMENT,
    SUSPENSION_VELOCITY,
    CUSHION_DISPLACEMENT,
    CUSHION_VELOCITY,
    DAMPER_FORCE,
    WANTED_FORCE,
    FORCE_SERVED,
    COIL_CURRENT,
    CURRENT_COMMAND,
    DAMPER_TEMPERATURE,
    ENERGY_FLOOR,
    ENERGY_DAMPER,
    ENERGY_SUSPENSION,
    ENERGY_CUSHION,
) = range(len(CHANNELS))
# Plain numbers: numba treats a module's number as a constant, while a member of an enumeration is looked up.
