"""The problem at one weight of the travel, and the calls of the compiled recursions on it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from controllers.clairvoyant.recursion import (
    ForceBand,
    ForceModes,
    StageMatrices,
    differentiate,
    minimise_backwards,
    simulate_delivered,
)
from controllers.clairvoyant.transcription import Transcription
from seatsim.compilation.cached import compiled
from seatsim.schema.arrays import Array


class ClairvoyantRun(NamedTuple):
    """A run under a held force: J, its two mean squares, force and mean damper velocity by interval, what sets it."""

    cost: float
    acceleration: float
    travel: float
    force: Array
    velocity: Array
    modes: ForceModes


class _LagrangianMinimum(NamedTuple):
    """The Lagrangian's minimum (a bound of J), the sum of log pivots, their derivatives by the multipliers, the law."""

    bound: float
    barrier: float
    by: Array
    gain: Array


class HeldForceProblem(NamedTuple):
    """Minimise mean(aw^2) + weight mean(x^2) over the held force; `weight` in 1/s^4."""

    transcription: Transcription
    weight: float

    @property
    def stage_matrices(self) -> StageMatrices:
        """The matrices of the recursions."""
        t = self.transcription
        Q = t.acceleration.Q + self.weight * t.travel.Q
        q = t.acceleration.q + self.weight * t.travel.q
        return StageMatrices(np.column_stack([t.A, t.B]), Q, q, t.velocity, t.free_velocity)

    @property
    def intervals(self) -> int:
        """Number of intervals."""
        return len(self.transcription.free_velocity)

    def minimise_lagrangian(self, band: ForceBand, multipliers: Array, barrier: float) -> _LagrangianMinimum | None:
        """Return the minimum of the Lagrangian with its derivatives; None where it has none."""
        p, count, t = self.stage_matrices, self.intervals, self.transcription
        gain, pivot, by = np.empty((count, len(p.V))), np.empty(count), np.empty((3, count))
        modes = np.zeros(count, dtype=np.int64)
        least = compiled(minimise_backwards, ())(p, band, multipliers, modes, 0.0, pivot, gain, pivot)
        if not np.isfinite(least):
            return None
        compiled(differentiate, ())(p, band, gain, pivot, barrier, by)
        free = t.acceleration.free + self.weight * t.travel.free
        return _LagrangianMinimum(free + least, float(np.sum(np.log(pivot))), by, gain)

    def simulate(self, band: ForceBand, gain: Array) -> ClairvoyantRun:
        """Return the run under what the damper delivers of the force `gain . (s, 1)`, shape (N, n+1)."""
        p, count, t = self.stage_matrices, self.intervals, self.transcription
        force, velocity, states = np.empty(count), np.empty(count), np.empty((count, len(p.V) - 1))
        modes = np.zeros(count, dtype=np.int64)
        compiled(simulate_delivered, ())(p, band, gain, force, velocity, states, modes)
        y = np.column_stack([states, force])
        acceleration, travel = (m.free + float(np.sum(y * (y @ m.Q + 2 * m.q))) for m in (t.acceleration, t.travel))
        return ClairvoyantRun(acceleration + self.weight * travel, acceleration, travel, force, velocity, modes)

    def improve_law(self, band: ForceBand, run: ClairvoyantRun, proximity: float) -> Array:
        """Return the law that is best where every interval stays on what sets its force in `run`."""
        p, count = self.stage_matrices, self.intervals
        gain, pivot = np.empty((count, len(p.V))), np.empty(count)
        compiled(minimise_backwards, ())(p, band, np.zeros((3, count)), run.modes, proximity, run.force, gain, pivot)
        return gain
