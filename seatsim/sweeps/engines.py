"""Engines of a sweep: what an engine is given and returns, and the engine `local`.

It is a thread of this process and, where they pay, further processes of this machine. Most of a short run is Python
between compiled calls. Threads of one process take turns with it, processes do not.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple, Protocol

from threadpoolctl import threadpool_limits

from seatsim.schema.errors import RunError
from seatsim.schema.processes import open_pool
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
                yield [outcome for future in ended for outcome in future.result()]

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
