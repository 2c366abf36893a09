"""Inputs of a simulation from a run of a recording."""

from __future__ import annotations

import math
from collections.abc import Mapping

from seatsim.excitations.recording import interpolate_floor
from seatsim.recordings.recording import Recording
from seatsim.schema.arrays import Array
from seatsim.simulation.inputs import BenchInputs, RigInputs, SeatInputs

SAME_STEP = 1e-9
"""Part of a step by which a row interval may exceed a whole number of steps, as an allowance for rounding."""


def recorded_inputs(recording: Recording, table: Mapping[str, Array], largest_step: float) -> RigInputs:
    """Return the inputs of a rig in a run, from the `table` of the run.

    On a seat the inputs are sampled at the largest step, at most `largest_step` in s, that divides the interval between
    rows. Floor acceleration, coil current and temperature are linear between rows; a command is constant until the next
    row. A bench has one step per row.
    """
    interval = 1.0 / recording.header.sample_rate
    if recording.header.rig == "damper_bench":
        return _bench_inputs(recording, table, interval)
    steps = max(1, math.ceil(interval / largest_step - SAME_STEP))
    return SeatInputs(interpolate_floor(table, steps, interval / steps), interval)


def _bench_inputs(recording: Recording, table: Mapping[str, Array], interval: float) -> BenchInputs:
    return BenchInputs(
        interval,
        table["displacement"],
        recording.channels["displacement"].noise_rms,
        table.get("velocity"),
        table.get("current_command"),
        table.get("command_voltage"),
        recording.voltage_gain,
        table.get("coil_current"),
        table.get("damper_temperature"),
    )
