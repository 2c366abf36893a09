"""Search for the effects that explain a gap: screened by their sensitivities, fitted singly, then in sets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.fit import Engine, Point, State, solved
from seatsim.diagnosis.problem import POOL

Array = NDArray[np.float64]
Trace = tuple[Candidate, dict[str, Array]]
"""A candidate and what it, as it starts, changes in the whitened outputs of each run."""

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
RIVAL = 1.5
"""Factor on the cost of an effect, or of a set, within which another is tried in its place."""
RIVALS = 3
"""Effects that are tried in the place of each one."""
AROUND = (0.6, 1.0, 1.6)
"""Shares of that factor that are tried."""
WEAKER = (1.08, 1.16, 1.27)
"""Factors that are tried on a limit that acts too much, and their inverses on one that acts too little."""
NOTHING = 0.15
"""Excess below which nothing is left to explain."""
SEEN = 1e-3
"""Factor on a start from which its trace is in the data at all."""
PROMISING = 0.9
"""Share of the excess so far that a further effect may leave, as a linear model foresees it, for it to be tried."""
ENLARGE = 0.45
"""Share of the excess that a further effect must leave at most."""
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


def search(
    engine: Engine, candidates: Sequence[Candidate], progress: Callable[[str], None], largest: int = LARGEST
) -> Search:
    """Fit the nuisance parameters alone, then single effects, then larger sets as long as they gain."""
    problem = engine.problem
    nominal = engine.states([Point(problem.rest)])[0]
    engine.refresh(nominal)
    calibrated = engine.fitted(nominal)
    engine.refresh(calibrated)
    calibrated = engine.fitted(calibrated)
    rows = sum(values.size for values in calibrated.whitened.values())
    traces = _traces(engine, calibrated, candidates)
    found = Search(nominal, [[calibrated]], rows)
    for size in range(1, largest + 1):
        progress(f"fitting sets of {size}")
        sets = _extended(engine, found, traces, SHORTLIST if size == 1 else SECONDS)
        if not sets:
            break
        if size > 1:
            sets = _best_forms([*sets, *_exchanged(engine, sets[0], found.sets[1])])
        engine.refresh(sets[0])
        sets[0] = engine.fitted(sets[0])
        found.sets.append(sets)
        if not _gains(found):
            break
    if len(found.sets) > LARGEST and found.excess(found.sets[-1][0]) < ENLARGE * found.excess(found.sets[-2][0]):
        progress("pruning")
        found.sets[-2] = _best_forms([*found.sets[-2], *_pruned(engine, found.sets[-1][0])])
    return found


def _gains(found: Search) -> bool:
    last, before = found.excess(found.sets[-1][0]), found.excess(found.sets[-2][0])
    return last > NOTHING and last < WORTHWHILE * before


def _traces(engine: Engine, calibrated: State, candidates: Sequence[Candidate]) -> list[Trace]:
    """Return what each candidate, as it starts, changes in the calibrated scenario."""
    starts = engine.states([calibrated.point.plus(c, np.array(c.start)) for c in candidates])
    return [
        (candidate, {run: base - start.whitened[run] for run, base in calibrated.whitened.items()})
        for candidate, start in zip(candidates, starts, strict=True) if np.isfinite(start.cost)
    ]  # fmt: skip


def _extended(engine: Engine, found: Search, traces: Sequence[Trace], count: int) -> list[State]:
    """Return the fitted enlargements of the best sets by one effect, best first, one form of each set of effects."""
    bases, begun = found.sets[-1][:BEAM], []
    for base in bases:
        taken = {term.effect for term in base.point.terms}
        offered = [trace for trace in traces if trace[0].effect not in taken]
        bound = found.rows * (1.0 + PROMISING * found.excess(bases[0])) if taken else np.inf
        begun += [engine.fitted(start, BEGUN) for start in _screened(engine, base, offered, bound, count)]
    ranked = _best_forms(begun)
    return _best_forms([engine.fitted(state) for state in ranked[:FINALISTS]] + ranked[FINALISTS:])


def _exchanged(engine: Engine, best: State, singles: Sequence[State]) -> list[State]:
    """Return fitted sets in which one effect of the best set gives way to one that did nearly as well alone."""
    point = best.point
    alone = {state.point.terms[0].effect: state for state in singles}
    starts = []
    for term in point.terms:
        kept = point.without(term.effect)
        taken = {term.effect for term in point.terms}
        rivals = [state for name, state in alone.items() if name not in taken and term.effect in alone]
        near = [state for state in rivals if state.cost < RIVAL * alone[term.effect].cost]
        starts += [kept.plus(state.point.terms[0], state.point.values[0]) for state in near[:RIVALS]]
    begun = [engine.fitted(state, BEGUN) for state in engine.states(starts)]
    return [engine.fitted(state) if state.cost < RIVAL * best.cost else state for state in begun]


def _pruned(engine: Engine, best: State) -> list[State]:
    """Return fits of a set without each of its effects but the last, which smaller sets have been tried without."""
    starts = [best.point.without(term.effect) for term in best.point.terms[:-1]]
    return [engine.fitted(state) for state in engine.states(starts)]


def _best_forms(states: Sequence[State]) -> list[State]:
    """Return the states in the order of their cost, the best one of each set of effects."""
    best: dict[frozenset[str], State] = {}
    for state in sorted(states, key=lambda state: state.cost):
        best.setdefault(frozenset(term.effect for term in state.point.terms), state)
    return list(best.values())


def _screened(engine: Engine, base: State, offered: Sequence[Trace], bound: float, count: int) -> list[State]:
    """Return starts with candidates added to a base from which a linear model foresees low costs, below a bound."""
    own = engine.jacobian(base)
    foreseen = list(POOL.map(lambda trace: _foreseen(engine, base, trace, own), offered))
    order: dict[tuple[Any, ...], int] = {}
    for k in sorted(range(len(offered)), key=lambda k: foreseen[k][0]):
        if foreseen[k][0] < bound:
            order.setdefault(offered[k][0].form, k)
    starts = [_around(base.point, offered[k][0], foreseen[k][1]) for k in list(order.values())[:count]]
    states = iter(engine.states([point for points in starts for point in points]))
    return [min(islice(states, len(points)), key=lambda state: state.cost) for points in starts]


def _foreseen(engine: Engine, base: State, trace: Trace, own: dict[str, Array]) -> tuple[float, float]:
    """Return the cost that a multiple of a candidate's trace foresees, and that multiple."""
    candidate, changes = trace
    vector = base.point.vector
    low, high = base.point.limits
    parts = [
        engine.gram(run, np.vstack([own[run], changes[run].ravel()]), residual)
        for run, residual in base.whitened.items()
    ]
    matrix, right = np.sum([part[0] for part in parts], axis=0), np.sum([part[1] for part in parts], axis=0)
    count = len(base.point.u)
    bounds = np.append(low, 0.0 if candidate.low[0] >= 0.0 else -STRETCH), np.append(high, STRETCH)
    step = solved(matrix, right, count, np.append(vector, 0.0), *bounds)
    return base.cost - 2.0 * float(step @ right) + float(step @ matrix @ step), float(step[-1])


def _around(point: Point, candidate: Candidate, factor: float) -> list[Point]:
    """Return the point with a candidate at its start and where it changes the rig by about a factor more."""
    if candidate.wanes:
        factors = WEAKER if factor < 1.0 else tuple(1.0 / weaker for weaker in WEAKER)
    else:
        factors = tuple(factor * share for share in AROUND if abs(factor) > SEEN)
    starts = np.tile(candidate.start, (1 + len(factors), 1))
    starts[1:, 0] = np.clip(starts[1:, 0] * factors, candidate.low[0], candidate.high[0])
    return [point.plus(candidate, values) for values in starts]
