"""The best run that the damper can do: a local minimum over its forces, by differential dynamic programming.

From a run, the law that is best where every interval stays on what sets its force (a line of the damper, standstill, or
nothing) follows from one Riccati recursion. The seat is then run under what the damper delivers of that law: where the
wanted force cannot be had, the closest one, which is the best for the cost-to-go. Intervals change sides by themselves.
Repeated, with a growing proximity term to the last forces where a pass does not improve. The idea: control-limited
differential dynamic programming, Tassa, Mansard and Todorov 2014 (ICRA), with limits here that depend on the state.
"""

from __future__ import annotations

import numpy as np

from controllers.clairvoyant.problem import ClairvoyantRun, HeldForceProblem
from controllers.clairvoyant.recursion import ForceBand
from seatsim.schema.arrays import Array

# Most passes. The proximity grows from next to nothing to where no force changes any more, and the search ends.
PASSES = 80
_FIRST_PROXIMITY, _LAST_PROXIMITY, _SETTLED = 1e-13, 1e-7, 1e-7  # of the criterion, 1/N^2


def find_best_run(problem: HeldForceProblem, band: ForceBand, start: Array | None = None) -> ClairvoyantRun:
    """Return a locally best run under forces between the lines, from the law `start`, or from the weakest damper."""
    gain = np.zeros((problem.intervals, len(problem.transcription.velocity))) if start is None else start
    best, proximity = problem.simulate(band, gain), 0.0
    for _ in range(PASSES):
        tried = problem.simulate(band, problem.improve_law(band, best, proximity))
        if tried.cost < best.cost * (1 - _SETTLED):
            best, proximity = tried, (0.2 * proximity if proximity > _FIRST_PROXIMITY else 0.0)
        elif proximity > _LAST_PROXIMITY:
            break
        else:
            proximity = max(4 * proximity, _FIRST_PROXIMITY)
    return best
