"""Controllers of the true rig, sampled at the rows: a schedule, on-off skyhook, static output feedback.

`law` is a vector: kind (0 schedule, 1 skyhook, 2 feedback), level (A), then gains.
"""

from __future__ import annotations

from seatsim.blind.truth import slots as s
from seatsim.blind.truth.compiled import Parameters, compiled
from seatsim.blind.truth.slots import Array

SCHEDULE, SKYHOOK, FEEDBACK = 0.0, 1.0, 2.0


@compiled
def command_of(law: Array, schedule: Array, row: int, y: Array, mem: Array, p: Parameters) -> float:
    """Return the commanded current at a row, A.

    Skyhook (Karnopp 1974): full level where absolute and relative velocity have one sign. Feedback: the wanted force
    `g1 x + g2 v + g3 zs' + g4 zc'` divided by the yield force per ampere, where the damper can give it, else zero.
    """
    if law[0] == SCHEDULE:
        return float(min(max(schedule[row], 0.0), p.i_max))
    v = y[s.V]
    if law[0] == SKYHOOK:
        dead = law[2]
        return law[1] if mem[s.V_FRAME] * v > dead * abs(v) * 0.1 and abs(v) > dead else 0.0
    wanted = law[2] * y[s.X] + law[3] * v + law[4] * mem[s.V_FRAME] + law[5] * mem[s.V_DRIVER]
    if wanted * v <= 0.0:
        return 0.0
    return float(round(min(max((abs(wanted) - 40.0 - 250.0 * abs(v)) / (600.0 + 350.0 * abs(v)), 0.0), law[1]), 4))
