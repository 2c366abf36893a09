"""The time loop of many runs side by side: a block of lanes that share their models and differ in numbers.

What every step does to every lane (sub-steps of a smooth rig, sums of the metrics) has no branch between lanes, so that
the compiler takes several at once where the model needs no function of its own, such as `exp`. A lane that switches, in
which the friction is set-valued or the step has to be divided, is masked: its step is done again by
`seatsim.kernel.step.advance`, as in a single run. Laws and inverse are asked lane by lane.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.jit import jit
from seatsim.kernel.generic import update
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.lane_records import LANES, gather, scatter
from seatsim.kernel.lane_state import Demand, Lane, LaneInputs, LaneRows, LaneSetup, Sums
from seatsim.kernel.loop import decide, measure
from seatsim.kernel.loop_inputs import ControlledRig, Timing
from seatsim.kernel.rig import Disturbance
from seatsim.kernel.step import IntegratorState, StepInputs, advance, estimate_error, start, take_substep
from seatsim.kernel.work import owe
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

Array = NDArray[np.float64]


def run_lanes(
    setup: LaneSetup, state: Lane, memory: State, sums: Sums, timing: Timing, inputs: LaneInputs, rows: LaneRows
) -> None:
    """Simulate a block of lanes from rest.

    `setup`, `state`, `memory` and `sums` are templates of what `rows` holds; only their form counts, and the numbers
    that all lanes share. A lane that diverges stays at its last valid state.
    """
    samples, states, next_states = len(inputs.floor_acceleration), rows.states, np.empty_like(rows.states)
    floor, driver = inputs.floor_acceleration.reshape(-1), rows.driver.reshape(-1)
    acting = np.zeros(LANES)
    grid = np.empty(CELLS + 1)
    _start(setup, state, inputs, rows, timing.step)
    for k in range(samples):
        if k % timing.sample_every == 0:
            _ask_laws(setup, state, memory, timing.step, inputs, rows, states, k, grid)
        _hold_commands(setup, rows, acting, k)
        _add_sample(setup, state, sums, rows, states, floor[k * LANES :], driver[k * LANES :], k)
        if k == samples - 1:
            break
        _advance(setup, state, timing, rows.setups, states, next_states, floor[k * LANES :], acting)
        _advance_masked(setup, state, timing, rows, states, next_states, floor[k * LANES :], acting, k)
        states, next_states = next_states, states


@jit
def _start(setup: LaneSetup, state: Lane, inputs: LaneInputs, rows: LaneRows, step: float) -> None:
    """Replace the mechanical states of the lanes by the initial states of their integration."""
    for lane in range(LANES):
        own, rest = gather(setup, rows.setups, lane), gather(state, rows.states, lane)
        disturbance = Disturbance(inputs.floor_acceleration[0, lane], 0.0, 0.0)
        now = start(own.rig, rest.now.state, disturbance, 0.0, own.factors, step)
        scatter(Lane(now, 0.0, 0.0), rows.states, lane)


@jit
def _ask_laws(
    setup: LaneSetup,
    state: Lane,
    memory: State,
    step: float,
    inputs: LaneInputs,
    rows: LaneRows,
    states: Array,
    k: int,
    grid: Array,
) -> None:
    """Let every lane's law answer what is measured at sample `k`."""
    for lane in range(LANES):
        own, now = gather(setup, rows.setups, lane), gather(state, states, lane)
        held = gather(memory, rows.memories, lane)
        floor, speed = inputs.floor_acceleration[k, lane], inputs.floor_velocity[k, lane]
        y = measure(now.now, k * step, floor, speed, now.current, own.temperature, math.nan)
        command, wanted, served = decide(own, y, now.now, own.factors, (), held, grid)
        scatter(update(own.law, y, held), rows.memories, lane)
        scatter(Demand(command, wanted, served), rows.demands, lane)


@jit
def _hold_commands(setup: LaneSetup, rows: LaneRows, acting: Array, k: int) -> None:
    """Put the commands in A that act from sample `k` on into `acting`, shape (LANES,)."""
    depth = len(rows.commands)
    for lane in range(LANES):
        own = gather(setup, rows.setups, lane)
        rows.commands[k % depth, lane] = rows.demands[lane]
        late = int(own.late)
        command = rows.commands[(k - late) % depth, lane] if k >= late else 0.0
        acting[lane] = min(command, own.coil.max_current)


@jit
def _add_sample(
    setup: LaneSetup, state: Lane, sums: Sums, rows: LaneRows, states: Array, floor: Array, driver: Array, k: int
) -> None:
    """Add sample `k` to the sums of the lanes; `floor` and `driver` begin with their accelerations at it."""
    for lane in range(LANES):
        own, at = gather(setup, rows.setups, lane), gather(state, states, lane)
        demand = Demand(rows.demands[lane], rows.demands[LANES + lane], rows.demands[2 * LANES + lane])
        frame = at.now.rates[VELOCITY] + floor[lane]
        driver[lane] = frame + at.now.rates[CUSHION_VELOCITY]
        scatter(add_to_sums(own, at, demand, frame, gather(sums, rows.sums, lane), k == 0), rows.sums, lane)


@jit
def add_to_sums(own: ControlledRig, lane: Lane, demand: Demand, frame: float, sums: Sums, first: bool) -> Sums:
    """Return the sums with one more sample."""
    s, plant, current = lane.now.state, own.rig.plant, lane.current
    x, v = s[DISPLACEMENT], s[VELOCITY]
    below = 1.0 if x < plant.travel[0] else 0.0
    above = 1.0 if x > plant.travel[1] else 0.0
    asked = 1.0 if demand.wanted == demand.wanted else 0.0
    wanted = demand.wanted if demand.wanted == demand.wanted else 0.0
    missed = asked * (wanted - lane.now.forces.damper_force)
    stored = 0.5 * (
        plant.frame_mass * v * v
        + plant.driver_mass * (v + s[CUSHION_VELOCITY]) * (v + s[CUSHION_VELOCITY])
        + plant.suspension_stiffness * x * x
        + plant.cushion_stiffness * s[CUSHION_DISPLACEMENT] * s[CUSHION_DISPLACEMENT]
    )
    at_rest = stored if first else sums.stored
    used = (s[DAMPER_WORK], s[SUSPENSION_WORK], s[CUSHION_WORK], stored - at_rest)
    return Sums(
        sums.frame + frame * frame,
        max(sums.frame_peak, abs(frame)),
        sums.displacement + x * x,
        max(sums.displacement_peak, abs(x)),
        sums.hits + below * (1.0 - sums.below) + above * (1.0 - sums.above),
        below,
        above,
        sums.asked + asked,
        sums.wanted + wanted * wanted,
        sums.missed + missed * missed,
        sums.served + (demand.served if demand.served == demand.served else 0.0),
        sums.current + current * current,
        current if first else sums.first_current,
        current,
        at_rest,
        max(sums.imbalance, abs(s[FLOOR_WORK] - (used[0] + used[1] + used[2] + used[3]))),
        max(sums.energy, abs(s[FLOOR_WORK]), abs(used[0]), abs(used[1]), abs(used[2]), abs(used[3])),
        s[DAMPER_WORK],
    )


@jit
def _step_inputs(own: LaneSetup, step: float, floor: Array, acting: Array, lane: int, current: float) -> StepInputs:
    """Return what acts on a lane until the next sample; `floor` begins with the accelerations at this one."""
    here, command = floor[lane], acting[lane]
    rise = floor[LANES + lane] - here
    return StepInputs(step, here, rise, current, command, command, 0.0, False, own.kept, 0.0, 0.0, 0.0, 0.0)


@jit
def _advance(
    setup: LaneSetup,
    state: Lane,
    timing: Timing,
    setups: Array,
    states: Array,
    next_states: Array,
    floor: Array,
    acting: Array,
) -> None:
    """Take a step of every lane as if it were smooth, and mask those for which it is not."""
    step = timing.step
    for lane in range(LANES):
        own, at = gather(setup, setups, lane), gather(state, states, lane)
        inputs = _step_inputs(own, step, floor, acting, lane, at.current)
        now = IntegratorState(at.now.state, at.now.rates, at.now.forces, 0.0, step, at.now.debt)
        reached, rates, forces, k4, current = take_substep(own.rig, own.coil, inputs, own.factors, now, 0.0, step)
        error = estimate_error(reached, rates, k4, step, timing.tolerance)
        # Written so that a NaN masks the lane.
        smooth = 1.0 if error <= 1.0 else 0.0
        whole = 1.0 if at.now.substep == step else 0.0
        free = 1.0 if max(at.now.forces.friction_limit, forces.friction_limit) <= 0.0 else 0.0
        after = IntegratorState(reached, rates, forces, 0.0, step, owe(at.now.debt, 1.0))
        scatter(Lane(after, current, 1.0 - smooth * whole * free), next_states, lane)


@jit
def _advance_masked(
    setup: LaneSetup,
    state: Lane,
    timing: Timing,
    rows: LaneRows,
    states: Array,
    next_states: Array,
    floor: Array,
    acting: Array,
    k: int,
) -> None:
    """Take the step of every masked lane again, in as many parts as it needs."""
    last = len(next_states) - LANES
    for lane in range(LANES):
        if next_states[last + lane] != 0.0:
            own, at = gather(setup, rows.setups, lane), gather(state, states, lane)
            now, current, good = at.now, at.current, False
            if rows.reached[lane] > k:
                inputs = _step_inputs(own, timing.step, floor, acting, lane, at.current)
                now, current, good = advance(own.rig, own.coil, inputs, own.factors, at.now, timing.tolerance)
                if not good:
                    rows.reached[lane] = k
            scatter(Lane(now, current, 0.0), next_states, lane)
