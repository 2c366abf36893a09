"""One run from rest to its end, with its whole state in local variables: what one thread of a CUDA device does.

It takes the steps of `seatsim.kernel.loop.run_loop` with the same functions, from the same source, and keeps the sums
of `seatsim.kernel.lanes` in place of the channels.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.jit import jit
from seatsim.kernel.assumed_model import follow_state, model_scaling
from seatsim.kernel.generic import advance_filters, read, scaling_at, update
from seatsim.kernel.lane_state import Demand, Lane, Sums
from seatsim.kernel.lanes import add_to_sums
from seatsim.kernel.loop import decide, delay_of, measure, warm_up
from seatsim.kernel.loop_inputs import LoopSetup
from seatsim.kernel.rig import Disturbance
from seatsim.kernel.step import StepInputs, advance, start
from seatsim.rig.state import CUSHION_VELOCITY, DAMPER_WORK, DISPLACEMENT, VELOCITY, State

Array = NDArray[np.float64]

NO_SUMS = Sums()


class LaneStart(NamedTuple):
    """A lane before its run: its constant parts, the states at rest, and the damper's temperature in degC.

    `rig`, `followed`, `law` and `sensed` are the states of the rig, of the inverse's damper, of the law and of its
    sensors.
    """

    setup: LoopSetup
    rig: State
    followed: State
    law: State
    sensed: State
    temperature: float


class LaneSignals(NamedTuple):
    """What drives a lane, and what it writes.

    `floor` is the acceleration in m/s^2 and `speed` the velocity in m/s of the floor, shape (N,); `noise`, shape
    (M, READINGS), that of the readings at the law's samples. `driver`, shape (N,), gets the driver's acceleration in
    m/s^2; `commands`, shape (D,), holds the last D commands, D above the delay in steps by two.
    """

    floor: Array
    speed: Array
    noise: Array
    commands: Array
    driver: Array


class LaneLimits(NamedTuple):
    """Ends of the data behind a damper: its speed in m/s, its current in A, its temperatures in degC."""

    speed: float
    current: float
    coldest: float
    hottest: float


class Strokes(NamedTuple):
    """Suspension displacement at the last reversal (NaN: none yet), sum of the strokes, twice that of their middles.

    The middles count by their distance from mid-stroke; all in m.
    """

    turn: float = math.nan
    lengths: float = 0.0
    middles: float = 0.0


NO_STROKES = Strokes()


class LaneEnd(NamedTuple):
    """A lane after its run: its sums, its strokes, the samples beyond each of the limits.

    `temperature` is that of the damper in degC, `reached` the number of samples that the lane reached.
    """

    sums: Sums
    strokes: Strokes
    fast: float
    strong: float
    foreign: float
    temperature: float
    reached: float


@jit
def run_lane(lane: LaneStart, limits: LaneLimits, signals: LaneSignals, grid: Array) -> LaneEnd:
    """Simulate one lane and return its end; a lane that diverges ends at its last valid sample.

    `grid` as for `seatsim.kernel.inverse.invert`.
    """
    setup, rig, coil, timing = lane.setup, lane.setup.rig, lane.setup.coil, lane.setup.timing
    step, samples, ratio, model = timing.step, len(signals.floor), rig.plant.damper_ratio, setup.inverse_model
    late, split, kept = delay_of(coil, step)
    temperature, followed, law_state, sensed = lane.temperature, lane.followed, lane.law, lane.sensed
    factors = scaling_at(setup.factors, temperature)
    now = start(rig, lane.rig, Disturbance(signals.floor[0], 0.0, 0.0), 0.0, factors, step)
    current, demand = 0.0, Demand(0.0, math.nan, math.nan)
    sums, strokes, fast, strong, foreign = NO_SUMS, NO_STROKES, 0.0, 0.0, 0.0
    for k in range(samples):
        floor = signals.floor[k]
        sensed = advance_filters(setup.sensors, floor, now.state[DISPLACEMENT], now.rates, sensed)
        if k % timing.sample_every == 0:
            true = measure(now, k * step, floor, signals.speed[k], current, temperature, math.nan)
            y, sensed = read(setup.sensors, true, signals.noise, k // timing.sample_every, sensed)
            command, wanted, served = decide(setup, y, now, factors, followed, law_state, grid)
            law_state = update(setup.law, y, law_state)
            demand = Demand(command, wanted, served)
        signals.commands[k % len(signals.commands)] = demand.command
        frame = now.rates[VELOCITY] + floor
        signals.driver[k] = frame + now.rates[CUSHION_VELOCITY]
        sums = add_to_sums(setup, Lane(now, current, 0.0), demand, frame, sums, k == 0)
        fast += 1.0 if abs(ratio * now.state[VELOCITY]) > limits.speed else 0.0
        strong += 1.0 if current > limits.current else 0.0
        foreign += 0.0 if limits.coldest <= temperature <= limits.hottest else 1.0
        if k == samples - 1:
            break
        before, after = _command_at(signals.commands, k - late - 1), _command_at(signals.commands, k - late)
        most, rise = coil.max_current, signals.floor[k + 1] - floor
        acting = StepInputs(
            step, floor, rise, current, min(before, most), min(after, most), split, False, kept, 0.0, 0.0, 0.0, 0.0
        )
        last, held = now, current
        now, current, good = advance(rig, coil, acting, factors, last, timing.tolerance)
        if not good:
            return LaneEnd(sums, strokes, fast, strong, foreign, temperature, float(k))
        strokes = _add_turn(strokes, now.state[DISPLACEMENT], last.state[VELOCITY], now.state[VELOCITY])
        followed = follow_state(
            model.damper,
            followed,
            ratio * last.state[DISPLACEMENT],
            ratio * last.state[VELOCITY],
            ratio * now.state[DISPLACEMENT],
            ratio * now.state[VELOCITY],
            0.5 * (held + current),
            model_scaling(model, factors, temperature),
            step,
        )
        if timing.self_heating:
            work = now.state[DAMPER_WORK] - last.state[DAMPER_WORK]
            temperature += warm_up(setup.thermal, coil, temperature, work, held, current, step)
            factors = scaling_at(setup.factors, temperature)
    return LaneEnd(sums, strokes, fast, strong, foreign, temperature, float(samples))


@jit
def _add_turn(strokes: Strokes, x: float, before: float, v: float) -> Strokes:
    """Return the strokes after a sample at the displacement x and the velocity v, which was `before`."""
    turn = strokes.turn
    if math.copysign(1.0, before) == math.copysign(1.0, v):
        return strokes
    if math.isnan(turn):
        return Strokes(x, strokes.lengths, strokes.middles)
    return Strokes(x, strokes.lengths + abs(x - turn), strokes.middles + abs(x + turn))


@jit
def _command_at(commands: Array, k: int) -> float:
    """Return the command of sample `k`, zero before the first one."""
    return commands[k % len(commands)] if k >= 0 else 0.0
