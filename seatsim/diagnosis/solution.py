"""A search for effects, and the solution that it returns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.decide import Decision, decide_verdict
from seatsim.diagnosis.localise.discrepancy import Discrepancy
from seatsim.diagnosis.objective import Objective
from seatsim.diagnosis.result import Share
from seatsim.diagnosis.score import Search
from seatsim.diagnosis.select import LinearisedRig, Selection, select_effects

Progress = Callable[[str], object]


class SearchTask(NamedTuple):
    """Inputs of a search: the candidates, the names of all effects, and the progress callback."""

    candidates: Sequence[Candidate]
    effects: Sequence[str]
    progress: Progress


class Solution(NamedTuple):
    """A selection with its decision, the blocks that the gap lies in, and the discrepancy, if anything is unexplained.

    `stochastic` is the effect, if any, whose signal is that discrepancy; `beside` is the search beside a disturbance.
    """

    objective: Objective
    selection: Selection
    decision: Decision
    where: Sequence[Share] = ()
    discrepancy: Discrepancy | None = None
    stochastic: str = ""
    beside: Search | None = None

    @property
    def searches(self) -> list[Search]:
        """The search without a disturbance, which is the first, and that beside one, if any."""
        return [Search(self.objective, self.selection), *filter(None, [self.beside])]


def search(task: SearchTask, objective: Objective, rig: LinearisedRig | None = None) -> Solution:
    """Select effects under the weights of an objective and decide; `rig` is the linearised rig where it is known."""
    selection = select_effects(objective, task.candidates, task.progress, rig=rig)
    decision = decide_verdict([Search(objective, selection)], task.effects)
    return Solution(objective, selection, decision)
