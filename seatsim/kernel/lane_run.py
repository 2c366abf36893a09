"""One lane from rest to its end, with its whole state in local variables: what one thread of a CUDA device does.

The models, the integrator and the sums are those of `seatsim.kernel.lanes`, from the same source.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.jit import jit
from seatsim.kernel.generic import update
from seatsim.kernel.lane_state import Demand, Lane, LaneSetup, Sums
from seatsim.kernel.lanes import add_to_sums
from seatsim.kernel.loop import decide, measure
from seatsim.kernel.loop_inputs import Timing
from seatsim.kernel.rig import Disturbance
from seatsim.kernel.step import StepInputs, advance, start
from seatsim.rig.state import CUSHION_VELOCITY, VELOCITY, State

Array = NDArray[np.float64]


REST = Sums()
"""The sums before the first sample."""


class LaneStart(NamedTuple):
    """A lane before its run: its constant parts, the rig's state and the law's memory at rest."""

    setup: LaneSetup
    state: State
    memory: State


class LaneLimits(NamedTuple):
    """Ends of the data behind a damper: its speed in m/s, its current in A."""

    speed: float
    current: float


class LaneEnd(NamedTuple):
    """A lane after its run: its sums, the samples beyond each of the limits, and the samples that it reached."""

    sums: Sums
    fast: float
    strong: float
    reached: float


@jit
def run_lane(
    lane: LaneStart,
    timing: Timing,
    limits: LaneLimits,
    floor: Array,
    speed: Array,
    commands: Array,
    driver: Array,
    grid: Array,
) -> LaneEnd:
    """Simulate one lane and return its end; a lane that diverges ends at its last valid sample.

    `floor` is the acceleration in m/s^2 and `speed` the velocity in m/s of the floor, shape (N,). `driver`, shape (N,), gets the driver's acceleration in m/s^2; `commands`, shape (D,), holds the
    last D commands, D above the delay in steps; `grid` as for `seatsim.kernel.inverse.invert`.
    """
    setup, memory, samples, late = lane.setup, lane.memory, len(floor), int(lane.setup.late)
    rig, coil, step = setup.rig, setup.coil, timing.step
    now = start(rig, lane.state, Disturbance(floor[0], 0.0, 0.0), 0.0, setup.factors, step)
    current, demand, sums, fast, strong = 0.0, Demand(0.0, math.nan, math.nan), REST, 0.0, 0.0
    for k in range(samples):
        here = floor[k]
        if k % timing.sample_every == 0:
            y = measure(now, k * step, here, speed[k], current, setup.temperature, math.nan)
            command, wanted, served = decide(setup, y, now, setup.factors, (), memory, grid)
            memory = update(setup.law, y, memory)
            demand = Demand(command, wanted, served)
        commands[k % len(commands)] = demand.command
        acting = min(commands[(k - late) % len(commands)] if k >= late else 0.0, coil.max_current)
        frame = now.rates[VELOCITY] + here
        driver[k] = frame + now.rates[CUSHION_VELOCITY]
        sums = add_to_sums(setup, Lane(now, current, 0.0), demand, frame, sums, k == 0)
        fast += 1.0 if abs(rig.plant.damper_ratio * now.state[VELOCITY]) > limits.speed else 0.0
        strong += 1.0 if current > limits.current else 0.0
        if k == samples - 1:
            break
        rise = floor[k + 1] - here
        inputs = StepInputs(step, here, rise, current, acting, acting, 0.0, False, setup.kept, 0.0, 0.0, 0.0, 0.0)
        now, current, good = advance(rig, coil, inputs, setup.factors, now, timing.tolerance)
        if not good:
            return LaneEnd(sums, fast, strong, float(k))
    return LaneEnd(sums, fast, strong, float(samples))
