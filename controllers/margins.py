"""How much a seat's loop under static output feedback can take: its margins.

The loop is broken at the damper force, with the damper taken as delivering the wanted force through the coil's lag (the
linear view of the semi-active loop; the clip to what a damper can do only takes energy out).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from controllers.linear_systems import LinearSystem
from seatsim.schema.arrays import Array


class Margins(NamedTuple):
    """Factor by which the loop gain may rise (inf where any may), phase margin in degrees, delay margin in s."""

    gain: float
    phase: float
    delay: float


def compute_margins(seat: LinearSystem, gain: Array) -> Margins:
    """Return the margins of the loop `L(s) = -K G(s)`, with G, the `seat`, from the wanted force to what is measured.

    The delay margin is the least phase margin over its crossover frequency (rad/rad/s), over all crossovers.
    """
    import control

    loop = control.ss(seat.A, seat.B, -np.atleast_2d(gain) @ seat.C, 0.0)
    gains, phases, _, _, crossings, _ = control.stability_margins(loop, returnall=True)
    # Factors below 1 are reductions: the seat without control is stable, so the margin that is asked for is a rise.
    rising = [g for g in gains if g > 1.0]
    ahead = np.mod(np.asarray(phases), 360.0)
    delays = np.radians(ahead) / np.asarray(crossings)
    return Margins(
        float(min(rising, default=math.inf)),
        float(np.min(np.abs(phases), initial=math.inf)),
        float(np.min(delays, initial=math.inf)),
    )
