"""Sums over the samples of a run, which the metrics are made of where no history is kept."""

from __future__ import annotations

from typing import NamedTuple

from seatsim.compilation.jit import jit
from seatsim.kernel.step import IntegratorState
from seatsim.rig.plant import Plant
from seatsim.rig.state import (
    CUSHION_DISPLACEMENT,
    CUSHION_VELOCITY,
    CUSHION_WORK,
    DAMPER_WORK,
    DISPLACEMENT,
    FLOOR_WORK,
    SUSPENSION_WORK,
    VELOCITY,
)


class Demand(NamedTuple):
    """What a law asked for last: command in A, wanted force in N (NaN: none), and whether it is reached."""

    command: float
    wanted: float
    served: float


class Sums(NamedTuple):
    """Sums and extremes over the samples of a run, SI units, as `seatsim.metrics` defines them.

    `below` and `above` are 1 while the suspension is beyond its travel; `stored` is the energy at the first sample, the
    sums of the current are those of its square.
    """

    frame: float = 0.0
    frame_peak: float = 0.0
    displacement: float = 0.0
    displacement_peak: float = 0.0
    hits: float = 0.0
    below: float = 0.0
    above: float = 0.0
    asked: float = 0.0
    wanted: float = 0.0
    missed: float = 0.0
    served: float = 0.0
    current: float = 0.0
    first_current: float = 0.0
    last_current: float = 0.0
    stored: float = 0.0
    imbalance: float = 0.0
    energy: float = 0.0
    damper_energy: float = 0.0


@jit
def add_to_sums(
    plant: Plant, now: IntegratorState, current: float, demand: Demand, frame: float, sums: Sums, first: bool
) -> Sums:
    """Return the sums with one more sample: `frame` is the frame's acceleration in m/s^2, `current` the coil's in A."""
    s = now.state
    x, v = s[DISPLACEMENT], s[VELOCITY]
    below = 1.0 if x < plant.travel[0] else 0.0
    above = 1.0 if x > plant.travel[1] else 0.0
    asked = 1.0 if demand.wanted == demand.wanted else 0.0
    wanted = demand.wanted if demand.wanted == demand.wanted else 0.0
    missed = asked * (wanted - now.forces.damper_force)
    stored = 0.5 * (
        plant.frame_mass * v * v
        + plant.driver_mass * (v + s[CUSHION_VELOCITY]) * (v + s[CUSHION_VELOCITY])
        + plant.suspension_stiffness * x * x
        + plant.cushion_stiffness * s[CUSHION_DISPLACEMENT] * s[CUSHION_DISPLACEMENT]
    )
    at_rest = stored if first else sums.stored
    used = (s[DAMPER_WORK], s[SUSPENSION_WORK], s[CUSHION_WORK], stored - at_rest)
    return Sums(
        sums.frame + frame * frame,
        max(sums.frame_peak, abs(frame)),
        sums.displacement + x * x,
        max(sums.displacement_peak, abs(x)),
        sums.hits + below * (1.0 - sums.below) + above * (1.0 - sums.above),
        below,
        above,
        sums.asked + asked,
        sums.wanted + wanted * wanted,
        sums.missed + missed * missed,
        sums.served + (demand.served if demand.served == demand.served else 0.0),
        sums.current + current * current,
        current if first else sums.first_current,
        current,
        at_rest,
        max(sums.imbalance, abs(s[FLOOR_WORK] - (used[0] + used[1] + used[2] + used[3]))),
        max(sums.energy, abs(s[FLOOR_WORK]), abs(used[0]), abs(used[1]), abs(used[2]), abs(used[3])),
        s[DAMPER_WORK],
    )
