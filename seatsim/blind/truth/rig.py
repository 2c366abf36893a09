"""The true seat rig in one compiled loop: classical Runge-Kutta at 0.1 ms, memories carried from step to step.

    ms zs'' = -Fs + Fc - Fd + F_frame,    m zc'' = -Fc + F_occupant

The floor enters only as an acceleration; all motion is relative (`x = zs - z0`, `y = zc - zs`), so nothing drifts.
"""

import math
from typing import NamedTuple, cast

import numpy as np

from seatsim.blind.truth import state
from seatsim.blind.truth.coil import ROUNDING, command_of, held_command, target_current, update_relays, write_coil_rates
from seatsim.blind.truth.damper import damper_force, update_cavity
from seatsim.blind.truth.seat import cushion_force, occupant_force, suspension_force, write_occupant_rates
from seatsim.blind.truth.state import RigParameters, compiled
from seatsim.schema.arrays import Array

SAMPLE_RATE = 500.0
"""Rows per second, unless an experiment states another rate."""
EXCITATION_RATE = 2000.0
"""Samples per second of the floor and of forces on the frame; linear between them."""
INTEGRATION_STEP = 1e-4
"""Longest step of the integration, s, a whole number of them in a row; a quarter of it changes no channel by more than
0.1 % of its spread (see the tests)."""
_FORGETTING = 0.8
"""1/s, at which a controller's integral of an acceleration forgets, so that no offset runs away."""


class RigMotion(NamedTuple):
    """What the rig did, shape (rows,) each, before sensors and noise; `fine_current` has a value for every step.

    The first seven are what the channels after the floor's read, in the contract's order.
    """

    frame: Array  # m/s^2
    driver: Array  # m/s^2
    displacement: Array  # m, suspension
    force: Array  # N, at the load cell
    command: Array  # A
    current: Array  # A
    temperature: Array  # degC, of the thermometer
    fine_current: Array  # A, shape (steps,)
    sample_rate: float = SAMPLE_RATE  # Hz, of the rows


class Inputs(NamedTuple):
    """What acts on the rig during a run; floor and frame force are linear between samples."""

    floor: Array  # m/s^2
    floor_rate: float  # Hz
    frame_force: Array  # N, at EXCITATION_RATE; a single sample means none
    law: Array  # see `coil`
    schedule: Array  # A, one per row: the command where the law is a schedule
    sample_rate: float = SAMPLE_RATE  # Hz, of the rows


def simulate(record: np.void, inputs: Inputs, step: float = INTEGRATION_STEP) -> RigMotion:
    """Run the rig from rest for as many rows as the schedule has, in steps no longer than `step`, s.

    `record` is that of `parameter_record`.
    """
    rows = inputs.schedule.size
    per_row = math.ceil(1.0 / (inputs.sample_rate * step) - ROUNDING)
    out: Array = np.zeros((7, rows))
    fine = np.zeros(rows * per_row)
    _run(cast(RigParameters, record), inputs, per_row, out, fine)
    return RigMotion(out[0], out[1], out[2], out[3], out[4], out[5], out[6], fine, inputs.sample_rate)


@compiled
def _between(samples: Array, rate: float, time: float) -> float:
    place = time * rate
    k = int(place)
    if k + 1 >= samples.size:
        return float(samples[-1])
    return float(samples[k] + (place - k) * (samples[k + 1] - samples[k]))


@compiled
def _base_acceleration(y: Array, rates: Array, floor: float, reaction: float, p: RigParameters) -> float:
    """Return the acceleration of the base, m/s^2, and write its rates; `reaction` is the suspension's force on it."""
    if p.base_rate > 0.0 and p.base_mass > 0.0:
        restoring = p.base_rate * (p.base_rate * y[state.BASE] + 2.0 * p.base_damping * y[state.BASE_V])
        rates[state.BASE] = y[state.BASE_V]
        rates[state.BASE_V] = -restoring - floor + reaction / p.base_mass
        return float(floor + rates[state.BASE_V])
    return floor


@compiled
def _write_rates(
    y: Array, rates: Array, memory: Array, acting: tuple[float, float, float, float], p: RigParameters, acc: Array
) -> None:
    """Write all rates; `acc` gets frame and driver acceleration (m/s^2) and the force at the load cell (N).

    `acting` are the floor's acceleration (m/s^2), the force on the frame (N), the current that the driver aims at (A)
    and the late speed of the cushion to which the muscles answer (m/s).

    An inerter (fluid inertia) adds its mass to the frame and is carried by the base; a lever transmits the damper's
    force and travel by its ratio.
    """
    floor, frame_force, target, late = acting
    write_coil_rates(y, rates, target, y[state.V], p)
    ratio = p.damper_ratio + p.lever_slope * y[state.X]
    fd = damper_force(y, rates, memory, p.damper_ratio * y[state.X], y[state.V] * ratio, p)
    fs = suspension_force(y, rates, p)
    fc = cushion_force(y, rates, p)
    base = _base_acceleration(y, rates, floor, fs + ratio * fd, p)
    frame = (-fs + fc - ratio * fd + frame_force + p.inertance * base) / (p.ms + p.inertance)
    seated = p.m * (1.0 + p.mass_gain) * (1.0 - p.body_fraction - p.second_body_fraction)
    driver = (-fc + occupant_force(y, late, p)) / seated
    write_occupant_rates(y, rates, driver, p)
    rates[state.X] = y[state.V]
    rates[state.V] = frame - base
    rates[state.Y] = y[state.W]
    rates[state.W] = driver - frame
    acc[0] = frame
    acc[1] = driver
    acc[2] = fd + p.inertance * (frame - base)


@compiled
def _run(p: RigParameters, inputs: Inputs, per_row: int, out: Array, fine: Array) -> None:
    """Run row by row; frame force, target and muscles stay within a step, as they change slowly beside it."""
    floor, floor_rate, frame_forces, law, schedule, sample_rate = inputs
    interval = 1.0 / sample_rate
    h = interval / per_row
    y = np.zeros(state.STATES)
    y[state.T_FLUID] = y[state.T_HOUSING] = y[state.T_THERMOMETER] = p.t_start
    memory, relays, acc = np.zeros(state.MEMORIES), np.zeros(state.RELAYS), np.zeros(3)
    # rates at the four stages of a Runge-Kutta step, and the state between them
    k1, k2, k3 = np.zeros(state.STATES), np.zeros(state.STATES), np.zeros(state.STATES)
    k4, part = np.zeros(state.STATES), np.zeros(state.STATES)
    commands = np.zeros(out.shape[1])
    # a ring of past cushion speeds, as long as the muscles' delay
    past = np.zeros(max(round(p.muscle_delay / h), 1))
    for n in range(fine.size):
        row, time = n // per_row, n * h
        force = _between(frame_forces, EXCITATION_RATE, time) if frame_forces.size > 1 else 0.0
        if n % per_row == 0:
            commands[row] = command_of(law, schedule, row, y, memory, p)
        target = target_current(held_command(commands, time, interval, p), time, h, y, memory, p)
        late = past[n % past.size]
        _write_rates(y, k1, memory, (_between(floor, floor_rate, time), force, target, late), p, acc)
        if n % per_row == 0:
            out[0, row], out[1, row], out[3, row] = acc
            out[2, row], out[4, row], out[5, row] = y[state.X], commands[row], y[state.CURRENT]
            out[6, row] = y[state.T_THERMOMETER]
        fine[n] = y[state.CURRENT]
        frame, driver = acc[0], acc[1]
        middle, end = _between(floor, floor_rate, time + 0.5 * h), _between(floor, floor_rate, time + h)
        for j in range(state.STATES):
            part[j] = y[j] + 0.5 * h * k1[j]
        _write_rates(part, k2, memory, (middle, force, target, late), p, acc)
        for j in range(state.STATES):
            part[j] = y[j] + 0.5 * h * k2[j]
        _write_rates(part, k3, memory, (middle, force, target, late), p, acc)
        for j in range(state.STATES):
            part[j] = y[j] + h * k3[j]
        _write_rates(part, k4, memory, (end, force, target, late), p, acc)
        for j in range(state.STATES):
            y[j] += h / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j])
        # the driver stage can neither sink current nor exceed its supply
        y[state.CURRENT] = min(max(y[state.CURRENT], 0.0), p.i_max)
        past[n % past.size] = y[state.W]
        # what changes once a step: the controller's velocities, the cavity, the relays
        memory[state.V_FRAME] += h * (frame - _FORGETTING * memory[state.V_FRAME])
        memory[state.V_DRIVER] += h * (driver - _FORGETTING * memory[state.V_DRIVER])
        if p.cavitation_force > 0.0:
            ratio = p.damper_ratio + p.lever_slope * y[state.X]
            update_cavity(y, memory, p.damper_ratio * y[state.X], y[state.V] * ratio, h, p)
        if p.relay_share != 0.0:
            update_relays(y, memory, relays, p)
