"""What goes into a run of the compiled loop, its constant parts and inputs, and the columns of the history it gives."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.compilation.jit import jit
from seatsim.kernel.generic import InverseModel
from seatsim.kernel.rig import Disturbance, Rig
from seatsim.kernel.step import IntegratorState, StepInputs
from seatsim.rig.coil import Coil
from seatsim.rig.control import CompiledLaw
from seatsim.rig.sensors import READINGS, Direct, Sensing
from seatsim.rig.state import (
    CUSHION_DISPLACEMENT,
    CUSHION_VELOCITY,
    CUSHION_WORK,
    DAMPER_WORK,
    DISPLACEMENT,
    FLOOR_WORK,
    SUSPENSION_WORK,
    VELOCITY,
    State,
)
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.schema.arrays import Array
from seatsim.schema.fields import read_packaged

UNITS = read_packaged(Path(__file__).with_name("channels.yaml"), dict[str, str])
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


class LoopInputs(NamedTuple):
    """What drives a run, sampled every `step`, shape (N,) each; an array of length 0 is an input that is absent.

    `replayed` is a recorded command for laws that replay it, `prescribed` a coil current that bypasses the coil,
    `temperature` the damper's temperature in degC, `frame_force` and `driver_force` forces in N; the coil starts at
    `start_current`, the suspension at `start_displacement` and `start_velocity`, the cushion at rest, the sensors at
    `sensed`. `noise`, shape (M, READINGS), is that of the readings at the law's samples. Where no `temperature` is
    given, the damper is at `start_temperature`.
    """

    floor_acceleration: Array
    floor_velocity: Array
    temperature: Array
    replayed: Array
    prescribed: Array
    frame_force: Array
    driver_force: Array
    start_current: float = 0.0
    start_displacement: float = 0.0
    start_velocity: float = 0.0
    sensed: State = ()
    noise: Array = np.zeros((0, READINGS))
    start_temperature: float = 20.0


class Timing(NamedTuple):
    """Step of the loop in s, steps per sample of the law, error tolerance, and whether temperature is a state."""

    step: float
    sample_every: int
    tolerance: float
    self_heating: bool


class LoopSetup(NamedTuple):
    """The constant parts of a run; `max_command` in A is the most that the controller asks for.

    The law sees the output of `sensors`: the true states, or instruments' readings of them. Where it wants a force,
    `inverse_model` is the damper that the inverse uses.
    """

    rig: Rig
    coil: Coil
    factors: TemperatureFactors
    thermal: Thermal
    law: CompiledLaw
    inverse_model: InverseModel
    timing: Timing
    max_command: float
    sensors: Sensing = Direct()


@jit
def disturbance_of(inputs: LoopInputs, k: int) -> Disturbance:
    """Return what excites the seat at sample `k`; a force that is absent is 0."""
    frame = inputs.frame_force[k] if len(inputs.frame_force) > 0 else 0.0
    driver = inputs.driver_force[k] if len(inputs.driver_force) > 0 else 0.0
    return Disturbance(inputs.floor_acceleration[k], frame, driver)


@jit
def step_inputs(
    setup: LoopSetup,
    inputs: LoopInputs,
    rows: Array,
    k: int,
    current: float,
    late: int,
    split: float,
    kept: tuple[float, float],
) -> StepInputs:
    """Return the inputs of the rig from sample `k` to the next.

    `rows`, shape (N, len(CHANNELS)), hold the commands until sample k, which act `late` steps and `split` seconds
    later, no more than the coil's driver can give; before the first of them acts, the coil's `start_current` stands.
    `kept` as in `StepInputs`.
    """
    start, most, prescribed = inputs.start_current, setup.coil.max_current, len(inputs.prescribed) > 0
    before = min(rows[k - late - 1, CURRENT_COMMAND] if k > late else start, most)
    after = min(rows[k - late, CURRENT_COMMAND] if k >= late else start, most)
    if prescribed:
        after = inputs.prescribed[k + 1]
    now, then = disturbance_of(inputs, k), disturbance_of(inputs, k + 1)
    rise = Disturbance(then.floor - now.floor, then.frame_force - now.frame_force, then.driver_force - now.driver_force)
    return StepInputs(setup.timing.step, now, rise, current, before, after, split, prescribed, kept)
