"""The current of a coil whose command is known beforehand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.cached import compiled
from seatsim.kernel.step import relaxed
from seatsim.rig.coil import Coil

Array = NDArray[np.float64]


def simulate_current(coil: Coil, command: Array, step: float, start: float) -> Array:
    """Return the current in A, shape (N,), that follows a held command of shape (N,) from `start` on.

    command: in A, within the coil's limit, every `step` seconds, with the coil's delay already applied. The solution is
    that of `coil.relax`, exact from one value of the command to the next.
    """
    run = compiled(follow_command, (Coil,))
    return run(coil, np.asarray(command, dtype=float), float(step), float(start))


def follow_command(coil: Coil, command: Array, step: float, start: float) -> Array:
    """Return the same as `simulate_current`, uncompiled; the last value of the command has no time to act."""
    out: Array = np.empty_like(command)
    out[0] = start
    for k in range(len(command) - 1):
        out[k + 1] = relaxed(coil, out[k], command[k], step)
    return out
