"""Search for the effects that explain a gap: screened by their sensitivities, fitted singly, then in sets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.fit import Engine, Point, State, solved
from seatsim.diagnosis.problem import POOL

Array = NDArray[np.float64]

SHORTLIST = 12
"""Candidates whose fit is begun after the screening for a first effect."""
SECONDS = 7
"""Candidates whose fit is begun after the screening for a further effect."""
FINALISTS = 4
"""Begun fits that are carried to their end."""
BEGUN = 2
"""Steps after which a fit is judged."""
BEAM = 2
"""Sets of each size from which the next larger ones are made."""
LARGEST = 3
"""Most effects of a set."""
STRETCH = 6.0
"""Largest factor by which a start is stretched after the screening."""
WORTHWHILE = 0.85
"""A larger set is looked for while the last enlargement lowered the excess to below this share."""


@dataclass(frozen=True)
class Search:
    """Fitted sets by size, best first; `sets[0]` holds the calibrated nominal scenario alone."""

    nominal: State
    sets: list[list[State]]
    rows: int

    @property
    def calibrated(self) -> State:
        """The nominal scenario with its nuisance parameters refitted."""
        return self.sets[0][0]

    def excess(self, state: State) -> float:
        """Return the whitened cost beyond what noise leaves, per number compared."""
        return max(state.cost / self.rows - 1.0, 0.0)


def search(engine: Engine, candidates: Sequence[Candidate], told: Callable[[str], None]) -> Search:
    """Fit the nuisance parameters alone, then single effects, then larger sets as long as they gain."""
    problem = engine.problem
    nominal = engine.states([Point(problem.rest)])[0]
    engine.refresh(nominal)
    calibrated = engine.fitted(nominal)
    engine.refresh(calibrated)
    calibrated = engine.fitted(calibrated)
    rows = sum(values.size for values in calibrated.whitened.values())
    found = Search(nominal, [[calibrated]], rows)
    for size in range(1, LARGEST + 1):
        told(f"fitting sets of {size}")
        sets = _extended(engine, found.sets[-1][:BEAM], candidates, SHORTLIST if size == 1 else SECONDS)
        if not sets:
            break
        engine.refresh(sets[0])
        sets[0] = engine.fitted(sets[0])
        found.sets.append(sets)
        if not _gains(found):
            break
    return found


def _gains(found: Search) -> bool:
    last, before = found.excess(found.sets[-1][0]), found.excess(found.sets[-2][0])
    return last > 0.02 and last < WORTHWHILE * before


def _extended(engine: Engine, bases: Sequence[State], candidates: Sequence[Candidate], count: int) -> list[State]:
    """Return the fitted enlargements of some sets by one effect, best first, one form of each set of effects."""
    begun = []
    for base in bases:
        taken = {term.effect for term in base.point.terms}
        offered = [c for c in candidates if c.effect not in taken]
        begun += [engine.fitted(start, BEGUN) for start in _screened(engine, base, offered)[:count]]
    ranked = _best_forms(begun)
    return _best_forms([engine.fitted(state) for state in ranked[:FINALISTS]] + ranked[FINALISTS:])


def _best_forms(states: Sequence[State]) -> list[State]:
    """Return the states in the order of their cost, the best one of each set of effects."""
    best: dict[frozenset[str], State] = {}
    for state in sorted(states, key=lambda state: state.cost):
        best.setdefault(frozenset(term.effect for term in state.point.terms), state)
    return list(best.values())


def _screened(engine: Engine, base: State, offered: Sequence[Candidate]) -> list[State]:
    """Return starts with each candidate added to a base, in the order of the cost that a linear model foresees."""
    starts = engine.states([_with(base.point, c, np.array(c.start)) for c in offered])
    own = engine.jacobian(base)
    foreseen = list(POOL.map(lambda start: _foreseen(engine, base, start, own), starts))
    order = sorted(range(len(starts)), key=lambda k: foreseen[k][0])
    better = []
    for k in order:
        stretch = foreseen[k][1]
        better.append(_stretched(base.point, offered[k], stretch))
    chosen = engine.states(better[: 2 * SHORTLIST])
    return [min(pair, key=lambda s: s.cost) for pair in zip(chosen, [starts[k] for k in order], strict=False)]


def _foreseen(engine: Engine, base: State, start: State, own: dict[str, Array]) -> tuple[float, float]:
    """Return the cost that a multiple of the start's change foresees, and that multiple."""
    if not np.isfinite(start.cost):
        return np.inf, 1.0
    vector = base.point.vector
    low, high = base.point.limits
    parts = []
    for run, residual in base.whitened.items():
        change = (residual - start.whitened[run]).ravel()
        parts.append(engine.gram(run, np.vstack([own[run], change]), residual))
    matrix, right = np.sum([part[0] for part in parts], axis=0), np.sum([part[1] for part in parts], axis=0)
    count = len(base.point.u)
    bounds = np.append(low, -STRETCH), np.append(high, STRETCH)
    step = solved(matrix, right, count, np.append(vector, 0.0), *bounds)
    return base.cost - 2.0 * float(step @ right) + float(step @ matrix @ step), float(step[-1])


def _stretched(point: Point, candidate: Candidate, factor: float) -> Point:
    """Return the point with a candidate whose first parameter is stretched, within its bounds."""
    values = np.array(candidate.start)
    if abs(factor) > 1e-3:
        values[0] = np.clip(values[0] * factor, candidate.low[0], candidate.high[0])
    return _with(point, candidate, values)


def _with(point: Point, candidate: Candidate, values: Array) -> Point:
    return Point(point.u, (*point.terms, candidate), (*point.values, values))
