"""How alike the traces of effects are in a recording, once the nuisance parameters have taken their part.

With whitened changes a and b of two effects, sensitivities S of the nuisance parameters u and their prior standard
deviation SPREAD, all components without unit, each change is projected,

    p(a) = [a - S' u, -u / SPREAD],   u = (S S' + 1 / SPREAD^2)^-1 S a,

and the alikeness is |cos(p(a), p(b))|: 0 for traces that share nothing, 1 where one could stand for the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.candidates import Candidate, candidates
from seatsim.diagnosis.fit import NUDGE, SPREAD, Engine, Point, State

Array = NDArray[np.float64]

FAINT = 1e-9
"""Length of a projected trace, in noise units, below which it is like nothing."""
FAR = 10.0
"""Standard deviation of an effect's parameter, in its natural size."""
FORMS = 4
"""Forms and channels of an effect that are fitted."""
STRETCH = 8.0
"""Largest factor by which a start is made larger or smaller."""


def alikeness(engine: Engine, state: State, names: Sequence[str]) -> tuple[list[str], Array]:
    """Return those effects that can act here, and how alike their traces are, shape (effects, effects), 0 to 1.

    Each trace is what the effect alone adds to the state without any of them: as fitted where the state has it, else
    in the first form of a candidate, made about as large as the largest that is fitted, because what friction or a gap
    does depends on its size. An effect that may act on several channels is as alike as the channel that is most so.
    """
    if not engine.slopes:
        engine.refresh(state)
    base = state.point.without(*names)
    ends = {name: _ends(engine, state.point, base, name) for name in dict.fromkeys(names)}
    known = [name for name, found in ends.items() if found]
    points = [point for name in known for point in ends[name]]
    fitted = {term.effect for term in state.point.terms}
    held = [name in fitted for name in known for _ in ends[name]]
    cosines = np.abs(cosine(projected(_traces(engine, base, points, held), beside(engine.slopes, engine))))
    last = np.cumsum([len(ends[name]) for name in known])
    spans = [slice(end - len(ends[name]), end) for name, end in zip(known, last, strict=True)]
    matrix = np.array([[cosines[a, b].max() for b in spans] for a in spans]).reshape(len(known), len(known))
    np.fill_diagonal(matrix, 1.0)
    return known, matrix


def _traces(engine: Engine, base: Point, points: Sequence[Point], held: Sequence[bool]) -> Array:
    """Return the whitened changes from a base to points, shape (points, rows), those not `held` made as large."""
    origin, *states = engine.states([base, *points])
    changes = _changes(engine, origin, states)
    sizes = np.linalg.norm(changes, axis=1)
    if any(held):
        factors = max(sizes[k] for k, kept in enumerate(held) if kept) / np.maximum(sizes, FAINT)
        moved = [p if kept else _sized(p, f) for p, kept, f in zip(points, held, factors, strict=True)]
        changes = _changes(engine, origin, engine.states(moved))
    return changes


def _changes(engine: Engine, origin: State, states: Sequence[State]) -> Array:
    start = stacked(origin.whitened, engine)
    changes = np.array([stacked(moved.whitened, engine) - start for moved in states]).reshape(len(states), start.size)
    changes[~np.all(np.isfinite(changes), axis=1)] = 0.0
    return changes


def _sized(point: Point, factor: float) -> Point:
    """Return the point with the first parameter of its last effect larger by a factor, within reach and bounds."""
    term, values = point.terms[-1], point.values[-1].copy()
    values[0] = np.clip(values[0] * np.clip(factor, 1.0 / STRETCH, STRETCH), term.low[0], term.high[0])
    return Point(point.u, point.terms, (*point.values[:-1], values))


def stacked(values: dict[str, Array], engine: Engine) -> Array:
    """Return whitened numbers of all runs, shape (channels, rows) each, on end."""
    return np.concatenate([values[run].ravel() for run in engine.problem.runs])


def beside(slopes: dict[str, Array], engine: Engine) -> Array:
    """Return sensitivities in all runs, shape (parameters, channels x rows) each, beside each other."""
    return np.concatenate([slopes[run] for run in engine.problem.runs], axis=1)


def projected(changes: Array, basis: Array, loose: int = 0) -> Array:
    """Return p(a) of the changes, shape (changes, rows + parameters), off the slopes of nuisances.

    The last `loose` rows of `basis` belong to parameters of effects in their natural sizes, which may go far.
    """
    if not len(basis):
        return changes
    spread = np.concatenate([np.full(len(basis) - loose, SPREAD), np.full(loose, FAR)])
    shares = np.linalg.solve(basis @ basis.T + np.diag(spread**-2.0), basis @ changes.T).T
    return np.concatenate([changes - shares @ basis, -shares / spread], axis=1)


def cosine(vectors: Array) -> Array:
    """Return the cosine between each two rows; 0 where one of them is nothing."""
    size = np.linalg.norm(vectors, axis=1)
    unit = vectors / np.where(size > FAINT, size, np.inf)[:, None]
    return np.clip(unit @ unit.T, -1.0, 1.0)


def _ends(engine: Engine, point: Point, base: Point, name: str) -> list[Point]:
    """Return the base with one effect, as the point has it or as a candidate starts, once for each of its channels."""
    for term, values in zip(point.terms, point.values, strict=True):
        if term.effect == name:
            return [base.plus(term, values)]
    first: dict[str, Candidate] = {}
    for candidate in candidates(engine.problem):
        if candidate.effect == name:
            first.setdefault(str(candidate.fixed.get("channel")), candidate)
    return [base.plus(candidate, np.array(candidate.start)) for candidate in first.values()]


class Side(NamedTuple):
    """Outputs of rigs in noise units, shape (rigs, rows), slopes of the nuisances and of each rig's own parameters."""

    outputs: Array
    nuisances: Array
    own: list[Array]


def discrimination(old: Side, new: Side) -> float:
    """Return what a new experiment adds to the distance of the nearest pair of rigs, in noise units.

        d(a, b) = min over u, b of |y_a - y_b(u, b)|,    sqrt(d(old and new)^2 - d(old)^2),

    with the nuisances u under their prior and the rig's own parameters b, both linearised.
    """
    gains = []
    for a, b in permutations(range(len(old.outputs)), 2):
        bases = [np.vstack([side.nuisances, side.own[b]]) for side in (old, new)]
        gaps = [(side.outputs[b] - side.outputs[a])[None] for side in (old, new)]
        loose = len(old.own[b])
        both = projected(np.hstack(gaps), np.hstack(bases), loose)
        gains.append(float(np.sum(both**2) - np.sum(projected(gaps[0], bases[0], loose) ** 2)))
    return float(np.sqrt(max(min(gains), 0.0)))


def resemblance(changes: Array, slopes: Array) -> float:
    """Return `2 |p(a) p(b)| / (|p(a)|^2 + |p(b)|^2)` of the most alike pair: alikeness at the sizes that traces have.

    Traces that are short beside the noise are alike.
    """
    traces = projected(changes, slopes)
    power = traces @ traces.T
    own = np.diag(power)
    pairs = [(2.0 * abs(power[a, b]) + 1.0) / (own[a] + own[b] + 1.0) for a, b in permutations(range(len(own)), 2)]
    return float(min(max(pairs), 1.0))


def nudged(point: Point, first: int, last: int) -> list[tuple[Point, float]]:
    """Return the point with each of some components of its vector moved a little, and by how much."""
    vector, (_, high) = point.vector, point.limits
    unit = np.eye(len(vector))
    nudges = [NUDGE if vector[k] + NUDGE <= high[k] else -NUDGE for k in range(first, last)]
    return [(point.moved(vector + nudge * unit[first + k]), nudge) for k, nudge in enumerate(nudges)]


def with_member(engine: Engine, state: State, name: str, group: Sequence[str]) -> State:
    """Return the state with one member of the group instead of the others, its term last, fitted to the recording."""
    point, base = state.point, state.point.without(*group)
    own = [(t, v) for t, v in zip(point.terms, point.values, strict=True) if t.effect == name]
    starts = own or [(c, np.array(c.start)) for c in candidates(engine.problem) if c.effect == name]
    states = sorted(engine.states([base.plus(*start) for start in starts]), key=lambda found: found.cost)
    return min((engine.fitted(start) for start in states[:FORMS]), key=lambda found: found.cost)
