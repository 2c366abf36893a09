"""What the loop over lanes carries: constant parts, state, demand and sums of a lane, and the rows of a block."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.kernel.assumed_model import TrueModel
from seatsim.kernel.rig import Rig
from seatsim.kernel.step import IntegratorState
from seatsim.rig.coil import Coil
from seatsim.rig.control import CompiledLaw
from seatsim.rig.temperature import TemperatureScaling

Array = NDArray[np.float64]


class LaneSetup(NamedTuple):
    """The constant parts of one lane: the fields of `seatsim.kernel.loop_inputs.LoopSetup` that lanes may have.

    `factors` are those of the lane's `temperature` in degC, `kept` as in `StepInputs`; commands act `late` steps later.
    """

    rig: Rig
    coil: Coil
    law: CompiledLaw
    inverse_model: TrueModel
    max_command: float
    factors: TemperatureScaling
    kept: tuple[float, float]
    late: float
    temperature: float


class Lane(NamedTuple):
    """State of one lane: that of its integration, the coil's current in A, and 1 where its next step is not smooth."""

    now: IntegratorState
    current: float
    masked: float


class Demand(NamedTuple):
    """What a law asked for last: command in A, wanted force in N (NaN: none), and whether it is reached."""

    command: float
    wanted: float
    served: float


class Sums(NamedTuple):
    """Sums and extremes over the samples of a lane, SI units, as `seatsim.metrics` defines them.

    `below` and `above` are 1 while the suspension is beyond its travel; `stored` is the energy at the first sample, the
    sums of the current are those of its square.
    """

    frame: float = 0.0
    frame_peak: float = 0.0
    displacement: float = 0.0
    displacement_peak: float = 0.0
    hits: float = 0.0
    below: float = 0.0
    above: float = 0.0
    asked: float = 0.0
    wanted: float = 0.0
    missed: float = 0.0
    served: float = 0.0
    current: float = 0.0
    first_current: float = 0.0
    last_current: float = 0.0
    stored: float = 0.0
    imbalance: float = 0.0
    energy: float = 0.0
    damper_energy: float = 0.0


class LaneInputs(NamedTuple):
    """What drives a block: acceleration in m/s^2 and velocity in m/s of the floor, shape (N, LANES) each."""

    floor_acceleration: Array
    floor_velocity: Array


class LaneRows(NamedTuple):
    """Rows of a block (see `lane_records`): setups, states, laws' memories, demands and sums of its lanes.

    `commands`, shape (D, LANES), holds the last D commands, D above the greatest delay in steps; `driver`, shape
    (N, LANES), gets the driver's acceleration in m/s^2; `reached`, shape (LANES,), the samples that a lane reached.
    """

    setups: Array
    states: Array
    memories: Array
    demands: Array
    sums: Array
    commands: Array
    driver: Array
    reached: Array
