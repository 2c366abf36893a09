"""Seat, weighting and criterion as a linear-quadratic problem in a damper force that is held over each interval.

The run is that of the seat without damper, shaken by the floor, plus the response of seat and Wk filter to the force:

    s[k+1] = A s[k] + B F[k],   s = (x, v, xc, vc, eight filter states) of the response, s[0] = 0
    w[k]   = velocity . (s[k], F[k]) + w0[k],   mean velocity of the damper over the interval
    J      = J0 + sum over k of (s, F)' Q (s, F) + 2 q[k]' (s, F)

J = mean(aw^2) + mu mean(x^2) over all samples of the record, aw the Wk-weighted acceleration of the driver. A
`Transcription` holds the matrices; a `HeldForceProblem` states one mu and calls the compiled recursions.
"""

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
from controllers.linear_systems import connect_in_parallel, connect_in_series, frequency_weighting, pass_through
from controllers.synthesis.plant import LinearSystem
from seatsim.compilation.cached import compiled
from seatsim.metrics.weighting import weight
from seatsim.rig.plant import Plant, state_space, zero_order_hold
from seatsim.schema.arrays import Array


class _Criterion(NamedTuple):
    """A mean square as a quadratic form of the state and force: `free` without force, `Q` (n+1, n+1), `q` (N, n+1)."""

    free: float
    Q: Array
    q: Array


class Transcription(NamedTuple):
    """The matrices of the module's equations for N intervals of `step` seconds."""

    step: float
    A: Array
    B: Array
    velocity: Array
    free_velocity: Array
    acceleration: _Criterion
    travel: _Criterion


def transcribe(plant: Plant, floor: Array, sample: float, every: int, start: tuple[float, float]) -> Transcription:
    """Return the problem of a seat on a floor acceleration in m/s^2, shape (M,), linear between samples.

    The force is held over `every` samples of `sample` seconds. Samples after the last whole interval count as zero,
    which only lowers the criterion.
    """
    # Takes half a second to load, which runs without bounds do without.
    from scipy.signal import lsim

    s = state_space(plant)
    count = (len(floor) - 1) // every
    used = count * every + 1
    time, nothing = sample * np.arange(used), np.zeros((2, 1))
    response = lsim((s.A, s.B1, s.C1, nothing), floor[:used], time, [*start, 0.0, 0.0])[1]
    travel, acceleration = np.ascontiguousarray(response.T)
    weighted = connect_in_parallel(pass_through(1), frequency_weighting("Wk"))
    A, B, C, _ = connect_in_series(LinearSystem(s.A, s.B2, s.C1, nothing), weighted)
    steps = [np.hstack(zero_order_hold(A, B, (j + 1) * sample)) for j in range(every)]
    last = steps[-1]
    rows = np.array([C @ step for step in steps])  # travel, weighted acceleration
    ratio, total = plant.damper_ratio / (every * sample), len(floor)
    velocity, free_velocity = ratio * (last[0] - np.eye(len(A) + 1)[0]), ratio * np.diff(travel[::every])
    comfort = _criterion(weight(acceleration, 1 / sample), rows[:, 1], total)
    travelled = _criterion(travel, rows[:, 0], total)
    return Transcription(every * sample, last[:, :-1], last[:, -1], velocity, free_velocity, comfort, travelled)


def _criterion(free: Array, rows: Array, total: int) -> _Criterion:
    """Return the mean square of `free[1 + k every + j] + rows[j] . (s[k], F[k])`, all samples weighing 1 / total."""
    inside = free[1:].reshape(-1, len(rows))
    return _Criterion(float(np.sum(free**2)) / total, rows.T @ rows / total, inside @ rows / total)


class ClairvoyantRun(NamedTuple):
    """A run under a held force: J, its two mean squares, force and mean damper velocity by interval, what sets it."""

    cost: float
    acceleration: float
    travel: float
    force: Array
    velocity: Array
    modes: ForceModes


class LagrangianMinimum(NamedTuple):
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
        Q, q = t.acceleration.Q + self.weight * t.travel.Q, t.acceleration.q + self.weight * t.travel.q
        return StageMatrices(np.column_stack([t.A, t.B]), Q, q, t.velocity, t.free_velocity)

    @property
    def intervals(self) -> int:
        """Number of intervals."""
        return len(self.transcription.free_velocity)

    def minimise_lagrangian(self, band: ForceBand, multipliers: Array, barrier: float) -> LagrangianMinimum | None:
        """Return the minimum of the Lagrangian with its derivatives; None where it has none."""
        p, count, t = self.stage_matrices, self.intervals, self.transcription
        # The pivots stand in for last forces too, whose proximity counts 0: 0 times what memory held could be NaN.
        gain, pivot, by = np.empty((count, len(p.V))), np.zeros(count), np.empty((3, count))
        modes = np.zeros(count, dtype=np.int64)
        least = compiled(minimise_backwards, ())(p, band, multipliers, modes, 0.0, pivot, gain, pivot)
        if not np.isfinite(least):
            return None
        compiled(differentiate, ())(p, band, gain, pivot, barrier, by)
        free = t.acceleration.free + self.weight * t.travel.free
        return LagrangianMinimum(free + least, float(np.sum(np.log(pivot))), by, gain)

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
