"""What parameters off by up to the tolerance could explain of a fault.

By the contract a gap that the tolerance explains is no gap. So a fault counts here only where it stays material after
the best bounded refit of every nominal parameter, linear in the parameters: `min |g - J theta|`, `|theta| <= 1`.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import lsq_linear

from seatsim.blind.make.draw_experiment import EXACT, zero_scales
from seatsim.blind.make.materiality import CommandedRuns, rms
from seatsim.blind.truth.experiment import Experiment
from seatsim.blind.truth.faults.scenario import Changes
from seatsim.schema.arrays import Array

SECONDS = 12.0
"""Of each run that are looked at: half of it, as every parameter costs a simulation."""
NEGLIGIBLE = 0.2
"""Materiality below which a fault is not material whatever a refit takes away."""


class ToleranceRefit:
    """Sensitivities of the compared channels to each parameter of an experiment, one tolerance up."""

    def __init__(self, experiment: Experiment, commands: list[Array]) -> None:
        rows = round(SECONDS * experiment.sample_rate)
        self.runs = CommandedRuns(experiment, [command[:rows] for command in commands])
        scales = zero_scales(experiment.nominal)
        self.sensitivities: list[dict[str, Array]] = []
        for name, value in experiment.nominal.items():
            step = experiment.tolerance * (value or scales.get(name, 0.0))
            if name not in EXACT and step:
                sensitivity, _ = self.runs.response(Changes({name: experiment.true[name] + step}), Changes())
                self.sensitivities.append(sensitivity)

    def unexplained_share(self, fault: Changes, others: Changes) -> float:
        """Return which share of a fault's materiality no refit inside the tolerance takes away, 0..1 or a little more.

        The refit minimises the sum over all channels, so the largest of them may grow. Channels that a sensitivity has
        not, because it does not stand above noise there, take no part.
        """
        response, limits = self.runs.response(fault, others)
        names = [name for name in response if all(name in column for column in self.sensitivities)]
        if not names:
            return 1.0
        g = np.concatenate([response[name] / limits[name] for name in names])
        before = max(rms(response[name] / limits[name]) for name in names)
        if not np.all(np.isfinite(g)) or before < NEGLIGIBLE:
            return 1.0
        columns = [np.concatenate([c[name] / limits[name] for name in names]) for c in self.sensitivities]
        J = np.column_stack(columns)
        left = np.split(g - J @ bounded_least_squares(J, g), len(names))
        return max(rms(part) for part in left) / before


def bounded_least_squares(J: Array, g: Array) -> Array:
    """Return `argmin |g - J theta|` with `|theta| <= 1`.

    Solved on the triangular factor of `[J g]`, which has the same minimum with a row per column.
    """
    triangle = np.asarray(np.linalg.qr(np.column_stack([J, g]), mode="r"))
    return np.asarray(lsq_linear(triangle[:, :-1], triangle[:, -1], (-1.0, 1.0)).x)
