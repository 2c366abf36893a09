"""Fits of effects together with the nuisance parameters, to whitened residuals of a free-running simulation.

The rig is driven by the measured floor and command alone, so that no measured motion enters a regressor: feeding
measured signals into a closed loop would manufacture causes (endogeneity). Minimised is

    sum |whitened residual|^2 + sum (u / SPREAD)^2,   -1 <= u <= 1,

over nuisance parameters u and the free parameters of the effects, by Gauss-Newton steps under bounds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky
from scipy.optimize import lsq_linear

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.noise import Whitening
from seatsim.diagnosis.problem import POOL, Problem

Array = NDArray[np.float64]

SPREAD = 0.58
"""Standard deviation of a nuisance parameter that is uniform within its span."""
NUDGE = 0.02
"""Step of the finite differences, in natural sizes of a parameter."""
STEPS = 6
"""Most Gauss-Newton steps of a fit."""
SETTLED = 0.01
"""A fit ends where a step lowers its cost by less than this share."""
SHORTER = (1.0, 0.4, 0.12)
"""Fractions of a step that are tried in turn."""


@dataclass(frozen=True)
class Point:
    """Nuisance parameters and effects with their values: one rig."""

    u: Array
    terms: tuple[Candidate, ...] = ()
    values: tuple[Array, ...] = ()

    @property
    def effects(self) -> list[Any]:
        """Records of the effects."""
        return [term.record(values) for term, values in zip(self.terms, self.values, strict=True)]

    @property
    def vector(self) -> Array:
        """All parameters in natural sizes, shape (nuisances + free parameters,)."""
        return np.concatenate([self.u, *(v / t.scale for t, v in zip(self.terms, self.values, strict=True))])

    @property
    def limits(self) -> tuple[Array, Array]:
        """Bounds of `vector`."""
        ones = np.ones(len(self.u))
        low = [np.asarray(t.low) / t.scale for t in self.terms]
        high = [np.asarray(t.high) / t.scale for t in self.terms]
        return np.concatenate([-ones, *low]), np.concatenate([ones, *high])

    def plus(self, term: Candidate, values: Array) -> Point:
        """Return the point with an effect more."""
        return Point(self.u, (*self.terms, term), (*self.values, values))

    def without(self, *names: str) -> Point:
        """Return the point without the effects of these names."""
        kept = [k for k, term in enumerate(self.terms) if term.effect not in names]
        return Point(self.u, tuple(self.terms[k] for k in kept), tuple(self.values[k] for k in kept))

    def moved(self, vector: Array) -> Point:
        """Return the point at another vector."""
        low, high = self.limits
        vector = np.clip(vector, low, high)
        values, start = [], len(self.u)
        for term in self.terms:
            values.append(vector[start : start + len(term.free)] * term.scale)
            start += len(term.free)
        return Point(vector[: len(self.u)], self.terms, tuple(values))


@dataclass(frozen=True)
class State:
    """A point with its residuals: `whitened[run]` of shape (channels, rows), `cost` with the prior's share."""

    point: Point
    residual: dict[str, Array]
    whitened: dict[str, Array]
    cost: float


@dataclass
class Engine:
    """A problem with its weights, and the sensitivities of the nuisance parameters at the last refreshed point."""

    problem: Problem
    white: Whitening
    slopes: dict[str, Array] = field(default_factory=dict)
    grams: dict[str, Array] = field(default_factory=dict)

    def states(self, points: Sequence[Point]) -> list[State]:
        """Simulate and weigh several points at once."""
        residuals = self.problem.residuals([(point.u, point.effects) for point in points])
        return list(POOL.map(self._state, points, residuals))

    def _state(self, point: Point, residual: dict[str, Array]) -> State:
        finite = all(np.all(np.isfinite(values)) for values in residual.values())
        whitened = {
            run: self.white(values if finite else np.zeros_like(values), run) for run, values in residual.items()
        }
        cost = sum(float(np.sum(values**2)) for values in whitened.values())
        if not finite:
            cost = np.inf
        return State(point, residual, whitened, cost + float(np.sum((point.u / SPREAD) ** 2)))

    def refresh(self, state: State) -> None:
        """Take the sensitivities to the nuisance parameters at a state."""
        self.slopes = self._slopes(state, range(len(state.point.u)))
        self.grams = {run: slopes @ slopes.T for run, slopes in self.slopes.items()}

    def _slopes(self, state: State, indices: Sequence[int]) -> dict[str, Array]:
        """Return d(simulated)/d(vector) of the components, whitened, shape (components, channels x rows) by run."""
        vector, (_, high) = state.point.vector, state.point.limits
        nudges = [NUDGE if vector[k] + NUDGE <= high[k] else -NUDGE for k in indices]
        points = [state.point.moved(_nudged(vector, k, nudge)) for k, nudge in zip(indices, nudges, strict=True)]
        moved = self.states(points)
        return {
            run: np.array(
                [(base - m.whitened[run]).ravel() / nudge for m, nudge in zip(moved, nudges, strict=True)]
            ).reshape(len(nudges), base.size)
            for run, base in state.whitened.items()
        }

    def jacobian(self, state: State) -> dict[str, Array]:
        """Return the sensitivities to the effects' parameters, shape (free parameters, channels x rows) by run."""
        return self._slopes(state, range(len(state.point.u), len(state.point.vector)))

    def gram(self, run: str, own: Array, whitened: Array) -> tuple[Array, Array]:
        """Return normal matrix and right-hand side of a run, for the nuisances and then the components `own`."""
        mixed, flat = self.slopes[run] @ own.T, whitened.ravel()
        matrix = np.block([[self.grams[run], mixed], [mixed.T, own @ own.T]])
        return matrix, np.concatenate([self.slopes[run] @ flat, own @ flat])

    def fitted(self, start: State, steps: int = STEPS) -> State:
        """Return the state at the end of a fit from `start`."""
        state = start
        for _ in range(steps):
            change = self._step(state, self.jacobian(state))
            before = state.cost
            for fraction in SHORTER:
                tried = self.states([state.point.moved(state.point.vector + fraction * change)])[0]
                if tried.cost < state.cost:
                    state = tried
                    break
            if state.cost > (1.0 - SETTLED) * before:
                break
        return state

    def refitted(self, point: Point) -> State:
        """Return the state at the end of a fit from a point, with the nuisances' sensitivities taken there."""
        start = self.states([point])[0]
        self.refresh(start)
        return self.fitted(start)

    def _step(self, state: State, jacobian: dict[str, Array]) -> Array:
        """Return the Gauss-Newton step under the bounds."""
        grams = [self.gram(run, own, state.whitened[run]) for run, own in jacobian.items()]
        low, high = state.point.limits
        vector = state.point.vector
        matrix, right = np.sum([g[0] for g in grams], axis=0), np.sum([g[1] for g in grams], axis=0)
        return solved(matrix, right, len(state.point.u), vector, low, high)


def solved(matrix: Array, right: Array, count: int, vector: Array, low: Array, high: Array) -> Array:
    """Return the step from `vector` that minimises the quadratic with the prior on its first `count` components."""
    matrix, right = matrix.copy(), right.copy()
    index = np.arange(count)
    matrix[index, index] += SPREAD**-2
    right[:count] -= vector[:count] / SPREAD**2
    size = np.sqrt(np.maximum(np.diag(matrix), 1e-12))
    scaled = matrix / np.outer(size, size) + 1e-8 * np.eye(len(size))
    upper = cholesky(scaled)
    target = np.linalg.solve(upper.T, right / size)
    room = np.maximum(high - vector, 0.0) * size + 1e-9, np.minimum(low - vector, 0.0) * size - 1e-9
    return np.asarray(lsq_linear(upper, target, (room[1], room[0]), method="bvls").x) / size


def _nudged(vector: Array, index: int, nudge: float) -> Array:
    moved = vector.copy()
    moved[index] += nudge
    return moved
