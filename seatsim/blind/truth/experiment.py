"""One rig under test and its protocol: what a run is, with or without faults, and what its channels show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from seatsim.blind.truth.faults.scenario import Changes, Context, FrameForce
from seatsim.blind.truth.frame_forces import frame_force
from seatsim.blind.truth.noise import NoiseColour
from seatsim.blind.truth.physics.parameters import parameter_record
from seatsim.blind.truth.physics.rig import (
    EXCITATION_RATE,
    INTEGRATION_STEP,
    SAMPLE_RATE,
    Inputs,
    RigMotion,
    simulate,
)
from seatsim.blind.truth.sensors import Readings, read_sensors
from seatsim.schema.arrays import Array

COMPARED = ("frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force", "coil_current")
"""Outputs that a gap compares, where they are recorded."""
TOLERANCE = 0.02
"""Relative error of nominal parameters that the owner states, unless an experiment has its own."""
CHANNELS = (
    "floor_acceleration", "frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force",
    "current_command", "coil_current", "damper_temperature",
)  # fmt: skip


@dataclass(frozen=True)
class RunPlan:
    """Excitation and control of a run; `temperature` of the damper at its start, degC."""

    name: str
    floor: Array  # m/s^2, at EXCITATION_RATE
    law: Array  # see `physics.control_laws`
    schedule: Array  # A, one per row
    temperature: float
    repeat_of: str | None = None

    @property
    def rows(self) -> int:
        """Rows of the table."""
        return self.schedule.size


@dataclass(frozen=True)
class Experiment:
    """A rig and its protocol before any effect; the last run is the unseen one.

    `nominal` are the parameters that the owner assumes, known to within the relative `tolerance` that he states, `true`
    those that the rig has; `noise` is the rms by channel, white but where the channel has a colour; `sample_rate` is
    that of the rows, Hz.
    """

    nominal: Mapping[str, float]
    true: Mapping[str, float]
    channels: tuple[str, ...]
    noise: Mapping[str, float]
    runs: tuple[RunPlan, ...]
    background: tuple[FrameForce, ...] = ()
    sample_rate: float = SAMPLE_RATE
    tolerance: float = TOLERANCE
    colours: Mapping[str, NoiseColour] = field(default_factory=dict)

    @property
    def compared(self) -> tuple[str, ...]:
        """Recorded outputs that a gap compares."""
        return tuple(name for name in COMPARED if name in self.channels)

    @property
    def is_bingham(self) -> bool:
        """Whether the damper is the Bingham model; otherwise it is Bouc-Wen."""
        return self.nominal["is_bingham"] == 1.0


def simulate_run(
    experiment: Experiment, changes: Changes, run: int, command: Array | None = None, floor: Array | None = None,
    step: float = INTEGRATION_STEP,
) -> RigMotion:  # fmt: skip
    """Simulate the true rig through a run.

    With `command` (A, one per row) the loop is open; a `floor` (m/s^2) in place of the run's is given at the rows.
    """
    plan = experiment.runs[run]
    record = parameter_record(_run_parameters(experiment, changes, run))
    law, schedule = (plan.law, plan.schedule) if command is None else (np.zeros(6), command)
    base, rate = (plan.floor, EXCITATION_RATE) if floor is None else (floor, experiment.sample_rate)
    force = frame_force((*experiment.background, *changes.frame_forces), run, plan.rows / experiment.sample_rate)
    return simulate(record, Inputs(base, rate, force, law, schedule, experiment.sample_rate), step)


def _run_parameters(experiment: Experiment, changes: Changes, run: int) -> dict[str, float]:
    """Return the parameters of a run: the true ones, its temperature, and the changes."""
    temperature = experiment.runs[run].temperature
    values = dict(experiment.true) | {"t_start": temperature, "t_ambient": temperature}
    for name, value in changes.parameters.items():
        number = value[min(run, len(value) - 1)] if isinstance(value, tuple) else value
        if name == "rate_factor":
            values["rate"] *= number
        else:
            values[name] = number
    return values


def read_channels(experiment: Experiment, changes: Changes, run: int, motion: RigMotion) -> Readings:
    """Return what the channels show of a motion, without noise, in the contract's order."""
    readings = read_sensors(motion, experiment.runs[run].floor, changes.sensor_faults, run)
    return {name: readings[name] for name in CHANNELS}


def context_of(experiment: Experiment, readings: Sequence[Readings]) -> Context:
    """Return what fault scenarios may know, from the readings of the rig without them."""
    pooled = {name: np.concatenate([run[name] for run in readings]) for name in CHANNELS}
    driver = pooled["driver_acceleration"]
    mass, stiffness = experiment.nominal["m"], experiment.nominal["kc"]
    return Context(
        spread={name: float(np.std(values)) for name, values in pooled.items()},
        x_peak=float(np.max(np.abs(pooled["suspension_displacement"]))),
        y_peak=mass * float(np.max(driver)) / stiffness,
        tension_peak=mass * float(np.max(-driver)),
        channels=experiment.channels,
        is_bingham=experiment.is_bingham,
    )
