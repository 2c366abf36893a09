"""What an engine is given and what it returns."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from pathlib import Path
from typing import NamedTuple, Protocol

from seatsim.sweeps.outcome import Outcome, simulate_run
from seatsim.sweeps.plan import Plan


class Work(NamedTuple):
    """The runs of a sweep that are to be simulated: tasks of run numbers, each from one part of the sweep.

    `histories` is a folder in which channels are kept, or None.
    """

    plan: Plan
    tasks: Sequence[Sequence[int]]
    histories: Path | None


class Engine(Protocol):
    """Carries out work; one that takes lanes of one combination of models regroups the runs of several tasks."""

    def __call__(self, work: Work) -> Generator[list[Outcome]]:
        """Yield outcomes as they come, in any order and in lists of any length; each run of the work has one.

        Where the iterator is closed, as on an interrupt, nothing of it keeps the process from ending.
        """


def simulate_one(plan: Plan, run: int, number: int, histories: Path | None) -> Outcome:
    """Simulate run `run` of a plan, which has this `number` in the sweep."""
    return simulate_run(number, lambda: plan.scenario(run), histories)
