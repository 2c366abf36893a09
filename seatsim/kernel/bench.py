"""A damper on a test bench: motion, current and temperature are prescribed, and the force is computed.

The classical Runge-Kutta method of order 4 on samples every half step, so that the middle of a step is a
sample too. Steps in which the damper's state is stiff are divided; motion and current then follow the
parabola through the three samples of the step.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from seatsim.compilation.cached import compiled
from seatsim.compilation.jit import jit
from seatsim.kernel.generic import DamperModel, Motion, force, rates, scaling_at, step_state
from seatsim.kernel.hooks import MOST_DEBT, axpy, owe
from seatsim.kernel.inverse import total_force
from seatsim.kernel.loop import delay_of
from seatsim.kernel.step import relaxed
from seatsim.rig.coil import Coil
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling
from seatsim.schema.arrays import Array


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
    late, split, _ = delay_of(coil, step)
    out: Array = np.empty_like(command)
    out[0] = start
    for k in range(len(command) - 1):
        now = out[k]
        if split > 0.0:
            now = relaxed(coil, now, command[k - late - 1] if k > late else start, split)
        out[k + 1] = relaxed(coil, now, command[k - late] if k >= late else start, step - split)
    return out


_Samples = Array | tuple[float, float, float]
"""What goes on in a step: its value at the beginning, in the middle and at the end."""


class Course(NamedTuple):
    """Displacement [m], velocity [m/s] and current [A] of a damper over a step."""

    x: _Samples
    v: _Samples
    current: _Samples


TOLERANCE = 1e-4
"""Error of the force that a step may add by default, relative to the force plus `FORCE_SCALE`."""
FORCE_SCALE = 10.0
"""N added to the force that the tolerance is relative to, so that a force near zero needs no finer steps."""
MOST_PARTS = 4096
"""Most parts that a step is divided into; at 1 ms a part of 0.24 us, as short as any damper of the library needs."""
_MARGIN = 32.0
"""Half as many parts are tried once the error is this much below the tolerance; twice the 16 of a method of order 4."""
_DIVERGED = 1e8
"""Relative error at which a state has diverged; a NaN fails the same comparison."""


def run_bench(
    damper: DamperModel,
    factors: TemperatureFactors,
    x: Array,
    v: Array,
    current: Array,
    temperature: Array,
    initial_state: State,
    step: float,
    most_parts: int,
    tolerance: float,
    out: Array,
) -> int:
    """Fill `out`, shape (n + 1,), with the force in N every `step`; return the samples reached.

    x [m], v [m/s], current [A] and temperature [degC] have shape (2 n + 1,), sampled every half step;
    temperature is constant over a step. `initial_state` is the damper's at the first sample, `step` in s. The number
    returned is n + 1 on success; otherwise the damper's state has diverged at the last sample reached, or is too stiff
    (`seatsim.kernel.hooks`).
    Set-valued friction acts as `coulomb sgn(v)`, zero at v = 0. A step is divided into at most `most_parts` parts, so
    that it adds an error of `tolerance` at most, relative to the force plus `FORCE_SCALE`. To be compiled by
    `compiled`.
    """
    z = initial_state
    parts, debt = 1, 0.0
    now = temperature[0]
    factor = scaling_at(factors, now)
    for k in range(out.shape[0]):
        j = 2 * k
        if temperature[j] != now:
            now = temperature[j]
            factor = scaling_at(factors, now)
        out[k] = total_force(damper, x[j], v[j], current[j], factor, z)
        if k == out.shape[0] - 1:
            break
        if len(z) > 0:
            course = Course(x[j : j + 3], v[j : j + 3], current[j : j + 3])
            z, parts, good = advance_state(damper, factor, course, z, step, parts, most_parts, tolerance)
            debt = owe(debt, parts)
            if not good or debt > MOST_DEBT:
                return k + 1
    return int(out.shape[0])


@jit
def advance_state(
    damper: DamperModel,
    scaling: TemperatureScaling,
    course: Course,
    z: State,
    step: float,
    parts: int,
    most_parts: int,
    tolerance: float,
) -> tuple[State, int, bool]:
    """Return the state after a step, the parts to try next, and whether the state is still finite."""
    while True:
        state, worst = z, 0.0
        for part in range(parts):
            state, error = _part(damper, scaling, course, state, step / parts, part / parts, 1.0 / parts)
            if not error <= worst:
                worst = error
        if worst <= tolerance or parts >= most_parts:
            break
        parts *= 2
    if worst < tolerance / _MARGIN and parts > 1:
        parts //= 2
    return state, parts, worst < _DIVERGED


@jit
def _part(
    damper: DamperModel, scaling: TemperatureScaling, course: Course, z: State, h: float, s: float, ds: float
) -> tuple[State, float]:
    """Return the state after a part of `h` seconds from the fraction `s` of the step, and its relative error.

    The error is the difference in force to an embedded solution of order 3, as in the time loop.
    """
    end = _motion_at(course, s + ds)
    state, k4 = step_state(damper, z, _motion_at(course, s), _motion_at(course, s + 0.5 * ds), end, scaling, h)
    k5 = rates(damper, end.x, end.v, end.i, scaling, state)
    embedded = axpy(axpy(state, -h / 6.0, k4), h / 6.0, k5)
    got = force(damper, end.x, end.v, end.i, scaling, state)
    error = abs(got - force(damper, end.x, end.v, end.i, scaling, embedded))
    return state, error / (FORCE_SCALE + abs(got))


@jit
def _motion_at(course: Course, s: float) -> Motion:
    return Motion(_between(course.x, s), _between(course.v, s), _between(course.current, s))


@jit
def _between(samples: _Samples, s: float) -> float:
    """Return the parabola through three samples at the fraction `s` of the step; exact at 0, 1/2 and 1."""
    t = 1.0 - s
    value: float = t * (t - s) * samples[0] + 4.0 * s * t * samples[1] + s * (s - t) * samples[2]
    return value
