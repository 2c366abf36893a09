"""What no damper can do better: the Lagrangian's minimum, at multipliers that raise it as far as they can.

Whatever the multipliers, the minimum is a bound, so that stopping early costs tightness and nothing else. They are hat
functions of time; their logarithms are ascended (L-BFGS) with the logarithm of the determinant of the Lagrangian's
Hessian as a barrier, which shrinks stage by stage.

What the damper can do at a speed, its least and largest dissipative force, is between straight lines (`fit_envelope`).
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from controllers.clairvoyant.problem import HeldForceProblem, LagrangianMinimum
from controllers.clairvoyant.recursion import ForceBand
from seatsim.scenario.scenario import DamperChoice
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.simulation.damper_bench import sine_test

if TYPE_CHECKING:
    from scipy.sparse import csr_array


_SPACING = 0.02
"""s between the nodes of the multipliers."""
SHARES = (0.3, 0.1, 0.03, 0.01)
"""Sizes of the barrier over the criterion, stage by stage."""
STEPS = 120
"""Most steps of a barrier."""
# Pairs kept by L-BFGS; largest change of a logarithm in one step; relative gain that ends an ascent, once the memory is
# full; change of all logarithms while a start has no minimum: weaker multipliers are nearer to the convex criterion.
_MEMORY, _LONGEST, _SETTLED, _RETREAT = 30, 2.0, 1e-8, 0.1
_NU = 1e-9  # of the criterion a N^2, where the ascent starts

_DualFunction = Callable[[Array], tuple[float, Array] | None]


class LowerBound(NamedTuple):
    """A lower bound of J, the logarithms of the multipliers (3 nodes,), and the law (N, n+1) that L is least under."""

    value: float
    logarithms: Array
    gain: Array


def find_lower_bound(problem: HeldForceProblem, band: ForceBand, size: float, start: Array | None = None) -> LowerBound:
    """Return a lower bound of J over all forces between the lines.

    `size` is about J; `start` are the logarithms found at another weight.
    """
    hats = _build_hat_functions(problem.intervals, problem.transcription.step)

    def minimise(y: Array, barrier: float = 0.0) -> LagrangianMinimum | None:
        multipliers = np.ascontiguousarray((hats @ np.exp(y.reshape(3, -1)).T).T)
        return problem.minimise_lagrangian(band, multipliers, barrier)

    def evaluate(y: Array) -> LowerBound | None:
        return LowerBound(found.bound, y, found.gain) if (found := minimise(y)) else None

    def raise_with(barrier: float, y: Array) -> tuple[float, Array] | None:
        if (found := minimise(y, barrier)) is None:
            return None
        return found.bound + barrier * found.barrier, np.ravel((found.by @ hats) * np.exp(y.reshape(3, -1)))

    y = start
    if y is None:
        # The best of some multipliers that do not change with time: they bound the energy of the whole record.
        share = size / (problem.intervals * problem.transcription.step)
        levels = np.geomspace(1e-4, 1e-1, 10)
        tried = (np.log(np.repeat([0.5 * x * share, 0.5 * x * share, _NU * share], hats.shape[1])) for x in levels)
        bounds = [bound for bound in map(evaluate, tried) if bound]
        # Of equal ones the last, at the highest level.
        y = max(reversed(bounds), key=lambda bound: bound.value).logarithms
    while (best := evaluate(y)) is None:
        y = y - _RETREAT
    for share in SHARES:
        y = _ascend(partial(raise_with, share * size / problem.intervals), best.logarithms)
        reached = evaluate(y)
        if reached and reached.value > best.value:
            best = reached
    return best


def _build_hat_functions(count: int, step: float) -> csr_array:
    """Return what the hat functions of unit density sum up to in each of `count` intervals, shape (count, nodes)."""
    from scipy.sparse import csr_array

    place = step / _SPACING * (np.arange(count) + 0.5)
    left = place.astype(int)
    values = step * np.concatenate([left + 1 - place, place - left])
    places = np.tile(np.arange(count), 2), np.append(left, left + 1)
    return csr_array((values, places), shape=(count, math.ceil(count * step / _SPACING - 1e-9) + 1))


def _ascend(objective: _DualFunction, y: Array) -> Array:
    """Return where L-BFGS with backtracking comes to in `STEPS` steps, or when it settles."""
    if (here := objective(y)) is None:
        return y
    value, gradient = here
    pairs: deque[tuple[Array, Array]] = deque(maxlen=_MEMORY)
    for _ in range(STEPS):
        direction = _find_direction(gradient, pairs)
        length, found = 1.0, None
        while length > 1e-6:
            found = objective(y + length * direction)
            if found and found[0] >= value + 1e-4 * length * (direction @ gradient):
                break
            length, found = 0.4 * length, None
        if found is None:
            break
        step, bend = length * direction, gradient - found[1]
        if step @ bend > 0:
            pairs.append((step, bend))
        y, gained = y + step, found[0] - value
        value, gradient = found
        if gained < _SETTLED * abs(value) and len(pairs) == _MEMORY:
            break
    return y


def _find_direction(gradient: Array, pairs: deque[tuple[Array, Array]]) -> Array:
    """Return the quasi-Newton direction (Nocedal and Wright, algorithm 7.4), no entry above `_LONGEST`."""
    q, kept = gradient.copy(), []
    for step, bend in reversed(pairs):
        factor = (step @ q) / (step @ bend)
        kept.append(factor)
        q -= factor * bend
    if pairs:
        step, bend = pairs[-1]
        q *= (step @ bend) / (bend @ bend)
    else:
        q *= 0.1 / np.max(np.abs(q))
    for (step, bend), factor in zip(pairs, reversed(kept), strict=True):
        q += step * (factor - (bend @ q) / (step @ bend))
    return np.asarray(q * min(1.0, _LONGEST / float(np.max(np.abs(q)))))


TOP = 1.5
"""m/s; speed up to which the lines hold."""
SPEEDS = np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.2, TOP])
CURRENTS, _SLOPES = 9, 201  # grids of the current and of the strip's slope, which is found to half a percent
_STROKE, _FASTEST = 0.02, 2.0  # m and Hz: friction has its full size, and internal flows settle


class DamperEnvelope(NamedTuple):
    """Lines that hold every force of the damper between them (`outer`), and lines between which it has all (`inner`).

    They are about the same for a damper whose steady force is a viscous and a friction part.
    """

    outer: ForceBand
    inner: ForceBand


def fit_envelope(damper: DamperChoice, max_current: float, temperature: float) -> DamperEnvelope:
    """Return the lines of a damper's steady force, at 0 to `max_current` A and a temperature in degC.

    The steady force at a speed is that of a sine test at its peak velocity, either way, where hysteresis is saturated
    and elastic parts are without force. The lines hold to TOP m/s.

    Raises:
        InputError: the damper is not dissipative there, or has no force to choose from.
    """
    currents = np.linspace(0, max_current, CURRENTS)
    forces = np.array([[_measure_steady_force(damper, v, i, temperature) for i in currents] for v in SPEEDS])
    least, most = forces.min(axis=1), forces.max(axis=1)
    driving = (least < 0).any(axis=1)
    if driving.any():
        raise InputError(
            f"the damper drives instead of damping at {SPEEDS[driving][0]:g} m/s (an offset of its force?); the bracket"
            " is of dissipative dampers"
        )
    speeds = SPEEDS[:, None]
    c = max(0.0, min(float(np.polyfit(SPEEDS, least.mean(axis=1), 1)[0]), float((least / speeds).min())))
    b = max(0.0, float(np.polyfit(SPEEDS, most.mean(axis=1), 1)[0]))
    weakest, strongest = least - c * speeds, most - b * speeds
    inner = ForceBand(c, float(weakest.max()), b, float(strongest.min()))
    if inner.a <= inner.f or inner.a + inner.b * TOP <= inner.f + inner.c * TOP:
        raise InputError("the damper's forces at no and at full current do not leave a straight band between them")
    # Of all strips that hold the forces, the narrowest: a wide one would loosen the bound at every speed.
    # Its half width is the least `a` with `abs(F - slope w) <= a`: the bound's third multiplier is of a strip.
    slopes = np.linspace(0, b, _SLOPES)
    a, slope = min((max((most - x * speeds).max(), (x * speeds - least).max()), x) for x in slopes)
    return DamperEnvelope(ForceBand(c, float(weakest.min()), float(slope), float(a)), inner)


def _measure_steady_force(damper: DamperChoice, speed: float, current: float, temperature: float) -> Array:
    """Return the resisting force in N while extending and while compressing."""
    stroke = max(_STROKE, speed / (2 * np.pi * _FASTEST))
    test = sine_test(damper.record, stroke, speed / (2 * np.pi * stroke), current, temperature, damper.factors)
    return np.array([test.force[0], -test.force[len(test.force) // 2]])
