"""Which effects runs left out of the fit support, where no set explains the gap.

Where the nominal's own form is wrong everywhere, as with a real rig, what noise leaves is no measure of what a right
model leaves: weights by noise rank effects by how they mend the faintest frequencies. The gap itself is the measure
then: all frequencies weigh the same, and an effect counts by what it takes off the gap of runs left out of its fit.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.decide import material
from seatsim.diagnosis.fit import Engine, State
from seatsim.diagnosis.noise import Whitening, even
from seatsim.diagnosis.problem import Problem
from seatsim.diagnosis.select import Search
from seatsim.diagnosis.validate import sizes

Array = NDArray[np.float64]

LEVEL = 0.1
"""Share of the gap that counts as noise."""
HELPS = 0.1
"""Share of the gap of runs left out that an effect takes off, mean over the runs."""
ALIKE = 0.02
"""Difference of that share within which two sets help as much; of such sets that without an erring sensor is chosen."""
TRIED = 5
"""Sets of each size that are tried."""
FOLDS = 3
"""Parts of the runs that are left out in turn."""


def plain(problem: Problem, state: State) -> Whitening:
    """Return weights that are the same at all frequencies, those of the gap, so that a state leaves LEVEL^-2."""
    level = LEVEL * np.sqrt(np.mean(sizes(problem, state) ** 2)) * problem.spread
    return even(problem, {run: level[:, None] ** 2 * values.shape[1] for run, values in problem.measured.items()})


def supported(engine: Engine, found: Search) -> tuple[State, list[State]]:
    """Return the smallest set of effects that no larger one betters on runs left out, and sets that help as much."""
    chosen, alike, before = found.calibrated, [], left_out(engine, found.calibrated)
    for sets in found.sets[1:]:
        tried = [(state, left_out(engine, state)) for state in sets[:TRIED] if material(engine, state)]
        gains = [float(np.mean(1.0 - after / before)) for _, after in tried]
        if max(gains, default=0.0) < HELPS:
            break
        best = [each for each, gain in zip(tried, gains, strict=True) if gain > max(gains) - ALIKE]
        best.sort(key=lambda each: sum(term.block == "sensor" for term in each[0].point.terms))
        (chosen, before), alike = best[0], [state for state, _ in best[1:]]
    return chosen, alike


def left_out(engine: Engine, state: State) -> Array:
    """Return the gap of each run under a set of effects fitted without it, in standard deviations, shape (runs,)."""
    problem = engine.problem
    if len(problem.runs) == 1:
        return sizes(problem, state)
    found = np.zeros(len(problem.runs))
    for k in range(min(FOLDS, len(problem.runs))):
        others = tuple(run for j, run in enumerate(problem.runs) if j % FOLDS != k)
        part = Engine(dataclasses.replace(problem, runs=others), engine.white)
        fitted = engine.states([part.refitted(state.point).point])[0]
        found[k::FOLDS] = sizes(problem, fitted)[k::FOLDS]
    return found
