"""Multi-start descent on the exact H-infinity norm, in scaled coordinates.

From every start: BFGS on the spectral abscissa until the loop is stable, then BFGS on log gamma, coarsely. The best few
are then lowered once, and the best of them to the end, by BFGS and polish in turn; where starts disagree, gains about
the best one follow.

Starts are no gain, projected state feedback, random gains over decades, and the single-step LMI. Random gains are drawn
in the user's units and in scaled ones in turn: states and signals in units of a like size make for short valleys, and
no rule tells whose units do.
Source: Apkarian & Noll 2006, IEEE Trans. Autom. Control 51:71; Burke, Henrion, Lewis & Overton 2006 (HIFOO).

BFGS has a weak Wolfe line search, which also works on functions with kinks. Values and the gradient of whatever side of
a kink it stands on are all that it needs, and where a step is rejected not even these: `function(x, ceiling)` may
answer with any value above `ceiling` where it exceeds that. Source: Lewis & Overton 2013, Math. Program. 141:135.

Polish of a kinked minimum: at a minimum several peaks (or several singular values of one) are equally high. With them
as separate smooth functions, SLSQP solves

    minimise t   subject to   sigma_i(K, omega_i) <= t,   |K| <= limit,   |K - K0| <= trust;

frequencies are then renewed at the answer, old ones kept, until the norm stands still.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import count
from typing import NamedTuple

import numpy as np
import scipy.linalg
from scipy.optimize import minimize

from controllers.synthesis.norm import find_local_peaks, hinf_norm, largest_singular_values
from controllers.synthesis.objective import STABILITY_MARGIN, NormObjective, differentiate_singular_values
from controllers.synthesis.plant import GeneralisedPlant
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


def _polish(objective: NormObjective, entries: Array, deadline: float) -> Array:
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


Function = Callable[[Array, float], tuple[float, Array]]

# The usual weak Wolfe constants. The curvature condition is loose on purpose: at a kink a strong one cannot be met.
_ARMIJO, _CURVATURE = 1e-4, 0.5
# Each step halves or doubles: 40 of them span twelve decades of step length.
_LINE_STEPS = 40


class _Iterate(NamedTuple):
    """A place with the function's value and gradient there."""

    x: Array
    value: float
    gradient: Array


def minimise(
    function: Function,
    start: Array,
    unit: Array,
    deadline: float,
    enough: float = -np.inf,
    patience: int = 20,
    progress: float = 1e-6,
    iterations: int = 1000,
) -> _Iterate:
    """Descend from `start`, where `function` must be finite; the first steps are steepest in x / unit.

    Args:
        function: value and gradient (n,) at x (n,); above `ceiling` the value need only exceed it.
        start: where to begin, (n,).
        unit: natural size of a change of every entry, (n,).
        deadline: by `time.monotonic()`.
        enough: the search ends at this value or below.
        patience: number of steps that together must gain `progress`, else the search ends.
        progress: least gain of so many steps, in the value's unit.
        iterations: most steps.

    Returns:
        The lowest point found, which no step lowered or one of the limits stopped.
    """
    here = _Iterate(start, *function(start, np.inf))
    inverse = first = np.diag(unit**2)
    history, fresh = [here.value], True
    for _ in range(iterations):
        if here.value <= enough or not np.any(here.gradient) or time.monotonic() > deadline:
            break
        following = _line_search(function, here, -inverse @ here.gradient)
        if following is None:
            # Steepest descent found nothing either: a minimum, or a kink that no direction leaves.
            if fresh:
                break
            inverse, fresh = first, True
            continue
        inverse = _update(inverse, here, following, fresh)
        here, fresh = following, False
        history.append(here.value)
        if len(history) > patience and history[-1 - patience] - here.value < progress:
            break
    return here


def _line_search(function: Function, here: _Iterate, direction: Array) -> _Iterate | None:
    """Find a point with sufficient decrease and a flatter slope; None where nothing lower is found."""
    slope = float(here.gradient @ direction)
    if not slope < 0:
        return None
    low, high, step = 0.0, np.inf, 1.0
    lowest: _Iterate | None = None
    for _ in range(_LINE_STEPS):
        x, ceiling = here.x + step * direction, here.value + _ARMIJO * step * slope
        trial = _Iterate(x, *function(x, ceiling))
        if not trial.value < ceiling:
            high = step
        else:
            lowest, low = trial, step
            if trial.gradient @ direction >= _CURVATURE * slope:
                return trial
        step = (low + high) / 2 if np.isfinite(high) else 2 * low
    return lowest


def _update(inverse: Array, here: _Iterate, following: _Iterate, fresh: bool) -> Array:
    """BFGS update of the inverse Hessian; the first one also sets its scale."""
    s, y = following.x - here.x, following.gradient - here.gradient
    curvature = float(s @ y)
    # Without curvature the update would lose positive definiteness, and with it descent.
    if not curvature > 1e-14 * float(np.linalg.norm(s) * np.linalg.norm(y)):
        return inverse
    if fresh:
        inverse = inverse * curvature / float(y @ inverse @ y)
    Hy = inverse @ y
    along = (1 + float(y @ Hy) / curvature) * np.outer(s, s)
    return np.asarray(inverse + (along - np.outer(Hy, s) - np.outer(s, Hy)) / curvature)


# Spread of the random gains: shallow basins lie at any of these.
_SPREADS = (1.0, 10.0, 0.1, 100.0)
_SCALED_SPREADS = (1.0, 100.0, 10.0, 1000.0)
_DECADES = (-1.5, 1.5)


class StartingGain(NamedTuple):
    """A gain and the sizes of the first changes from it, (nu, ny) each, in scaled coordinates."""

    gain: Array
    unit: Array


def generate_starting_gains(plants: Sequence[GeneralisedPlant], unit: Array, seed: int) -> Iterator[StartingGain]:
    """Yield starts without end, the same ones for the same seed; `unit` is the user's, in scaled coordinates."""
    free = plants[0].free
    ones = np.ones(free.shape)
    yield StartingGain(np.zeros(free.shape), unit)
    yield from (StartingGain(gain, ones) for gain in map(project_state_feedback, plants) if gain is not None)
    random = np.random.default_rng(seed)
    for k in count():
        for own, spreads in ((unit, _SPREADS), (ones, _SCALED_SPREADS)):
            size = spreads[k % len(spreads)] * own
            yield StartingGain(size * random.standard_normal(free.shape) * free, size)
        # Entries over decades of their own: some valleys join large gains with small ones.
        size = (ones, unit)[k % 2] * 10 ** random.uniform(*_DECADES, free.shape)
        yield StartingGain(random.choice([-1.0, 1.0], free.shape) * size * free, size)


def project_state_feedback(plant: GeneralisedPlant) -> Array | None:
    """Return the output feedback nearest to the linear-quadratic state feedback, K = -B2'P pinv(C2); None without P."""
    try:
        P = scipy.linalg.solve_continuous_are(plant.A, plant.B2, np.eye(plant.order), np.eye(plant.control_count))
    except np.linalg.LinAlgError:
        return None
    # u = -B2'P x is the optimum of the full state; the pseudo-inverse reads the state off y as well as y can tell.
    return np.asarray(-plant.B2.T @ P @ np.linalg.pinv(plant.C2) * plant.free)


# A loop this stable (in scaled time) is ready for the descent on its norm.
_STABLE_ENOUGH = -1e-2
# Stabilising may be slow where several poles are nearly rightmost, and giving up loses the start.
_STABILISING_PATIENCE = 60
# Gain in log gamma below which descents end: coarse to tell valleys apart, fine to reach their floor.
_COARSE, _FINE = 1e-4, 1e-6
# Valleys that are lowered further, which costs more than to find them.
_REFINED = 6
# Candidates nearer to each other than this are taken for one valley: the coarse descent leaves as much.
_SAME = 2e-3
# Most turns of BFGS and polish; they end earlier where both together gain nothing.
_TURNS = 8
# Relative spread of the gains about the best one; rounds go on until this many in a row gain nothing.
_ABOUT = (0.1, 0.5, 2.0, 10.0)
_FRUITLESS = 2


class StabilisingGain(NamedTuple):
    """Free entries of a stabilising gain and the norm of its loop."""

    gamma: float
    entries: Array


def _gamma(candidate: StabilisingGain) -> float:
    return candidate.gamma


class Descent(NamedTuple):
    """Candidates, best first; where there are none, `abscissa` tells how near to stability the search came.

    `starts` counts what was tried.
    """

    candidates: list[StabilisingGain]
    abscissa: float
    starts: int

    @property
    def gamma(self) -> float:
        """The lowest norm, infinite where no candidate is there."""
        return self.candidates[0].gamma if self.candidates else np.inf

    @property
    def agrees(self) -> bool:
        """Whether every start led to the same value."""
        return len(self.candidates) == self.starts and len(_distinct(self.candidates)) == 1

    def with_more(self, more: Descent) -> Descent:
        """Put two explorations together."""
        candidates = sorted([*self.candidates, *more.candidates], key=_gamma)
        return Descent(candidates, min(self.abscissa, more.abscissa), self.starts + more.starts)


def explore(objective: NormObjective, starts: Iterable[StartingGain], deadline: float) -> Descent:
    """Descend coarsely from every start until the deadline."""
    candidates: list[StabilisingGain] = []
    abscissa, tried = float("inf"), 0
    for start in starts:
        theta, unit = objective.angles(start.gain[objective.free]), start.unit[objective.free]
        point = minimise(objective.abscissa, theta, unit, deadline, _STABLE_ENOUGH, _STABILISING_PATIENCE, 1e-4)
        abscissa, tried = min(abscissa, point.value), tried + 1
        if point.value < -STABILITY_MARGIN:
            lowest = minimise(objective.log_norm, point.x, unit, deadline, progress=_COARSE)
            entries = objective.entries(lowest.x)
            candidates.append(StabilisingGain(objective.norm(entries), entries))
        if time.monotonic() > deadline:
            break
    return Descent(sorted(candidates, key=_gamma), abscissa, tried)


def refine(objective: NormObjective, candidates: list[StabilisingGain], deadline: float) -> StabilisingGain:
    """Lower the best few candidates, of those in one valley only one, and the best of them to the end; return it."""
    valleys = _distinct(sorted(candidates, key=_gamma))[:_REFINED]
    best = min((_lower(objective, candidate, deadline) for candidate in valleys), key=_gamma)
    for _ in range(_TURNS):
        before, best = best, _lower(objective, best, deadline)
        if best.gamma >= before.gamma * (1 - _FINE) or time.monotonic() > deadline:
            break
    return best


def improve(objective: NormObjective, best: StabilisingGain, seed: int, deadline: float) -> StabilisingGain:
    """Descend from gains scattered about the best one, until rounds in a row gain nothing."""
    random, fruitless = np.random.default_rng(seed), 0
    while fruitless < _FRUITLESS and time.monotonic() < deadline and best.gamma > 0:
        sizes = objective.sizes(best.entries)
        step = random.standard_normal((len(_ABOUT), objective.size)) * np.array(_ABOUT)[:, None]
        places = best.entries + step * sizes
        scattered = [StartingGain(objective.gain(entries), objective.gain(sizes)) for entries in places]
        found = explore(objective, scattered, deadline)
        lower = refine(objective, [best, *found.candidates], deadline)
        fruitless = 0 if lower.gamma < best.gamma * (1 - _COARSE) else fruitless + 1
        best = lower
    return best


def _distinct(candidates: list[StabilisingGain]) -> list[StabilisingGain]:
    """Candidates, best first, whose gamma differs by more than the coarse descent may leave."""
    kept = candidates[:1]
    for candidate in candidates:
        if candidate.gamma > kept[-1].gamma * (1 + _SAME):
            kept.append(candidate)
    return kept


def _lower(objective: NormObjective, candidate: StabilisingGain, deadline: float) -> StabilisingGain:
    """BFGS, then polish, which goes on along the kinks where BFGS ends."""
    unit = objective.sizes(candidate.entries)
    angles = objective.angles(candidate.entries)
    point = minimise(objective.log_norm, angles, unit, deadline, progress=_FINE)
    entries = _polish(objective, objective.entries(point.x), deadline)
    return min(candidate, StabilisingGain(objective.norm(entries), entries), key=_gamma)
