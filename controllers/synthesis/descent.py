"""Multi-start descent on the exact H-infinity norm, in scaled coordinates.

From every start: BFGS on the spectral abscissa until the loop is stable, then BFGS on log gamma, coarsely. The best
few are then lowered to the end, by BFGS and polish in turn; where starts disagree, gains about the best one follow.
Source: Apkarian & Noll 2006, IEEE Trans. Autom. Control 51:71; Burke, Henrion, Lewis & Overton 2006 (HIFOO).
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from controllers.synthesis.bfgs import HOPE, minimise
from controllers.synthesis.objective import STABILITY_MARGIN, NormObjective
from controllers.synthesis.polish import polish
from controllers.synthesis.starts import StartingGain
from seatsim.schema.arrays import Array

# A loop this stable (in scaled time) is ready for the descent on its norm.
_STABLE_ENOUGH = -1e-2
# Stabilising may be slow where several poles are nearly rightmost, and giving up loses the start.
_STABILISING_PATIENCE = 60
# Gain in log gamma below which descents end: coarse to tell valleys apart, fine to reach their floor.
_COARSE, _FINE = 1e-4, 1e-6
# Valleys that are followed to the end, which costs more than to find them.
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


def _log(gamma: float) -> float:
    return math.log(gamma) if gamma > 0.0 else -math.inf


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


def explore(objective: NormObjective, starts: Iterable[StartingGain], deadline: float, best: float = np.inf) -> Descent:
    """Descend coarsely from every start until the deadline; `best` is the lowest gamma known before."""
    candidates: list[StabilisingGain] = []
    abscissa, tried = float("inf"), 0
    for start in starts:
        theta, unit = objective.angles(start.gain[objective.free]), start.unit[objective.free]
        point = minimise(objective.abscissa, theta, unit, deadline, _STABLE_ENOUGH, _STABILISING_PATIENCE, 1e-4)
        abscissa, tried = min(abscissa, point.value), tried + 1
        if point.value < -STABILITY_MARGIN:
            lowest = minimise(objective.log_norm, point.x, unit, deadline, progress=_COARSE, target=_log(best))
            entries = objective.entries(lowest.x)
            candidates.append(StabilisingGain(objective.norm(entries), entries))
            best = min(best, candidates[-1].gamma)
        if time.monotonic() > deadline:
            break
    return Descent(sorted(candidates, key=_gamma), abscissa, tried)


def refine(objective: NormObjective, candidates: list[StabilisingGain], deadline: float) -> StabilisingGain:
    """Lower the best few candidates to the end and return the best; of those in one valley, only one."""
    first, *others = _distinct(sorted(candidates, key=_gamma))[:_REFINED]
    best = _lower(objective, first, np.inf, deadline)
    for candidate in others:
        best = min(best, _lower(objective, candidate, best.gamma, deadline), key=_gamma)
    return best


def improve(objective: NormObjective, best: StabilisingGain, seed: int, deadline: float) -> StabilisingGain:
    """Descend from gains scattered about the best one, until rounds in a row gain nothing."""
    random = np.random.default_rng(seed)
    fruitless = 0
    while fruitless < _FRUITLESS and time.monotonic() < deadline and best.gamma > 0:
        sizes = objective.sizes(best.entries)
        step = random.standard_normal((len(_ABOUT), objective.size)) * np.array(_ABOUT)[:, None]
        places = best.entries + step * sizes
        scattered = [StartingGain(objective.gain(entries), objective.gain(sizes)) for entries in places]
        found = explore(objective, scattered, deadline, best.gamma)
        lower = refine(objective, [best, *found.candidates], deadline)
        fruitless = 0 if lower.gamma < best.gamma * (1 - _COARSE) else fruitless + 1
        best = lower
    return best


def _distinct(candidates: list[StabilisingGain]) -> list[StabilisingGain]:
    """Candidates, best first, whose gamma differs by more than the coarse descent may leave."""
    kept: list[StabilisingGain] = []
    for candidate in candidates:
        if not kept or candidate.gamma > kept[-1].gamma * (1 + _SAME):
            kept.append(candidate)
    return kept


def _lower(objective: NormObjective, candidate: StabilisingGain, target: float, deadline: float) -> StabilisingGain:
    """BFGS and polish in turn, until both together gain nothing or too little to come below `target`."""
    for _ in range(_TURNS):
        unit = objective.sizes(candidate.entries)
        angles = objective.angles(candidate.entries)
        point = minimise(objective.log_norm, angles, unit, deadline, progress=_FINE, target=_log(target))
        entries = polish(objective, objective.entries(point.x), deadline)
        lower = StabilisingGain(objective.norm(entries), entries)
        gained = candidate.gamma - lower.gamma
        candidate = min(candidate, lower, key=_gamma)
        hopeless = candidate.gamma - target > HOPE * gained
        if gained <= _FINE * candidate.gamma or hopeless or time.monotonic() > deadline:
            break
    return candidate
