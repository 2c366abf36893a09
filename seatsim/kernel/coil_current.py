"""The current of a coil whose command is known beforehand."""

from __future__ import annotations

import math

import numpy as np

from seatsim.compilation.cached import compiled
from seatsim.kernel.step import relaxed
from seatsim.rig.coil import Coil
from seatsim.schema.arrays import Array

ROUNDING = 1e-9
"""Share of a step by which a delay may miss a whole number of steps and still count as that many."""


def simulate_current(coil: Coil, command: Array, step: float, start: float) -> Array:
    """Return the current in A, shape (N,), that follows a held command of shape (N,) from `start` on.

    command: in A, within the coil's limit, every `step` seconds; it acts `coil.delay` later, which need not be a whole
    number of steps. Before the first command acts the current stays at `start`. The solution is that of `coil.relax`,
    exact from one value of the command to the next.
    """
    run = compiled(follow_command, (Coil,))
    return run(coil, np.asarray(command, dtype=float), float(step), float(start))


def follow_command(coil: Coil, command: Array, step: float, start: float) -> Array:
    """Return the same as `simulate_current`, uncompiled; the last value of the command has no time to act."""
    late = math.floor(coil.delay / step + ROUNDING)
    split = coil.delay - late * step
    split = split if split >= ROUNDING * step else 0.0
    out: Array = np.empty_like(command)
    out[0] = start
    for k in range(len(command) - 1):
        now = out[k]
        if split > 0.0:
            now = relaxed(coil, now, command[k - late - 1] if k > late else start, split)
        out[k + 1] = relaxed(coil, now, command[k - late] if k >= late else start, step - split)
    return out
