"""The true coil: from the command that the controller logs to the current in the winding, A.

Nominal: `di/dt = rate (i_cmd - i)`, `0 <= i <= i_max`, the command held from its row until the next.
"""

from __future__ import annotations

import math

from seatsim.blind.truth import slots as s
from seatsim.blind.truth.compiled import Parameters, compiled
from seatsim.blind.truth.slots import Array


@compiled
def noise_of(k: float, seed: float) -> float:
    """Return a repeatable number in 0..1 for a whole number k."""
    value = math.sin(k * 12.9898 + seed * 78.233) * 43758.5453
    return value - math.floor(value)


@compiled
def held_command(commands: Array, time: float, interval: float, p: Parameters) -> float:
    """Return the command that reaches the driver: held, `delay` late, with jitter from row to row."""
    if p.delay == 0.0:
        return float(commands[int(time / interval + 1e-6)])
    late = p.delay
    if p.delay_jitter != 0.0:
        late *= 1.0 + p.delay_jitter * (2.0 * noise_of(math.floor(time / interval), 3.0) - 1.0)
    row = math.floor((time - late) / interval + 1e-6)
    return commands[row] if row >= 0 else 0.0


@compiled
def target_current(command: float, time: float, h: float, y: Array, mem: Array, p: Parameters) -> float:
    """Return the current that the driver aims at: quantised, with a dead band, limited softly, with dropouts."""
    target = min(max(command, 0.0), p.i_max)
    if p.quantum > 0.0:
        target = p.quantum * math.floor(target / p.quantum + 0.5)
    if p.dead_zone > 0.0:
        target = max(target - p.dead_zone, 0.0)
    if p.limit > 0.0:
        ceiling = max(p.limit - p.limit_sag * y[s.SAG], 0.05)
        target = target / (1.0 + (target / ceiling) ** p.limit_power) ** (1.0 / p.limit_power)
    if p.drop_every > 0.0:
        if mem[s.DROP_LEFT] > 0.0:
            mem[s.DROP_LEFT] -= h
            return 0.0
        if noise_of(math.floor(time / h + 0.5), p.drop_seed) < h / p.drop_every:
            mem[s.DROP_LEFT] = p.drop_time
    return target


@compiled
def coil_rates(y: Array, dy: Array, target: float, v: float, p: Parameters) -> None:
    """Write the rates of the coil's states: one pole, two poles, two branches, a slow fall, or a ringing regulator."""
    i = y[s.CUR]
    aim = target
    if p.back_emf != 0.0:
        aim = max(aim - p.back_emf * abs(v) * (1.0 if aim > 0.02 else 0.0), 0.0)
    rate = p.rate
    if p.fall_form == 1.0 and aim < i:
        rate = rate / (1.0 + p.fall_slow)
    elif p.fall_form == 2.0 and aim < i:
        rate = rate / (1.0 + 1.6 * p.fall_slow * max(1.0 - i, 0.0))
    if p.coil_rate2 > 0.0:
        dy[s.CUR2] = rate * (aim - y[s.CUR2])
        dy[s.CUR] = p.coil_rate2 * (y[s.CUR2] - i)
    elif p.coil_slow > 0.0:
        slow = p.coil_slow_rate * (aim - y[s.CUR2])
        fast = (i - p.coil_slow * y[s.CUR2]) / (1.0 - p.coil_slow)
        dy[s.CUR2] = slow
        dy[s.CUR] = (1.0 - p.coil_slow) * rate * (aim - fast) + p.coil_slow * slow
    elif p.ring_rate > 0.0:
        dy[s.CUR] = y[s.CUR2]
        dy[s.CUR2] = p.ring_rate * (p.ring_rate * (aim - i) - 2.0 * p.ring_damping * y[s.CUR2])
    else:
        dy[s.CUR] = rate * (aim - i)
    if p.limit_sag > 0.0:
        dy[s.SAG] = (i - y[s.SAG]) / 1.5
