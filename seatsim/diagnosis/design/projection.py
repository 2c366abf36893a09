"""Sensitivities with the nuisance parameters projected out, and how collinear they are.

With whitened changes a of the outputs, sensitivities S of parameters u and their prior standard deviations d, all
components without unit, each change is projected,

    p(a) = [a - S' u, -u / d],   u = (S S' + diag(d)^-2)^-1 S a,

so that `|p(a)|^2` is the cost of a that remains after the best refit of the parameters under their prior.
"""

from __future__ import annotations

from itertools import permutations

import numpy as np

from seatsim.schema.arrays import Array


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


def measure_cosines(vectors: Array, faint: float) -> Array:
    """Return the cosine between each pair of rows, shape (rows, rows); 0 where one of them is shorter than `faint`."""
    size = np.linalg.norm(vectors, axis=1)
    unit = vectors / np.where(size > faint, size, np.inf)[:, None]
    return np.clip(unit @ unit.T, -1.0, 1.0)


def measure_likeness(projected: Array) -> float:
    """Return the largest `2 |p(a) p(b)| / (|p(a)|^2 + |p(b)|^2)` over all pairs: a collinearity that sees sizes too.

    Two changes that are both small compared with the noise, whose power is 1, count as the same.
    """
    power = projected @ projected.T
    own = np.diag(power)
    pairs = [(2.0 * abs(power[a, b]) + 1.0) / (own[a] + own[b] + 1.0) for a, b in permutations(range(len(own)), 2)]
    return float(min(max(pairs), 1.0))
