"""The true seat rig in one compiled loop: classical Runge-Kutta at 0.1 ms, memories carried from step to step.

The floor enters only as an acceleration; all motion is relative (`x = zs - z0`, `y = zc - zs`), so nothing drifts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from seatsim.blind.truth import slots as s
from seatsim.blind.truth.coil_physics import coil_rates, held_command, target_current
from seatsim.blind.truth.commands import command_of
from seatsim.blind.truth.compiled import Parameters, compiled
from seatsim.blind.truth.damper_physics import damper_force, remember
from seatsim.blind.truth.seat_physics import cushion_force, occupant_force, occupant_rates, suspension_force
from seatsim.blind.truth.slots import Array

RATE = 500.0
"""Rows per second."""
FINE = 2000.0
"""Samples per second of the floor and of forces on the frame; linear between them."""
STEP = 1e-4
"""Step of the integration, s."""


@dataclass(frozen=True)
class Motion:
    """What the rig did, at the rows of the table; `fine_current` at every step. Before sensors and noise."""

    frame: Array
    driver: Array
    displacement: Array
    force: Array
    command: Array
    current: Array
    temperature: Array
    fine_current: Array


def simulate(
    record: Any, floor: Array, push: Array, law: Array, schedule: Array, rows: int, floor_rate: float = FINE,
    step: float = STEP,
) -> Motion:  # fmt: skip
    """Run the rig from rest for `rows` rows.

    `floor` (m/s^2, at `floor_rate`) and `push` (N on the frame, at 2 kHz) are linear between samples. `law` is the
    controller (see `commands`); `schedule` (A, one per row) is the command where the law is a schedule.
    """
    out: Array = np.zeros((7, rows))
    fine = np.zeros(rows * round(1.0 / (RATE * step)))
    _run(record, floor, floor_rate, push, law, schedule, step, out, fine)
    return Motion(out[0], out[1], out[2], out[3], out[4], out[5], out[6], fine)


@compiled
def _between(samples: Array, rate: float, time: float) -> float:
    place = time * rate
    k = int(place)
    if k + 1 >= samples.size:
        return float(samples[-1])
    return float(samples[k] + (place - k) * (samples[k + 1] - samples[k]))


@compiled
def _rates(
    y: Array, dy: Array, mem: Array, a0: float, push: float, target: float, late: float, p: Parameters, acc: Array
) -> None:
    """Write all rates; `acc` gets frame and driver acceleration (m/s^2) and the force at the load cell (N)."""
    coil_rates(y, dy, target, y[s.V], p)
    ratio = 1.0 + p.soften_ratio * y[s.X]
    fd = damper_force(y, dy, mem, y[s.X], y[s.V] * ratio, p)
    fs = suspension_force(y, dy, p)
    fc = cushion_force(y, dy, p)
    ground = a0
    if p.base_rate > 0.0 and p.base_mass > 0.0:
        pull = p.base_rate * (p.base_rate * y[s.BASE] + 2.0 * p.base_damping * y[s.BASE_V])
        dy[s.BASE] = y[s.BASE_V]
        dy[s.BASE_V] = -pull - a0 + (fs + ratio * fd) / p.base_mass
        ground = a0 + dy[s.BASE_V]
    frame = (-fs + fc - ratio * fd + push + p.inertance * ground) / (p.ms + p.inertance)
    seated = p.m * (1.0 + p.mass_gain) * (1.0 - p.body_fraction - p.body2_fraction)
    driver = (-fc + occupant_force(y, late, p)) / seated
    occupant_rates(y, dy, driver, p)
    dy[s.X] = y[s.V]
    dy[s.V] = frame - ground
    dy[s.Y] = y[s.W]
    dy[s.W] = driver - frame
    acc[0] = frame
    acc[1] = driver
    acc[2] = fd + p.inertance * (frame - ground)


@compiled
def _run(
    p: Parameters,
    floor: Array,
    floor_rate: float,
    pushes: Array,
    law: Array,
    schedule: Array,
    h: float,
    out: Array,
    fine: Array,
) -> None:
    rows = out.shape[1]
    interval = 1.0 / RATE
    per_row = round(interval / h)
    y = np.zeros(s.STATES)
    y[s.T_FLUID] = y[s.T_BODY] = y[s.T_THERMO] = p.t_start
    mem = np.zeros(s.MEMORIES)
    relays = np.zeros(s.RELAYS)
    k1, k2, k3 = np.zeros(s.STATES), np.zeros(s.STATES), np.zeros(s.STATES)
    k4, part = np.zeros(s.STATES), np.zeros(s.STATES)
    acc = np.zeros(3)
    commands = np.zeros(rows)
    lag = max(round(p.muscle_delay / h), 1)
    past = np.zeros(lag)
    for row in range(rows):
        for sub in range(per_row):
            n = row * per_row + sub
            time = n * h
            a0 = _between(floor, floor_rate, time)
            am = _between(floor, floor_rate, time + 0.5 * h)
            a1 = _between(floor, floor_rate, time + h)
            push = _between(pushes, FINE, time) if pushes.size > 1 else 0.0
            if sub == 0:
                commands[row] = command_of(law, schedule, row, y, mem, p)
            target = target_current(held_command(commands, time, interval, p), time, h, y, mem, p)
            late = past[n % lag]
            _rates(y, k1, mem, a0, push, target, late, p, acc)
            if sub == 0:
                out[0, row], out[1, row], out[3, row] = acc
                out[2, row], out[4, row], out[5, row], out[6, row] = y[s.X], commands[row], y[s.CUR], y[s.T_THERMO]
            fine[n] = y[s.CUR]
            frame, driver = acc[0], acc[1]
            for j in range(s.STATES):
                part[j] = y[j] + 0.5 * h * k1[j]
            _rates(part, k2, mem, am, push, target, late, p, acc)
            for j in range(s.STATES):
                part[j] = y[j] + 0.5 * h * k2[j]
            _rates(part, k3, mem, am, push, target, late, p, acc)
            for j in range(s.STATES):
                part[j] = y[j] + h * k3[j]
            _rates(part, k4, mem, a1, push, target, late, p, acc)
            for j in range(s.STATES):
                y[j] += h / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j])
            y[s.CUR] = min(max(y[s.CUR], 0.0), p.i_max)
            past[n % lag] = y[s.W]
            mem[s.V_FRAME] += h * (frame - 0.8 * mem[s.V_FRAME])
            mem[s.V_DRIVER] += h * (driver - 0.8 * mem[s.V_DRIVER])
            remember(y, mem, relays, y[s.X], y[s.V] * (1.0 + p.soften_ratio * y[s.X]), h, p)
