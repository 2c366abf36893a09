"""The best run that the damper can do: a local minimum over its forces, by differential dynamic programming.

From a run, the law that is best where every interval stays on what sets its force (a line of the damper, standstill, or
nothing) follows from one Riccati recursion. The seat is then run under what the damper delivers of that law: where the
wanted force cannot be had, the closest one, which is the best for the cost-to-go. Intervals change sides by themselves.
Repeated, with a growing pull to the last forces where a pass does not improve. The idea: control-limited differential
dynamic programming, Tassa, Mansard and Todorov 2014 (ICRA), with limits here that depend on the state.
"""

from __future__ import annotations

import numpy as np

from controllers.clairvoyant.problem import Problem, Run
from controllers.clairvoyant.recursion import Array, Lines

PASSES = 80
_FIRST_PULL, _LAST_PULL, _SETTLED = 1e-13, 1e-7, 1e-7  # of the criterion, 1/N^2


def best_run(problem: Problem, lines: Lines, start: Array | None = None) -> Run:
    """Return a locally best run under forces between the lines, from the law `start`, or from the weakest damper."""
    gain = np.zeros((problem.intervals, len(problem.transcription.velocity))) if start is None else start
    best, pull = problem.delivered(lines, gain), 0.0
    for _ in range(PASSES):
        tried = problem.delivered(lines, problem.improved(lines, best, pull))
        if tried.cost < best.cost * (1 - _SETTLED):
            best, pull = tried, (0.2 * pull if pull > _FIRST_PULL else 0.0)
        elif pull > _LAST_PULL:
            break
        else:
            pull = max(4 * pull, _FIRST_PULL)
    return best
