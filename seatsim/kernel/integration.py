"""What the integrations of loop and bench share: arithmetic of states, unrolled when compiled, and a limit of work."""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

from numba import types

from seatsim.compilation.jit import define, jit, specialise
from seatsim.rig.state import State


def axpy(y: State, h: float, k: State) -> State:
    """Return `y + h k` for two tuples of equal length."""
    return tuple(a + h * b for a, b in zip(y, k, strict=True))


@specialise(axpy)
def _axpy(y: types.Type, h: types.Type, k: types.Type) -> Callable[..., State]:
    return _unrolled("y, h, k", "y[{j}] + h * k[{j}]", len(y))


def combine(y: State, h: float, k1: State, k2: State, k3: State, k4: State) -> State:
    """Return `y + h (k1 + 2 k2 + 2 k3 + k4) / 6`, the step of the classical Runge-Kutta method."""
    stages = zip(y, k1, k2, k3, k4, strict=True)
    return tuple(a + h / 6.0 * (b + 2.0 * (c + d) + e) for a, b, c, d, e in stages)


@specialise(combine)
def _combine(
    y: types.Type, h: types.Type, k1: types.Type, k2: types.Type, k3: types.Type, k4: types.Type
) -> Callable[..., State]:
    term = "y[{j}] + h / 6.0 * (k1[{j}] + 2.0 * (k2[{j}] + k3[{j}]) + k4[{j}])"
    return _unrolled("y, h, k1, k2, k3, k4", term, len(y))


def _unrolled(arguments: str, term: str, length: int) -> Callable[..., State]:
    """Build a function that returns a tuple of `term` for j = 0 .. length - 1: numba has no tuple comprehension."""
    body = "".join(term.format(j=j) + ", " for j in range(length))
    source = f"def unrolled({arguments}): return ({body})"
    return cast("Callable[..., State]", define(source, "unrolled", {"__name__": __name__}))


MOST_WORK = 100
"""Mean number of parts of a step at which a run is given up: it would take minutes, where others take milliseconds."""
MOST_DEBT = 1000.0 * MOST_WORK
"""Parts beyond that mean that are lent, so that a stiff start does not end a run."""


@jit
def owe(debt: float, parts: float) -> float:
    """Return the parts owed after a step that took `parts` of them: what exceeds `MOST_WORK`, less what was saved."""
    return max(0.0, debt + parts - MOST_WORK)
