"""How much a seat's loop under static output feedback can take: margins, and stability of the sampled loop.

The loop is broken at the damper force, with the damper taken as delivering the wanted force through the coil's lag (the
linear view of the semi-active loop; the clip to what a damper can do only takes energy out).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.analysis.sampled_loop import SampledLoop, build_seat_with_coil
from controllers.linear_systems import zero_order_hold
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant, state_space

Array = NDArray[np.float64]


class Margins(NamedTuple):
    """Factor by which the loop gain may rise (inf where any may), phase margin in degrees, delay margin in s."""

    gain: float
    phase: float
    delay: float


def compute_margins(plant: Plant, gain: Array, coil: Coil) -> Margins:
    """Return the margins of the loop `L(s) = -K G(s) r / (s + r)`, with G from Fd to (x, v) and r the coil's rate.

    The delay margin is the least phase margin over its crossover frequency (rad/rad/s), over all crossovers.
    """
    import control

    s = state_space(plant)
    k = np.atleast_2d(gain)
    lag = control.ss(-coil.rate, coil.rate, 1.0, 0.0)
    loop = control.ss(s.A, s.B2, -k @ s.C2, 0.0) * lag
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


def compute_sampled_radius(plant: Plant, gain: Array, coil: Coil, sample_time: float, delay_samples: int = 0) -> float:
    """Return the spectral radius of the sampled loop (below 1: stable): coil as a state, command held between samples.

    The exact zero-order hold of plant and coil over `sample_time`, with `delay_samples` whole samples of delay.
    """
    A, B = build_seat_with_coil(plant, coil)
    transition, input_gain = zero_order_hold(A, B, sample_time)
    C = np.atleast_2d(gain) @ np.eye(2, len(A))
    return SampledLoop(transition, input_gain[:, 0], C[0], sample_time).radius(delay_samples)
