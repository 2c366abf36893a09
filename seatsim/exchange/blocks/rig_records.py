"""What the whole rig as a block holds: its parameters, inputs, state and outputs."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.exchange.blocks.held import Held
from seatsim.kernel.assumed_model import InverseModel
from seatsim.kernel.rig import Disturbance, Rig
from seatsim.kernel.step import IntegratorState
from seatsim.rig.coil import Coil
from seatsim.rig.control import CompiledLaw
from seatsim.rig.sensors import Sensing
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.schema.fields import param


class RigParameters(NamedTuple):
    """The constant parts of a run, as in `seatsim.kernel.loop_inputs.LoopSetup`."""

    rig: Rig
    coil: Coil
    temperature_factors: TemperatureFactors
    thermal: Thermal
    law: CompiledLaw
    inverse_model: InverseModel
    sensors: Sensing
    max_command: Annotated[float, param("A", "greatest command of the controller", low=0)]
    self_heating: bool
    tolerance: float
    step: float
    sample_every: int


class RigInputs(NamedTuple):
    """What drives the rig from one communication point on."""

    floor_acceleration: Annotated[
        float, param("m/s^2", "acceleration of the floor at the begin of a communication step, upward positive")
    ] = 0.0
    floor_velocity: Annotated[
        float, param("m/s", "velocity of the floor, upward positive; the integral of its acceleration if not given")
    ] = 0.0
    floor_jerk: Annotated[
        float, param("m/s^3", "rate of the floor's acceleration over the step; that over the last step if not given")
    ] = 0.0
    frame_force: Annotated[float, param("N", "force on the frame, upward positive")] = 0.0
    driver_force: Annotated[float, param("N", "force on the driver, upward positive")] = 0.0
    temperature: Annotated[float, param("degC", "temperature of the damper, where it does not warm up by itself")] = (
        20.0
    )
    replayed_command: Annotated[float, param("A", "command for a law that replays one")] = 0.0
    displacement_noise: Annotated[float, param("m", "noise of a displacement reading, with sensors only")] = 0.0
    frame_noise: Annotated[float, param("m/s^2", "noise of the frame's accelerometer, with sensors only")] = 0.0
    driver_noise: Annotated[float, param("m/s^2", "noise of the driver's accelerometer, with sensors only")] = 0.0
    floor_noise: Annotated[float, param("m/s^2", "noise of the floor's accelerometer, with sensors only")] = 0.0


class GivenFloor(NamedTuple):
    """What is known of the floor at a communication point.

    `acceleration` in m/s^2 was given at the step of the number `sample`, `rate` in m/s^3 is how it goes on; `velocity`
    in m/s is that of the present step. `has_rate` and `has_velocity` say whether these two inputs are stated.
    """

    acceleration: float = 0.0
    sample: int = 0
    rate: float = 0.0
    velocity: float = 0.0
    has_rate: bool = False
    has_velocity: bool = False


class RigState(NamedTuple):
    """State of the rig and of what controls it; `commands` are those given until now in A, the latest one first.

    `followed` is the state of the inverse's damper where the inverse tracks one, `expected` the disturbance that the
    last step ended with, `sample` the number of steps taken, `floor` what is known of the floor's motion.
    """

    now: IntegratorState
    current: float
    temperature: float
    command: float
    sensed: State
    followed: State
    law_state: State
    commands: State
    expected: Disturbance
    sample: int
    floor: GivenFloor
    held: Held


class RigOutputs(NamedTuple):
    """Motion, force, current and temperature, as the channels of a run."""

    frame_acceleration: Annotated[float, param("m/s^2", "acceleration of the frame, upward positive")]
    driver_acceleration: Annotated[float, param("m/s^2", "acceleration of the driver, upward positive")]
    suspension_displacement: Annotated[float, param("m", "displacement of the suspension, positive in extension")]
    suspension_velocity: Annotated[float, param("m/s", "velocity of the suspension, positive in extension")]
    cushion_displacement: Annotated[float, param("m", "displacement of the cushion, positive in extension")]
    cushion_velocity: Annotated[float, param("m/s", "velocity of the cushion, positive in extension")]
    damper_force: Annotated[float, param("N", "force of the damper, positive when it opposes extension")]
    coil_current: Annotated[float, param("A", "current in the coil")]
    current_command: Annotated[float, param("A", "command of the controller over the step that has ended")]
    damper_temperature: Annotated[float, param("degC", "temperature of the damper")]
