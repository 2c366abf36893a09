"""Controllers of the true rig, sampled at the rows: a schedule, on-off skyhook, static output feedback.

A `law` is a vector of six numbers: kind, level (A), then what the kind needs.
"""

from __future__ import annotations

from seatsim.blind.truth.physics import state
from seatsim.blind.truth.physics.compiled import compiled
from seatsim.blind.truth.physics.parameters import RigParameters
from seatsim.schema.arrays import Array

SCHEDULE, SKYHOOK, FEEDBACK = 0.0, 1.0, 2.0
"""Kinds of law; numbers, because compiled code reads them from the vector."""
# The feedback's assumed damper model, by which it turns a force into a current: friction, N; viscous damping, N s/m;
# yield force, N/A; rise of the viscous damping with current, N s/(m A). Near the nominal damper and never exact, as in
# a real controller.
FRICTION, VISCOUS, YIELD_GAIN, VISCOUS_GAIN = 40.0, 250.0, 600.0, 350.0


@compiled
def command_of(law: Array, schedule: Array, row: int, y: Array, memory: Array, p: RigParameters) -> float:
    """Return the commanded current at a row, A.

    Skyhook (Karnopp 1974): full level where absolute and relative velocity have one sign, off below the relative speed
    `law[2]`. Feedback: the wanted force `g1 x + g2 v + g3 zs' + g4 zc'` over the yield force per ampere, where the
    damper can give it, else zero.
    """
    if law[0] == SCHEDULE:
        return float(min(max(schedule[row], 0.0), p.i_max))
    v = y[state.V]
    if law[0] == SKYHOOK:
        dead = law[2]
        # the frame's velocity has a dead band too, a tenth as wide, so that noise around rest switches nothing
        return law[1] if memory[state.V_FRAME] * v > dead * abs(v) * 0.1 and abs(v) > dead else 0.0
    wanted = law[2] * y[state.X] + law[3] * v + law[4] * memory[state.V_FRAME] + law[5] * memory[state.V_DRIVER]
    if wanted * v <= 0.0:
        return 0.0
    current = (abs(wanted) - FRICTION - VISCOUS * abs(v)) / (YIELD_GAIN + VISCOUS_GAIN * abs(v))
    # a controller logs and sends four decimals
    return float(round(min(max(current, 0.0), law[1]), 4))
