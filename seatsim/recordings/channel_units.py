"""The channels that a recording of each rig may have, with their SI units."""

SEAT_CHANNELS = {
    "floor_acceleration": "m/s^2",
    "frame_acceleration": "m/s^2",
    "driver_acceleration": "m/s^2",
    "suspension_displacement": "m",
    "damper_force": "N",
    "current_command": "A",
    "coil_current": "A",
    "damper_temperature": "degC",
}
BENCH_CHANNELS = {
    "displacement": "m",
    "velocity": "m/s",
    "damper_force": "N",
    "current_command": "A",
    "command_voltage": "V",
    "coil_current": "A",
    "damper_temperature": "degC",
}
CHANNELS = {"seat": SEAT_CHANNELS, "damper_bench": BENCH_CHANNELS}
"""Channels by rig, each with its unit."""
ACCELEROMETERS = ("floor_acceleration", "frame_acceleration", "driver_acceleration")
MOTION = (*ACCELEROMETERS, "suspension_displacement", "displacement", "velocity", "damper_force")
"""Channels of motion and force, which swing about zero and are never at rest for long."""
COMMANDS = ("current_command", "command_voltage")
"""Channels that are logged and not measured, so that they have no noise."""
