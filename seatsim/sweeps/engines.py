"""Engines of a sweep: what an engine is given and returns, and the engine `local`.

It is a thread of this process and, where they pay, further processes of this machine. Most of a short run is Python
between compiled calls. Threads of one process take turns with it, processes do not.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import TracebackType
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
_MOST_LOST = 3
"""Times that processes may be lost before the sweep ends: others get their runs, which may be what ends them."""


class LocalEngine(NamedTuple):
    """Simulates up to `jobs` runs at once.

    The first runs, and what has to be compiled for them, are this process's. There is one further process for every
    `worth_a_process` seconds that it would need alone for what is left, since a start takes a processor a second.
    """

    jobs: int
    worth_a_process: float = 3.0

    def __call__(self, work: Work) -> Generator[list[Outcome]]:
        """Yield outcomes as they come; the runs of a process that is lost are simulated again by others.

        Raises:
            RunError: processes were lost several times, one after the other.
        """
        with _Crew(work, self) as crew:
            while crew.left:
                yield crew.receive()


class _Crew:
    """A thread, a pool of processes once it pays, the runs that they were given and those that nobody was given yet."""

    def __init__(self, work: Work, engine: LocalEngine) -> None:
        self._work, self._engine = work, engine
        self._waiting = deque(run for task in work.tasks for run in task)
        self.left = len(self._waiting)
        self._given: dict[Future[list[Outcome]], list[int]] = {}
        self._here: Future[list[Outcome]] | None = None
        self._thread = ThreadPoolExecutor(1)
        self._pool: ProcessPoolExecutor | None = None
        self._ends = ExitStack()
        self._processes = self._lost = 0
        self._since, self._done_here = 0.0, 0

    def __enter__(self) -> _Crew:
        # Libraries of linear algebra get one thread: the other processors simulate other runs.
        self._ends.enter_context(threadpool_limits(1))
        self._give()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End all, in the middle of a run too; nobody waits for the thread."""
        self._thread.shutdown(wait=False, cancel_futures=True)
        self._ends.__exit__(kind, error, trace)

    def receive(self) -> list[Outcome]:
        """Return the outcomes that are there, once there are some, and give out more runs."""
        outcomes: list[Outcome] = []
        for future in wait(self._given, return_when=FIRST_COMPLETED).done:
            try:
                found = future.result()
            except BrokenProcessPool:
                self._lose_pool()
                break
            del self._given[future]
            outcomes += found
            if future is self._here:
                self._here = None
                # From the first outcomes on, since something may have been compiled for these.
                if self._since:
                    self._done_here += len(found)
                else:
                    self._since = time.monotonic()
        self.left -= len(outcomes)
        self._give()
        return outcomes

    def _give(self) -> None:
        """See to it that the thread has a run, and every process a batch beside the one that it works on."""
        if self._here is None and self._waiting:
            run = self._waiting.popleft()
            plan, histories = self._work.plan, self._work.histories
            self._here = self._thread.submit(lambda: [simulate_one(plan, run, run, histories)])
            self._given[self._here] = [run]
        if not self._done_here:
            return
        pace = (time.monotonic() - self._since) / self._done_here
        if self._pool is None:
            self._processes = int(min(self._engine.jobs - 1, pace * self.left // self._engine.worth_a_process))
            if self._processes < 1:
                return
            # Without the scenarios that the plan keeps: the thread adds to them at any time.
            work = Work(replace(self._work.plan), (), self._work.histories)
            self._pool = self._ends.enter_context(open_pool(self._processes, partial(_take_work, work)))
        longest = min(_BATCH, _LONGEST_BATCH // pace)
        size = int(max(1, min(longest, len(self._waiting) // (_SHARES * self._engine.jobs))))
        while self._waiting and len(self._given) - (self._here is not None) < _AT_HAND * self._processes:
            batch = [self._waiting.popleft() for _ in range(min(size, len(self._waiting)))]
            try:
                self._given[self._pool.submit(_simulate, batch)] = batch
            except BrokenProcessPool:
                self._waiting.extendleft(reversed(batch))
                return self._lose_pool()

    def _lose_pool(self) -> None:
        """Take back the runs of a pool of which a process was lost, so that the next one gets them."""
        self._lost += 1
        self._ends.pop_all().close()
        self._ends.enter_context(threadpool_limits(1))
        if self._lost > _MOST_LOST:
            raise RunError(
                f"processes were lost {self._lost} times, mostly for want of memory; what has ended is kept: go on with"
                " --resume and fewer --jobs"
            )
        for future in [future for future in self._given if future is not self._here]:
            self._waiting.extendleft(reversed(self._given.pop(future)))
        self._pool = None


_taken: list[Work] = []
"""What a process of the pool was given to work on, when it started."""


def _take_work(work: Work) -> None:
    _taken.append(work)
    threadpool_limits(1)


def _simulate(runs: Sequence[int]) -> list[Outcome]:
    """Simulate some runs of the work that this process has taken."""
    return [simulate_one(_taken[0].plan, run, run, _taken[0].histories) for run in runs]
