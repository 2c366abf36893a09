"""How alike the traces of effects are in a recording, once the nuisance parameters have taken their part.

With whitened changes a and b of two effects, sensitivities S of the nuisance parameters u and their prior standard
deviation SPREAD, all components without unit, each change is projected,

    p(a) = [a - S' u, -u / SPREAD],   u = (S S' + 1 / SPREAD^2)^-1 S a,

and the alikeness is |cos(p(a), p(b))|: 0 for traces that share nothing, 1 where one could stand for the other.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.candidates import candidates
from seatsim.diagnosis.fit import SPREAD, Engine, Point, State

Array = NDArray[np.float64]

FAINT = 1e-9
"""Length of a projected trace, in noise units, below which it is like nothing."""


def alikeness(engine: Engine, state: State, names: Sequence[str]) -> tuple[list[str], Array]:
    """Return those effects that can act here, and how alike their traces are, shape (effects, effects), 0 to 1.

    An effect of the state is taken away, another is added as its first form starts. One that may act on several
    channels is as alike as the channel that is most so.
    """
    if not engine.slopes:
        engine.refresh(state)
    points = {name: _changed(engine, state.point, name) for name in dict.fromkeys(names)}
    known = [name for name, found in points.items() if found]
    states = engine.states([point for name in known for point in points[name]])
    basis = beside(engine.slopes, engine)
    base = stacked(state.whitened, engine)
    changes = np.array([stacked(moved.whitened, engine) - base for moved in states]).reshape(len(states), base.size)
    changes[~np.all(np.isfinite(changes), axis=1)] = 0.0
    cosines = np.abs(cosine(projected(changes, basis)))
    ends = np.cumsum([0] + [len(points[name]) for name in known])
    spans = [slice(first, last) for first, last in zip(ends[:-1], ends[1:], strict=True)]
    matrix = np.array([[cosines[a, b].max() for b in spans] for a in spans]).reshape(len(known), len(known))
    np.fill_diagonal(matrix, 1.0)
    return known, matrix


def stacked(values: dict[str, Array], engine: Engine) -> Array:
    """Return whitened numbers of all runs, shape (channels, rows) each, on end."""
    return np.concatenate([values[run].ravel() for run in engine.problem.runs])


def beside(slopes: dict[str, Array], engine: Engine) -> Array:
    """Return sensitivities in all runs, shape (parameters, channels x rows) each, beside each other."""
    return np.concatenate([slopes[run] for run in engine.problem.runs], axis=1)


def projected(changes: Array, basis: Array) -> Array:
    """Return p(a) of the changes, shape (changes, rows + nuisances), off the nuisances' slopes `basis`."""
    if not len(basis):
        return changes
    shares = np.linalg.solve(basis @ basis.T + np.eye(len(basis)) / SPREAD**2, basis @ changes.T).T
    return np.concatenate([changes - shares @ basis, -shares / SPREAD], axis=1)


def cosine(vectors: Array) -> Array:
    """Return the cosine between each two rows; 0 where one of them is nothing."""
    size = np.linalg.norm(vectors, axis=1)
    unit = vectors / np.where(size > FAINT, size, np.inf)[:, None]
    return np.clip(unit @ unit.T, -1.0, 1.0)


def _changed(engine: Engine, point: Point, name: str) -> list[Point]:
    """Return the point without an effect that is in it, or with one that is not, once for each of its channels."""
    if any(term.effect == name for term in point.terms):
        return [without(point, [name])]
    first = {}
    for candidate in candidates(engine.problem):
        if candidate.effect == name:
            first.setdefault(str(candidate.fixed.get("channel")), candidate)
    return [Point(point.u, (*point.terms, c), (*point.values, np.array(c.start))) for c in first.values()]


def without(point: Point, names: Sequence[str]) -> Point:
    """Return the point without the effects of these names."""
    kept = [k for k, term in enumerate(point.terms) if term.effect not in names]
    return Point(point.u, tuple(point.terms[k] for k in kept), tuple(point.values[k] for k in kept))
