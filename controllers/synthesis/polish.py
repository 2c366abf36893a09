"""Polish of a kinked minimum: sequential quadratic programming over the peaks that hold the norm up.

At a minimum several peaks (or several singular values of one) are equally high. With them as separate smooth functions,

    minimise t   subject to   sigma_i(K, omega_i) <= t,   |K| <= limit,   |K - K0| <= trust,

solved by SLSQP; frequencies are then renewed at the answer, old ones kept, until the norm stands still.
"""

from __future__ import annotations

import time
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.optimize import minimize

from controllers.synthesis.norm import hinf_norm, largest_gains, local_peaks
from controllers.synthesis.objective import STABILITY_MARGIN, Objective
from controllers.synthesis.plant import Array

_ROUNDS = 40
_ACTIVE = 0.9
_TRUST = 0.3
_WIDEST = 10.0
_POOR, _GOOD = 0.1, 0.75
_PROGRESS = 1e-7


def polish(objective: Objective, entries: Array, deadline: float) -> Array:
    """Return free entries whose norm is no higher than at `entries`; unstable ones come back as they are."""
    level = _norm(objective, entries)
    if not 0 < level < np.inf:
        return entries
    frequencies = _peaks(objective, entries)
    trust = _TRUST
    for _ in range(_ROUNDS):
        if time.monotonic() > deadline or level == 0:
            break
        trial, promised = _solve(objective, entries, frequencies, level, trust)
        reached = _norm(objective, trial)
        if promised > level * (1 - _PROGRESS):
            break
        if np.isfinite(reached):
            frequencies = _renewed(objective, trial, frequencies)
        agreement = (level - reached) / (level - promised)
        trust = trust / 4 if agreement < _POOR else min(2 * trust, _WIDEST) if agreement > _GOOD else trust
        if reached < level:
            entries, level = trial, reached
    return entries


def _norm(objective: Objective, entries: Array) -> float:
    loop = objective.loop(entries)
    return np.inf if loop.abscissa >= -STABILITY_MARGIN else hinf_norm(loop).value


def _peaks(objective: Objective, entries: Array) -> Array:
    loop = objective.loop(entries)
    return np.unique([peak.frequency for peak in [hinf_norm(loop), *local_peaks(loop, _ACTIVE)]])


def _renewed(objective: Objective, entries: Array, old: Array) -> Array:
    """Frequencies of the peaks now, and those old ones that are still nearly as high and not about the same."""
    values = largest_gains(objective.loop(entries), old)
    new = _peaks(objective, entries)
    apart = ~np.isclose(old[:, None], new, rtol=1e-5, atol=1e-9).any(axis=1)
    return np.concatenate([new, old[apart & (values >= _ACTIVE * values.max())]])


def _solve(objective: Objective, entries: Array, frequencies: Array, level: float, trust: float) -> tuple[Array, float]:
    """Lower the highest peak at fixed frequencies; return entries and that peak. Variables: steps, t / level - 1."""
    largest = np.abs(entries).max()
    unit = np.maximum(np.abs(entries), 0.1 * largest) if largest > 0 else np.ones(len(entries))
    low = np.maximum((-objective.limits - entries) / unit, -trust)
    high = np.minimum((objective.limits - entries) / unit, trust)
    count = min(2, *objective.plant.D11.shape)

    @lru_cache(maxsize=1)
    def room(point: bytes) -> tuple[Array, Array]:
        x = np.frombuffer(point)
        values, slopes = objective.singular_values(objective.loop(entries + unit * x[:-1]), frequencies, count)
        by_step = slopes[..., objective.free].reshape(values.size, -1) * unit / level
        return 1 + x[-1] - values.ravel() / level, np.hstack([-by_step, np.ones((values.size, 1))])

    try:
        found: Any = minimize(  # type: ignore[call-overload]
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
    step = np.clip(found.x[:-1], low, high)
    values, _ = objective.singular_values(objective.loop(entries + unit * step), frequencies, 1)
    return entries + unit * step, float(values.max())
