"""A damper on a test bench: force under prescribed motion, sine tests and the figures read from a cycle."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seatsim.compilation.cached import compiled
from seatsim.dampers.base import DamperSpecification
from seatsim.kernel.augmented import classes_of
from seatsim.kernel.bench import MOST_PARTS, TOLERANCE, run_bench
from seatsim.kernel.generic import DamperModel
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.registry import specification_of

_DRIFT_LIMIT = 0.2
"""Mean distance of the middle of a stroke from x = 0, over half the stroke, that counts as uncentred."""


class SineTest(NamedTuple):
    """One cycle of a sine test, both ends included: time [s], displacement [m], velocity [m/s], force [N]."""

    time: Array
    displacement: Array
    velocity: Array
    force: Array

    @property
    def peak_force(self) -> float:
        """Largest magnitude of the force in N."""
        return float(np.max(np.abs(self.force)))

    @property
    def dissipated_energy(self) -> float:
        """Energy dissipated in the cycle in J, the area of the force-displacement loop."""
        return float(np.trapezoid(self.force * self.velocity, self.time))

    @property
    def equivalent_damping(self) -> float:
        """Viscous damping in N s/m that dissipates the same energy, `E / (pi w X^2)`."""
        period = self.time[-1] - self.time[0]
        amplitude = 0.5 * float(np.ptp(self.displacement))
        return float(self.dissipated_energy * period / (2.0 * math.pi**2 * amplitude**2))

    @property
    def asymmetric_part(self) -> Array:
        """Difference in N from the ideal symmetric loop, `(F(t) + F(t + T/2)) / 2`.

        The ideal loop is the centrosymmetric part of this one: half the difference of F at (x, v) and at (-x,
        -v).
        """
        half = (len(self.force) - 1) // 2
        cycle = self.force[:-1]
        difference = 0.5 * (cycle + np.roll(cycle, -half))
        return np.append(difference, difference[0])


def sine_test(
    damper: DamperModel,
    amplitude: float,
    frequency: float,
    current: float,
    temperature: float,
    factors: TemperatureFactors | None = None,
    cycles: int = 3,
    samples: int = 2000,
) -> SineTest:
    """Drive the damper with `x = amplitude sin(2 pi frequency t)` and return the last of its `cycles`.

    amplitude in m, frequency in Hz, current in A, temperature in degC; `factors` default to those that
    the model states. `samples` per cycle is even. Models with a slow state (the branch of an algebraic model
    forgets its start within seconds) need as many cycles as that takes.

    Raises:
        InputError: `samples` is odd, or amplitude or frequency is not positive.
        RunError: the damper's state ran away.

    """
    if samples % 2 or samples < 2 or not (amplitude > 0 and frequency > 0 and cycles > 0):
        raise InputError(
            "a sine test needs amplitude, frequency and cycles above 0 and an even number of samples, not"
            f" {amplitude} m, {frequency} Hz, {cycles}, {samples}"
        )
    step = 1.0 / (frequency * samples)
    phase = math.pi / samples * np.arange(2 * cycles * samples + 1)
    displacement = amplitude * np.sin(phase)
    velocity = 2.0 * math.pi * frequency * amplitude * np.cos(phase)
    force = bench_force(damper, displacement, velocity, current, temperature, step, factors)
    last = slice(-(samples + 1), None)
    time = np.asarray(step * np.arange(len(force)), dtype=float)
    return SineTest(time[last], displacement[::2][last], velocity[::2][last], force[last])


def bench_force(
    damper: DamperModel,
    displacement: ArrayLike,
    velocity: ArrayLike,
    current: ArrayLike,
    temperature: ArrayLike,
    step: float,
    factors: TemperatureFactors | None = None,
    state: State | None = None,
) -> Array:
    """Return the force in N, shape (n + 1,), of a damper whose motion is prescribed, every `step` seconds.

    displacement [m] and velocity [m/s] have shape (2 n + 1,), sampled every *half* step; current [A] and
    temperature [degC] likewise, or one number. `factors` and the initial `state` default to those that
    the model states.

    Raises:
        InputError: the lengths do not fit.
        RunError: the damper's state ran away.

    """
    x = np.array(displacement, dtype=float)
    if x.ndim != 1 or len(x) % 2 == 0:
        raise InputError(f"a bench needs two samples a step and one more, in one dimension, not {x.shape}")
    try:
        v, i, degrees = (np.array(np.broadcast_to(a, x.shape), float) for a in (velocity, current, temperature))
    except ValueError as error:
        raise InputError(f"the samples of a bench differ in number: {error}") from error
    out = np.full((len(x) + 1) // 2, math.nan)
    if state is None or factors is None:
        specification: DamperSpecification = specification_of(type(damper))
        state, factors = specification.initial if state is None else state, factors or specification.factors
    run = compiled(run_bench, classes_of(damper))
    reached = run(damper, factors, x, v, i, degrees, state, float(step), MOST_PARTS, TOLERANCE, out)
    if reached < len(out) or not np.all(np.isfinite(out)):
        raise RunError(
            f"the force of {type(damper).__name__} is not finite, or its state too stiff, after {reached * step:.3g} s"
        )
    return out


def centring(displacement: ArrayLike, velocity: ArrayLike) -> str:
    """Return why this motion does not suit a model whose specification says `centred`, or an empty string.

    Such a model takes its branch from the sign of the displacement, so every stroke between two reversals has
    to be centred about x = 0; reported is the mean distance of the strokes' middles from it, over half the
    mean stroke.
    """
    x, v = np.asarray(displacement, dtype=float), np.asarray(velocity, dtype=float)
    turns = x[1:][np.signbit(v[1:]) != np.signbit(v[:-1])]
    if np.sum(np.abs(turns[1:] + turns[:-1])) <= _DRIFT_LIMIT * np.sum(np.abs(np.diff(turns))):
        return ""
    return (
        f"the middles of the strokes lie more than {_DRIFT_LIMIT:.0%} of half a stroke from x = 0: a model that"
        " branches on the sign of the displacement is not passive here; prefer one with a state of hysteresis"
    )
