"""How well effects are told apart by a recording, or by a further experiment.

With whitened changes a of the outputs, sensitivities S of parameters u and their prior standard deviations d, all
components without unit, the nuisance parameters are projected out of each change,

    p(a) = [a - S' u, -u / d],   u = (S S' + diag(d)^-2)^-1 S a,

so that `|p(a)|^2` is the cost of a that remains after the best refit of the parameters under their prior. The
collinearity of two effects is |cos(p(a), p(b))|: 0 where they share nothing, 1 where one could stand for the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.objective import PRIOR_STD, Objective
from seatsim.diagnosis.result import Collinearity
from seatsim.diagnosis.select import Selection
from seatsim.schema.arrays import Array

_FAINT = 1e-9
"""Length of a projected sensitivity, in noise units, below which it is collinear with nothing."""


def project(changes: Array, sensitivities: Array, deviations: Array) -> Array:
    """Return p(a) of changes, shape (changes, rows + parameters).

    Args:
        changes: whitened changes of the outputs, shape (changes, rows).
        sensitivities: of the parameters, shape (parameters, rows).
        deviations: prior standard deviations of the parameters, shape (parameters,).
    """
    if not len(sensitivities):
        return changes
    precision = np.diag(deviations**-2.0)
    shares = np.linalg.solve(sensitivities @ sensitivities.T + precision, sensitivities @ changes.T).T
    return np.concatenate([changes - shares @ sensitivities, -shares / deviations], axis=1)


def measure_cosines(vectors: Array) -> Array:
    """Return the cosine between each pair of rows, shape (rows, rows); 0 where one of them is 0 but for rounding."""
    size = np.linalg.norm(vectors, axis=1)
    unit = vectors / np.where(size > _FAINT, size, np.inf)[:, None]
    return np.clip(unit @ unit.T, -1.0, 1.0)


def measure_likeness(projected: Array) -> float:
    """Return the largest `2 |p(a) p(b)| / (|p(a)|^2 + |p(b)|^2)` over all pairs: a collinearity that sees sizes too.

    Two changes that are both small compared with the noise, whose power is 1, count as the same.
    """
    power = projected @ projected.T
    own = np.diag(power)
    pairs = [(2.0 * abs(power[a, b]) + 1.0) / (own[a] + own[b] + 1.0) for a, b in permutations(range(len(own)), 2)]
    return float(min(max(pairs), 1.0))


class PredictedExperiment(NamedTuple):
    """Outputs of rigs in noise units, shape (rigs, rows); Jacobians of the nuisances and of each rig's own effects."""

    outputs: Array
    nuisances: Array
    own: list[Array]


def measure_separability(
    old: PredictedExperiment, new: PredictedExperiment, nuisance_std: float, effect_std: float
) -> float:
    """Return what a new experiment adds to the distance of the nearest pair of rigs, in noise units.

        d(a, b) = min over u, b of |y_a - y_b(u, b)|,    sqrt(d(old and new)^2 - d(old)^2),

    with the nuisances u under their prior and the rig's own parameters b under a wide one, both linearised.

    Args:
        old: the recording at hand.
        new: the experiment, simulated.
        nuisance_std: prior standard deviation of the nuisances, as a share of their tolerance.
        effect_std: prior standard deviation of the effects' parameters, in their natural sizes.
    """
    gains = []
    for a, b in permutations(range(len(old.outputs)), 2):
        bases = [np.vstack([side.nuisances, side.own[b]]) for side in (old, new)]
        gaps = [(side.outputs[b] - side.outputs[a])[None] for side in (old, new)]
        count = len(old.own[b])
        deviations = np.concatenate([np.full(len(bases[0]) - count, nuisance_std), np.full(count, effect_std)])
        both = project(np.hstack(gaps), np.hstack(bases), deviations)
        gains.append(float(np.sum(both**2) - np.sum(project(gaps[0], bases[0], deviations) ** 2)))
    return float(np.sqrt(max(min(gains), 0.0)))


def measure_collinearity(objective: Objective, selection: Selection, names: Sequence[str]) -> Collinearity:
    """Return the effects that can act on this rig, and how collinear they are.

    Each change is that of the outputs when one effect is added to the calibrated rig: as it was fitted alone, or else
    as its first candidate starts.

    Args:
        objective: over all runs.
        selection: the fitted sets of one effect, and the candidates.
        names: effects to compare.
    """
    rig, singles = selection.calibrated, selection.singles
    firsts = {each.effect: each for each in reversed(selection.sensitivities.candidates)}
    starts = [
        rig.parameters.add(firsts[name], firsts[name].alone[0]) for name in names if name in {*firsts} - {*singles}
    ]
    added = singles | {each.parameters.terms[0].effect: each for each in objective.evaluate(starts)}
    known = [name for name in dict.fromkeys(names) if name in added and np.isfinite(added[name].cost)]
    changes = np.array([rig.stacked - added[name].stacked for name in known]).reshape(len(known), rig.stacked.size)
    sensitivities = selection.nuisances.stacked
    left = project(changes, sensitivities, np.full(len(sensitivities), PRIOR_STD))
    matrix = np.abs(measure_cosines(left))
    np.fill_diagonal(matrix, 1.0)
    return Collinearity(known, matrix)
