"""Polish of a kinked minimum: sequential quadratic programming over the peaks that hold the norm up.

At a minimum several peaks (or several singular values of one) are equally high. With them as separate smooth functions,

    minimise t   subject to   sigma_i(K, omega_i) <= t,   |K| <= limit,   |K - K0| <= trust,

solved by SLSQP; frequencies are then renewed at the answer, old ones kept, until the norm stands still.
"""

from __future__ import annotations

import time
from functools import lru_cache

import numpy as np
from scipy.optimize import minimize

from controllers.synthesis.norm import find_local_peaks, hinf_norm, largest_singular_values
from controllers.synthesis.objective import NormObjective, differentiate_singular_values
from seatsim.schema.arrays import Array

_ROUNDS = 40
# Peaks this near to the highest can become the highest within a step, so that each is a constraint.
_ACTIVE = 0.9
# First and widest relative change of a gain in one round: the model is of first order.
_TRUST = 0.3
_WIDEST = 10.0
# Reached over promised gain below which the trust region shrinks, and above which it grows (the usual values).
_POOR, _GOOD = 0.1, 0.75
# A step that promises less is not worth an evaluation of the norm.
_PROGRESS = 1e-7


def polish(objective: NormObjective, entries: Array, deadline: float) -> Array:
    """Return free entries whose norm is no higher than at `entries`; unstable ones come back as they are."""
    level = objective.norm(entries)
    if not 0 < level < np.inf:
        return entries
    frequencies = _peaks(objective, entries, level)
    trust = _TRUST
    for _ in range(_ROUNDS):
        if time.monotonic() > deadline or level == 0:
            break
        trial, promised = _solve(objective, entries, frequencies, level, trust)
        reached = objective.norm(trial)
        if promised > level * (1 - _PROGRESS):
            break
        if np.isfinite(reached):
            frequencies = _renewed(objective, trial, frequencies, reached)
        agreement = (level - reached) / (level - promised)
        trust = trust / 4 if agreement < _POOR else min(2 * trust, _WIDEST) if agreement > _GOOD else trust
        if reached < level:
            entries, level = trial, reached
    return entries


def _peaks(objective: NormObjective, entries: Array, level: float) -> list[Array]:
    """Frequencies of the active peaks of every plant; none of a plant that stays well below `level`."""
    found = []
    for loop in objective.loops(entries):
        highest = hinf_norm(loop)
        peaks = [highest, *find_local_peaks(loop, _ACTIVE)] if highest.value >= _ACTIVE * level else []
        found.append(np.unique([peak.frequency for peak in peaks]))
    return found


def _renewed(objective: NormObjective, entries: Array, known: list[Array], level: float) -> list[Array]:
    """Frequencies of the peaks now, and those known ones that are still nearly as high and not about the same."""
    renewed = []
    peaks = _peaks(objective, entries, level)
    for loop, old, new in zip(objective.loops(entries), known, peaks, strict=True):
        apart = ~np.isclose(old[:, None], new, rtol=1e-5, atol=1e-9).any(axis=1)
        high = largest_singular_values(loop, old) >= _ACTIVE * level
        renewed.append(np.append(new, old[apart & high]))
    return renewed


def _solve(
    objective: NormObjective, entries: Array, frequencies: list[Array], level: float, trust: float
) -> tuple[Array, float]:
    """Lower the highest peak at fixed frequencies; return entries and that peak. Variables: steps, t / level - 1."""
    unit = objective.sizes(entries)
    low = np.maximum((-objective.limit - entries) / unit, -trust)
    high = np.minimum((objective.limit - entries) / unit, trust)

    @lru_cache(maxsize=1)
    def room(point: bytes) -> tuple[Array, Array]:
        x = np.frombuffer(point)
        values, slopes = _values(objective, entries + unit * x[:-1], frequencies)
        return 1 + x[-1] - values / level, np.hstack([-slopes * unit / level, np.ones((values.size, 1))])

    try:
        found = minimize(  # type: ignore[call-overload]  # a dict of constraints
            lambda x: x[-1],
            np.zeros(len(entries) + 1),
            jac=lambda x: np.eye(len(x))[-1],
            method="SLSQP",
            bounds=[*zip(low, high, strict=True), (None, None)],
            constraints={"type": "ineq", "fun": lambda x: room(x.tobytes())[0], "jac": lambda x: room(x.tobytes())[1]},
            options={"maxiter": 50, "ftol": 1e-12},
        )
    except np.linalg.LinAlgError:
        # A trial loop has a pole at one of the frequencies: nothing to gain this way.
        return entries, level
    step = np.clip(np.asarray(found.x)[:-1], low, high)
    values, _ = _values(objective, entries + unit * step, frequencies)
    return entries + unit * step, float(values.max())


def _values(objective: NormObjective, entries: Array, frequencies: list[Array]) -> tuple[Array, Array]:
    """Two largest singular values at the frequencies of every plant, and their slopes by the entries."""
    values, slopes = [], []
    for plant, loop, omega in zip(objective.plants, objective.loops(entries), frequencies, strict=True):
        if len(omega):
            v, s = differentiate_singular_values(plant, loop, omega, min(2, *plant.D11.shape))
            values.append(v.ravel())
            slopes.append(s[..., objective.free].reshape(v.size, -1))
    return np.concatenate(values), np.concatenate(slopes)
