"""What is kept of a run whose metrics alone are wanted: sums over its samples, in place of rows."""

from __future__ import annotations

import math
from typing import NamedTuple

from seatsim.kernel.recorders import Sample
from seatsim.kernel.rig import Rig
from seatsim.kernel.step import IntegratorState
from seatsim.rig.state import (
    CUSHION_DISPLACEMENT,
    CUSHION_VELOCITY,
    CUSHION_WORK,
    DAMPER_WORK,
    DISPLACEMENT,
    FLOOR_WORK,
    SUSPENSION_WORK,
    VELOCITY,
    State,
)
from seatsim.schema.arrays import Array


class Sums(NamedTuple):
    """Sums and extremes over the samples of a run, SI units, as `seatsim.metrics` defines them.

    `below` and `above` are 1 while the suspension is beyond its travel; `stored` is the energy at the first sample, the
    sums of the current are those of its square. `turn` is the displacement at the last reversal of the suspension (NaN:
    none yet), `lengths` the sum of its strokes, `middles` twice that of the distances of their middles from mid-stroke.
    `fast`, `strong` and `foreign` count the samples beyond the speed, the current and the temperatures of the data
    behind the damper.
    """

    samples: float = 0.0
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
    velocity: float = 0.0
    turn: float = math.nan
    lengths: float = 0.0
    middles: float = 0.0
    fast: float = 0.0
    strong: float = 0.0
    foreign: float = 0.0


NO_SUMS = Sums()


class LaneLimits(NamedTuple):
    """Ends of the data behind a damper: its speed in m/s, its current in A, its temperatures in degC."""

    speed: float
    current: float
    coldest: float
    hottest: float


class Summed(NamedTuple):
    """Keeps sums, and the driver's acceleration in m/s^2 in `driver`, shape (N,).

    `commands`, shape (D,), holds the last D commands, D above the delay in steps by two; `room` is that of the inverse.
    """

    driver: Array
    commands: Array
    room: Array
    limits: LaneLimits

    def nothing(self) -> State:
        """Return the sums before the first sample."""
        return NO_SUMS

    def command_at(self, k: int) -> float:
        """Return one of the commands that are held."""
        command: float = self.commands[k % len(self.commands)]
        return command

    def keep(self, sums: Sums, rig: Rig, k: int, now: IntegratorState, sample: Sample) -> Sums:
        """Return the sums with sample `k`."""
        s, plant, limits = now.state, rig.plant, self.limits
        x, v = s[DISPLACEMENT], s[VELOCITY]
        frame = now.rates[VELOCITY] + sample.floor
        self.commands[k % len(self.commands)] = sample.command
        self.driver[k] = frame + now.rates[CUSHION_VELOCITY]
        below = 1.0 if x < plant.travel[0] else 0.0
        above = 1.0 if x > plant.travel[1] else 0.0
        asked = 1.0 if sample.wanted == sample.wanted else 0.0
        wanted = sample.wanted if sample.wanted == sample.wanted else 0.0
        missed = asked * (wanted - now.forces.damper_force)
        stored = 0.5 * (
            plant.frame_mass * v * v
            + plant.driver_mass * (v + s[CUSHION_VELOCITY]) * (v + s[CUSHION_VELOCITY])
            + plant.suspension_stiffness * x * x
            + plant.cushion_stiffness * s[CUSHION_DISPLACEMENT] * s[CUSHION_DISPLACEMENT]
        )
        at_rest = stored if k == 0 else sums.stored
        used = (s[DAMPER_WORK], s[SUSPENSION_WORK], s[CUSHION_WORK], stored - at_rest)
        turns = k > 0 and math.copysign(1.0, sums.velocity) != math.copysign(1.0, v)
        strokes = turns and not math.isnan(sums.turn)
        return Sums(
            sums.samples + 1.0,
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
            sums.served + (sample.served if sample.served == sample.served else 0.0),
            sums.current + sample.current * sample.current,
            sample.current if k == 0 else sums.first_current,
            sample.current,
            at_rest,
            max(sums.imbalance, abs(s[FLOOR_WORK] - (used[0] + used[1] + used[2] + used[3]))),
            max(sums.energy, abs(s[FLOOR_WORK]), abs(used[0]), abs(used[1]), abs(used[2]), abs(used[3])),
            s[DAMPER_WORK],
            v,
            x if turns else sums.turn,
            sums.lengths + abs(x - sums.turn) if strokes else sums.lengths,
            sums.middles + abs(x + sums.turn) if strokes else sums.middles,
            sums.fast + (1.0 if abs(plant.damper_ratio * v) > limits.speed else 0.0),
            sums.strong + (1.0 if sample.current > limits.current else 0.0),
            sums.foreign + (0.0 if limits.coldest <= sample.temperature <= limits.hottest else 1.0),
        )
