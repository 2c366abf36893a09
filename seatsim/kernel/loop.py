"""The time loop: one run of a seat from rest, compiled for its combination of damper, law and inverse."""

from __future__ import annotations

import math

from seatsim.compilation.jit import jit
from seatsim.kernel.generic import (
    InverseModel,
    Motion,
    advance_filters,
    evaluate_law,
    follow_state,
    model_scaling,
    model_state,
    read,
    scaling_at,
    update,
    wants_force,
)
from seatsim.kernel.inverse import Demand, invert
from seatsim.kernel.loop_data import LoopInputs, LoopSetup, Sample, disturbance_of, step_inputs, write_row
from seatsim.kernel.rig import damper_state
from seatsim.kernel.step import IntegratorState, advance, relaxed, start
from seatsim.rig.coil import Coil
from seatsim.rig.control import CompiledLaw, Measurement
from seatsim.rig.state import CUSHION_VELOCITY, DAMPER_WORK, DISPLACEMENT, VELOCITY, State
from seatsim.rig.temperature import TemperatureScaling, Thermal
from seatsim.schema.arrays import Array

ROUNDING = 1e-9
"""Share of a step by which a delay may miss a whole number of steps and still count as that many."""


def run_loop(
    setup: LoopSetup, inputs: LoopInputs, rig_state: State, followed: State, law_state: State, out: Array, grid: Array
) -> int:
    """Simulate N samples from rest into `out`, shape (N, len(CHANNELS)), and return how many were reached.

    `rig_state` is that of damper and effects at rest, `followed` that of the inverse's damper, `law_state` the law's
    initial one; `grid`, shape (CELLS + 1,), is scratch of the inverse. To be compiled by `compiled`, with the classes
    of every record in `setup`. Nothing is raised: a run that diverges returns the sample at which it did, and later
    rows are not written.
    """
    coil, model, timing = setup.coil, setup.inverse_model, setup.timing
    step, samples, ratio = timing.step, len(inputs.floor_acceleration), setup.rig.plant.damper_ratio
    late, split, kept = delay_of(coil, step)
    current = inputs.start_current
    follows = len(inputs.temperature) > 0
    temperature = inputs.temperature[0] if follows else inputs.start_temperature
    factors = scaling_at(setup.factors, temperature)
    mechanical = (inputs.start_displacement, inputs.start_velocity, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    now = start(setup.rig, mechanical + rig_state, disturbance_of(inputs, 0), current, factors, step)
    command, wanted, served, sensed = 0.0, math.nan, math.nan, inputs.sensed

    for k in range(samples):
        floor = inputs.floor_acceleration[k]
        # The filters run at every step, the law only at its samples. The law is evaluated before the rig advances, so
        # that its command acts from this instant.
        sensed = advance_filters(setup.sensors, floor, now.state[DISPLACEMENT], now.rates, sensed)
        if k % timing.sample_every == 0:
            speed, replayed = inputs.floor_velocity[k], inputs.replayed[k] if len(inputs.replayed) > 0 else math.nan
            true = measure(now, k * step, floor, speed, current, temperature, replayed)
            y, sensed = read(setup.sensors, true, inputs.noise, k // timing.sample_every, sensed)
            z = model_state(model, damper_state(setup.rig, now.state), followed)
            command, wanted, served = command_current(
                setup.law, model, ratio, setup.max_command, y, factors, z, law_state, grid
            )
            law_state = update(setup.law, y, law_state)
        write_row(out[k], now, Sample(floor, wanted, served, current, command, temperature))
        if k == samples - 1:
            break
        acting = step_inputs(setup, inputs, out, k, current, late, split, kept)
        before = now.state
        now, next_current, good = advance(setup.rig, coil, acting, factors, now, timing.tolerance)
        if not good:
            return k
        felt, mean = model_scaling(model, factors, temperature), 0.5 * (current + next_current)
        first = Motion(ratio * before[DISPLACEMENT], ratio * before[VELOCITY], mean)
        last = Motion(ratio * now.state[DISPLACEMENT], ratio * now.state[VELOCITY], mean)
        followed = follow_state(model.damper, followed, first, last, felt, step)
        # Temperature is constant over a step: its change within one is far too small to affect the factors.
        if timing.self_heating:
            work = now.state[DAMPER_WORK] - before[DAMPER_WORK]
            temperature += warm_up(setup.thermal, coil, temperature, work, current, next_current, step)
            factors = scaling_at(setup.factors, temperature)
        elif follows and inputs.temperature[k + 1] != temperature:
            temperature = inputs.temperature[k + 1]
            factors = scaling_at(setup.factors, temperature)
        current = next_current
    return samples


@jit
def delay_of(coil: Coil, step: float) -> tuple[int, float, tuple[float, float]]:
    """Return the delay in whole steps, what is left of it in s, and `kept` of `StepInputs`."""
    late = int(math.floor(coil.delay / step + ROUNDING))  # noqa: RUF046 - a float on a CUDA device
    split = coil.delay - late * step
    kept = (1.0 - relaxed(coil, 0.0, 1.0, 0.5 * step), relaxed(coil, 1.0, 0.0, 0.5 * step))
    return late, split if split >= ROUNDING * step else 0.0, kept


@jit
def command_current(
    law: CompiledLaw,
    model: InverseModel,
    ratio: float,
    top: float,
    y: Measurement,
    factors: TemperatureScaling,
    z: State,
    law_state: State,
    grid: Array,
) -> tuple[float, float, float]:
    """Return the command in A, the force in N that the law wants (NaN: it wants a current), whether it is reached.

    z is the state of the inverse's damper, `ratio` the damper's stroke per travel, `top` the greatest command in A. The
    command of a law that gives no finite number is NaN.
    """
    answer = evaluate_law(law, y, law_state)
    # What is no finite number must not become a current by being clipped: the command is NaN, at which the run ends.
    is_number = math.isfinite(answer)
    if not wants_force(law):
        return min(max(answer, 0.0), top) if is_number else math.nan, math.nan, math.nan
    scaling = model_scaling(model, factors, y.temperature)
    x, v = ratio * y.displacement, ratio * y.velocity
    found = invert(Demand(model.damper, answer, x, v, scaling, z, top), grid)
    return found.current if is_number else math.nan, answer, found.served


@jit
def measure(
    now: IntegratorState,
    time: float,
    floor: float,
    floor_velocity: float,
    current: float,
    temperature: float,
    replayed: float,
) -> Measurement:
    """Return the true values at a sample, in the form in which a law sees them."""
    frame = now.rates[VELOCITY] + floor
    velocity = now.state[VELOCITY] + floor_velocity
    return Measurement(
        time,
        now.state[DISPLACEMENT],
        now.state[VELOCITY],
        velocity,
        velocity + now.state[CUSHION_VELOCITY],
        floor,
        frame,
        frame + now.rates[CUSHION_VELOCITY],
        now.forces.damper_force,
        current,
        temperature,
        replayed,
    )


@jit
def warm_up(thermal: Thermal, coil: Coil, temperature: float, work: float, i0: float, i1: float, step: float) -> float:
    """Return the rise of temperature in K over a step: work of the damper and heat of the coil less what is lost.

    `(|W| + R (i0^2 + i0 i1 + i1^2) / 3 step - h (T - T_ambient) step) / C`; the mean square is that of a current that
    runs linearly from `i0` to `i1`.
    """
    ohmic = coil.resistance * (i0 * i0 + i0 * i1 + i1 * i1) / 3.0 * step
    loss = thermal.conductance * (temperature - thermal.ambient) * step
    return (abs(work) + ohmic - loss) / thermal.heat_capacity
