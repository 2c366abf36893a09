"""The stages of a diagnosis, what a search needs, and the solution that it returns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.decide import Decision, decide_verdict
from seatsim.diagnosis.localise.discrepancy import Discrepancy
from seatsim.diagnosis.localise.localisation import Remainder, share_gap
from seatsim.diagnosis.noise import NoiseWeights, weigh_noise
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.result import Share
from seatsim.diagnosis.select import LinearisedRig, Selection, select_effects

Progress = Callable[[str], object]


class Method(NamedTuple):
    """The stages of a diagnosis; a benchmark replaces one of them to measure its contribution."""

    weigh_noise: Callable[[DiagnosisProblem], NoiseWeights] = weigh_noise
    select_effects: Callable[
        [Objective, Sequence[Candidate], Progress, int | None, LinearisedRig | None], Selection
    ] = select_effects
    decide_verdict: Callable[[DiagnosisProblem, Selection, Sequence[str]], Decision] = decide_verdict
    share_gap: Callable[[Objective, Evaluation, Remainder | None], list[Share]] = share_gap


class SearchTask(NamedTuple):
    """Inputs of a search: the candidates, the names of all effects, the progress callback, and the method."""

    candidates: Sequence[Candidate]
    effects: Sequence[str]
    progress: Progress
    method: Method


class Solution(NamedTuple):
    """A selection with its decision, the blocks that the gap lies in, and the discrepancy, if anything is unexplained.

    `stochastic` is the effect, if any, whose signal is that discrepancy.
    """

    objective: Objective
    selection: Selection
    decision: Decision
    where: Sequence[Share] = ()
    discrepancy: Discrepancy | None = None
    stochastic: str = ""


def search(task: SearchTask, objective: Objective, rig: LinearisedRig | None = None) -> Solution:
    """Select effects under the weights of an objective and decide; `rig` is the linearised rig where it is known."""
    selection = task.method.select_effects(objective, task.candidates, task.progress, None, rig)
    decision = task.method.decide_verdict(objective.problem, selection, task.effects)
    return Solution(objective, selection, decision)
