"""How well an experiment would separate rigs that explain a recording equally well."""

from __future__ import annotations

from itertools import permutations
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.design.projection import project
from seatsim.schema.arrays import Array


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
