"""What becomes of a run of a sweep, what an engine is given and returns, and the engine `local`.

This engine is a thread of this process and, where they pay, further processes of this machine. Most of a short run is
Python between compiled calls. Threads of one process take turns with it, processes do not.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
from threadpoolctl import threadpool_limits

from seatsim.compilation.messages import explain
from seatsim.excitations.base import Excitation, Floor
from seatsim.metrics.table import METRICS
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import RunError, SeatsimError
from seatsim.schema.processes import open_pool
from seatsim.simulation.result import History, Run
from seatsim.simulation.runs import measure_run, write_histories
from seatsim.simulation.simulate import simulate
from seatsim.simulation.validity import list_reasons
from seatsim.sweeps.plan import Plan

DONE, FAILED, UNVERIFIED = "done", "failed", "unverified"
STATES = (DONE, FAILED, UNVERIFIED)
FLOORS_KEPT = 8
"""Floors that are kept for the next runs; of 60 s at 1 kHz each takes 1.5 MB."""


class Outcome(NamedTuple):
    """The outcome of a run by its number.

    `done` has metrics that can be used; those of `unverified` cannot be relied on, and `failed` has none. `metrics` are
    in the order of `METRICS`, None where there is no such figure.
    """

    run: int
    state: str
    reason: str
    seed: int
    metrics: tuple[float | None, ...]


def simulate_one(plan: Plan, run: int, number: int, histories: Path | None) -> Outcome:
    """Simulate run `run` of a plan, which has this `number` in the sweep; nothing that goes wrong ends the sweep.

    `histories` is a folder in which the channels are kept, or None.
    """
    seed = 0
    try:
        scenario = plan.scenario(run)
        seed = scenario.seed
        # What grows beyond all numbers is said by the state of the run, once.
        with np.errstate(over="ignore", invalid="ignore"):
            history = simulate(scenario, floor_of(scenario))
            outcome = assess_run(number, scenario, history)
        if histories is not None:
            write_histories([Run(scenario, history, {})], histories / f"run-{number:07d}.parquet")
    except SeatsimError as error:
        return Outcome(number, FAILED, str(error), seed, (None,) * len(METRICS))
    except Exception as error:  # a model of the user's own may raise anything, and the other runs go on
        return Outcome(number, FAILED, explain(error), seed, (None,) * len(METRICS))
    return outcome


def assess_run(number: int, scenario: Scenario, history: History) -> Outcome:
    """Return the outcome of a run that reached its end."""
    metrics = measure_run(scenario, history)
    reason = "; ".join(list_reasons(scenario, history, metrics))
    figures = tuple(metrics[name].value if name in metrics else None for name in METRICS)
    return Outcome(number, UNVERIFIED if reason else DONE, reason, scenario.seed, figures)


def floor_of(scenario: Scenario) -> Floor | None:
    """Return the floor of a scenario, from the floors kept where it is among them; None where it has none."""
    if scenario.excitation is None:
        return None
    with scenario.placed("excitation"):
        return _make_floor(scenario.excitation, scenario.solver.step, scenario.seed)


# By type, as records of two classes with the same values are equal.
@lru_cache(maxsize=FLOORS_KEPT, typed=True)
def _make_floor(excitation: Excitation, step: float, seed: int) -> Floor:
    return excitation.floor(step, seed)


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


_BATCH, _LONGEST_BATCH = 20, 0.2
"""Most runs that a process is given at once, and seconds that they may take: so much is lost where it is killed."""
_SHARES = 4
"""Towards the end a batch is this part of what is left for each worker, so that all of them end together."""
_AT_HAND = 2
"""Batches that a process has, one of which it works on."""


class LocalEngine(NamedTuple):
    """Simulates up to `jobs` runs at once.

    The first runs, and what has to be compiled for them, are this process's. There is one further process for every
    `worth_a_process` seconds that it would need alone for what is left, since a start takes a processor a second.
    """

    jobs: int
    worth_a_process: float = 3.0

    def __call__(self, work: Work) -> Generator[list[Outcome]]:
        """Yield outcomes as they come.

        Raises:
            RunError: a process was lost.
        """
        try:
            yield from self._work_off(work)
        except BrokenProcessPool as error:
            lost = "a process was lost, mostly for want of memory; what has ended is kept"
            raise RunError(f"{lost}: go on with --resume and fewer --jobs") from error

    def _work_off(self, work: Work) -> Generator[list[Outcome]]:
        waiting, processes, since, done = deque(run for task in work.tasks for run in task), 0, 0.0, 0
        given, here, pool = set[Future[list[Outcome]]](), Future[list[Outcome]](), None
        # Libraries of linear algebra get one thread: the other processors simulate other runs.
        with threadpool_limits(1), ExitStack() as ends:
            # Nobody waits for the thread, which may be in the middle of a run.
            thread = ThreadPoolExecutor(1)
            ends.callback(thread.shutdown, wait=False, cancel_futures=True)
            while waiting or given:
                if here not in given and waiting:
                    here = thread.submit(_simulate, [waiting.popleft()], work)
                    given.add(here)
                if done and waiting:
                    pace = (time.monotonic() - since) / done
                    if pool is None and (processes := self._count_processes(pace * len(waiting))):
                        # Without the scenarios that the plan keeps: the thread adds to them at any time.
                        light = work._replace(plan=replace(work.plan), tasks=())
                        pool = ends.enter_context(open_pool(processes, partial(_take_work, light)))
                    size = max(1, int(min(_BATCH, _LONGEST_BATCH // pace, len(waiting) // (_SHARES * self.jobs))))
                    while pool and waiting and len(given) <= _AT_HAND * processes:
                        given.add(pool.submit(_simulate, [waiting.popleft() for _ in range(min(size, len(waiting)))]))
                ended, given = wait(given, return_when=FIRST_COMPLETED)
                if here in ended:
                    # From the first outcome on, since something may have been compiled for it.
                    since, done = (since, done + 1) if since else (time.monotonic(), 0)
                yield [outcome for future in ended if not future.exception() for outcome in future.result()]
                for future in ended:
                    future.result()

    def _count_processes(self, alone: float) -> int:
        """Return how many further processes pay where this one would need so many seconds alone."""
        return int(min(self.jobs - 1, alone // self.worth_a_process))


_taken: list[Work] = []
"""What a process of the pool was given to work on, when it started."""


def _take_work(work: Work) -> None:
    _taken.append(work)
    threadpool_limits(1)


def _simulate(runs: Sequence[int], work: Work | None = None) -> list[Outcome]:
    """Simulate some runs of the work, that which this process has taken where none is given."""
    plan, _, histories = work or _taken[0]
    return [simulate_one(plan, run, run, histories) for run in runs]
