"""The time loop: one run of a seat from rest, compiled for its combination of damper, law and inverse."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.jit import jit
from seatsim.kernel.belief import follow, scaling, state
from seatsim.kernel.chain import before
from seatsim.kernel.generic import Tuple, ask, heat_at, passed, read, update, wants_force
from seatsim.kernel.inverse import CELLS, invert
from seatsim.kernel.rig import Rig, Shake
from seatsim.kernel.step import Drive, Progress, advance, relaxed, start
from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement
from seatsim.rig.sensors import READINGS, Direct
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling, Thermal

Array = NDArray[np.float64]

CHANNELS = (
    "floor_acceleration",
    "frame_acceleration",
    "driver_acceleration",
    "suspension_displacement",
    "suspension_velocity",
    "cushion_displacement",
    "cushion_velocity",
    "damper_force",
    "wanted_force",
    "force_served",
    "coil_current",
    "current_command",
    "damper_temperature",
    "energy_floor",
    "energy_damper",
    "energy_suspension",
    "energy_cushion",
)
"""Columns of a history, in order; SI units, degrees Celsius."""


class Inputs(NamedTuple):
    """What drives a run, sampled every `step`, shape (N,) each; an array of length 0 is an input that is absent.

    `replayed` is a recorded command for laws that replay it, `prescribed` a coil current that bypasses the coil,
    `temperature` the damper's temperature in degC, `push` and `lift` forces on frame and driver in N; the
    coil starts at `start_current`, the suspension at `start_displacement` and `start_velocity`, the cushion at rest,
    the sensors at `sensed`. `noise`, shape (M, READINGS), is that of the readings at the law's samples.
    """

    floor_acceleration: Array
    floor_velocity: Array
    temperature: Array
    replayed: Array
    prescribed: Array
    push: Array
    lift: Array
    start_current: float = 0.0
    start_displacement: float = 0.0
    start_velocity: float = 0.0
    sensed: Tuple = ()
    noise: Array = np.zeros((0, READINGS))


class Timing(NamedTuple):
    """Step of the loop in s, steps per sample of the law, error tolerance, and whether temperature is a state."""

    step: float
    sample_every: int
    tolerance: float
    self_heating: bool


class Setup(NamedTuple):
    """The constant parts of a run; `max_command` in A is the most that the controller asks for.

    The law sees what `sensors` tell it: the true states, or what instruments make of them.
    """

    rig: Rig
    coil: Coil
    factors: TemperatureFactors
    thermal: Thermal
    law: Any
    belief: Any
    timing: Timing
    max_command: float
    sensors: Any = Direct()


def run_loop(setup: Setup, inputs: Inputs, rig_state: Tuple, believed: Tuple, law_state: Tuple, out: Array) -> int:
    """Simulate from rest and fill `out`, shape (N, len(CHANNELS)); return the number of samples reached (N if all)."""
    rig, coil, law, belief, timing = setup.rig, setup.coil, setup.law, setup.belief, setup.timing
    step, samples = timing.step, len(out)
    late = math.floor(coil.delay / step + 1e-9)
    split = coil.delay - late * step
    split = split if split >= 1e-9 * step else 0.0
    kept = (1.0 - relaxed(coil, 0.0, 1.0, 0.5 * step), relaxed(coil, 1.0, 0.0, 0.5 * step))
    current = inputs.start_current
    temperature = inputs.temperature[0]
    factors = heat_at(setup.factors, temperature)
    mechanical = (inputs.start_displacement, inputs.start_velocity, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    shake = Shake(inputs.floor_acceleration[0], _at(inputs.push, 0), _at(inputs.lift, 0))
    now = start(rig, mechanical + rig_state, shake, current, factors, step)
    command, wanted, served, sensed = 0.0, math.nan, math.nan, inputs.sensed
    grid = np.empty(CELLS + 1)

    for k in range(samples):
        floor = inputs.floor_acceleration[k]
        sensed = passed(setup.sensors, floor, now.state[0], now.rates, sensed)
        if k % timing.sample_every == 0:
            true = _measure(rig, inputs, now, k, step, current, temperature)
            y, sensed = read(setup.sensors, true, inputs.noise, k // timing.sample_every, sensed)
            command, wanted, served = _decide(setup, y, now, factors, believed, law_state, grid)
            law_state = update(law, y, law_state)
        _record(out, k, now, floor, wanted, served, current, command, temperature)
        if k == samples - 1:
            break
        drive = _drive(setup, inputs, out, k, current, late, split, kept)
        x, v, work = now.state[0], now.state[1], now.state[5]
        now, next_current, good = advance(rig, coil, drive, factors, now, timing.tolerance)
        if not good:
            return k
        ratio = rig.plant.damper_ratio
        believed = follow(
            belief.damper,
            believed,
            ratio * x,
            ratio * v,
            ratio * now.state[0],
            ratio * now.state[1],
            0.5 * (current + next_current),
            scaling(belief, factors, temperature),
            step,
        )
        if timing.self_heating:
            temperature += _warming(setup.thermal, coil, temperature, now.state[5] - work, current, next_current, step)
            factors = heat_at(setup.factors, temperature)
        elif inputs.temperature[k + 1] != temperature:
            temperature = inputs.temperature[k + 1]
            factors = heat_at(setup.factors, temperature)
        current = next_current
    return samples


@jit
def _at(values: Array, k: int) -> float:
    """Return sample `k` of an input, 0 where it is absent."""
    return values[k] if len(values) > 0 else 0.0


@jit
def _drive(
    setup: Setup, inputs: Inputs, out: Array, k: int, current: float, late: int, split: float, kept: tuple[float, float]
) -> Drive:
    """Return what acts on the rig from sample `k` to the next, its commands delayed by `late` steps and `split`."""
    first, most, prescribed = inputs.start_current, setup.coil.max_current, len(inputs.prescribed) > 0
    before = min(out[k - late - 1, 11] if k > late else first, most)
    after = min(out[k - late, 11] if k >= late else first, most)
    if prescribed:
        after = inputs.prescribed[k + 1]
    floor, push, lift = inputs.floor_acceleration[k], _at(inputs.push, k), _at(inputs.lift, k)
    rise = inputs.floor_acceleration[k + 1] - floor
    rises = _at(inputs.push, k + 1) - push, _at(inputs.lift, k + 1) - lift
    return Drive(
        setup.timing.step, floor, rise, current, before, after, split, prescribed, kept, push, rises[0], lift, rises[1]
    )


@jit
def _decide(
    setup: Setup,
    y: Measurement,
    now: Progress,
    factors: TemperatureScaling,
    believed: Tuple,
    law_state: Tuple,
    grid: Array,
) -> tuple[float, float, float]:
    """Return the command in A, the force in N that the law wants (NaN: it wants a current) and whether it is served."""
    law, belief, top = setup.law, setup.belief, setup.max_command
    answer = ask(law, y, law_state)
    if not wants_force(law):
        return min(max(answer, 0.0), top), math.nan, math.nan
    ratio = setup.rig.plant.damper_ratio
    found = invert(
        belief.damper,
        belief.order,
        answer,
        ratio * y.displacement,
        ratio * y.velocity,
        scaling(belief, factors, y.temperature),
        state(belief, before(setup.rig.effects, now.state[8:]), believed),
        top,
        grid,
    )
    return found.current, answer, found.served


@jit
def _measure(
    rig: Rig, inputs: Inputs, now: Progress, k: int, step: float, current: float, temperature: float
) -> Measurement:
    """Return what is true at sample `k`, in the form in which a law sees it."""
    floor = inputs.floor_acceleration[k]
    frame = now.rates[1] + floor
    velocity = now.state[1] + inputs.floor_velocity[k]
    replayed = inputs.replayed[k] if len(inputs.replayed) > 0 else math.nan
    return Measurement(
        k * step,
        now.state[0],
        now.state[1],
        velocity,
        velocity + now.state[3],
        floor,
        frame,
        frame + now.rates[3],
        now.flow.damper_force,
        current,
        temperature,
        replayed,
    )


@jit
def _record(
    out: Array,
    k: int,
    now: Progress,
    floor: float,
    wanted: float,
    served: float,
    current: float,
    command: float,
    temperature: float,
) -> None:
    """Write sample `k` in the order of `CHANNELS`."""
    s, row = now.state, out[k]
    row[0], row[1], row[2] = floor, now.rates[1] + floor, now.rates[1] + floor + now.rates[3]
    row[3], row[4], row[5], row[6] = s[0], s[1], s[2], s[3]
    row[7], row[8], row[9] = now.flow.damper_force, wanted, served
    row[10], row[11], row[12] = current, command, temperature
    row[13], row[14], row[15], row[16] = s[4], s[5], s[6], s[7]


@jit
def _warming(thermal: Thermal, coil: Coil, temperature: float, work: float, i0: float, i1: float, step: float) -> float:
    """Return the rise of temperature in K over a step: work of the damper and heat of the coil less what is lost."""
    ohmic = coil.resistance * (i0 * i0 + i0 * i1 + i1 * i1) / 3.0 * step
    loss = thermal.conductance * (temperature - thermal.ambient) * step
    return (abs(work) + ohmic - loss) / thermal.heat_capacity
