"""Engine `local`: a thread of this process and, where they pay, further processes of this machine.

Most of a short run is Python between compiled calls. Threads of one process take turns with it, processes do not.
"""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Generator
from contextlib import ExitStack, closing, suppress
from dataclasses import dataclass, field, replace
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from typing import NamedTuple, cast

from seatsim.schema.errors import RunError
from seatsim.schema.modules import used_files
from seatsim.sweeps.engines.base import Work
from seatsim.sweeps.engines.worker import simulate_batches
from seatsim.sweeps.outcome import Outcome

BATCH = 20
"""Most runs that a worker is given at once."""
SHARES = 4
"""Towards the end a batch is this part of what is left for each worker, so that all of them end together."""
WORTH_A_PROCESS = 3.0
"""Seconds of work that justify a process, whose start takes above one second of a processor."""
MOST_LOST = 3
"""Processes that may be lost before the sweep ends: others get their runs, which may be what ends them."""


class LocalEngine(NamedTuple):
    """Simulates up to `jobs` runs at once.

    The first runs, and what has to be compiled for them, are this process's. There is one further process for every
    `WORTH_A_PROCESS` seconds that it would need alone for what is left.
    """

    jobs: int

    def __call__(self, work: Work) -> Generator[list[Outcome]]:
        """Yield outcomes as workers hand them over; those of a process that is lost are worked out by others.

        Raises:
            RunError: several processes were lost, one after the other.
        """
        with closing(_Crew(work, self.jobs)) as crew:
            crew.start_thread()
            while crew.left:
                for worker in crew.await_workers():
                    if outcomes := crew.receive(worker):
                        yield outcomes
                crew.start_processes()


@dataclass
class _Worker:
    """A worker: its connection, its process (None: a thread of this one), whether it is ready, and its runs."""

    connection: Connection
    process: subprocess.Popen[bytes] | None = None
    ready: bool = True
    runs: set[int] = field(default_factory=set)


class _Crew:
    """The workers, and the runs of which `left` have no outcome yet and `_waiting` are given to nobody."""

    def __init__(self, work: Work, jobs: int) -> None:
        self._work, self._jobs = work, jobs
        self._waiting = deque(run for task in work.tasks for run in task)
        self.left = len(self._waiting)
        self._workers: dict[Connection, _Worker] = {}
        self._lost = 0
        self._since, self._done_here = 0.0, 0

    def start_thread(self) -> None:
        """Start the worker in this process; as a daemon it does not keep it from ending, however long its run takes."""
        ours, theirs = Pipe()

        def simulate() -> None:
            with theirs, suppress(EOFError, OSError):
                simulate_batches(theirs, self._work.plan, self._work.histories)

        threading.Thread(target=simulate, daemon=True).start()
        self._workers[ours] = _Worker(ours)
        self._give(self._workers[ours])

    def start_processes(self) -> None:
        """Start as many processes as what is left justifies, by the pace of the runs in this process."""
        if self._done_here:
            alone = (time.monotonic() - self._since) / self._done_here * self.left
            while len(self._workers) < min(self._jobs, 1 + alone // WORTH_A_PROCESS):
                self._start_process()

    def _start_process(self) -> None:
        ours, theirs = Pipe()
        # Ctrl-C in a terminal reaches a whole group of processes; in groups of their own these are ended by this one.
        with theirs:
            process = subprocess.Popen(
                [sys.executable, "-P", "-m", "seatsim.sweeps.engines.worker", str(theirs.fileno())],
                stdin=subprocess.PIPE, pass_fds=[theirs.fileno()], process_group=0,
            )  # fmt: skip
        self._workers[ours] = _Worker(ours, process, ready=False)
        ours.send(used_files())

    def await_workers(self) -> list[_Worker]:
        """Return the workers that have something to say, once there are some."""
        return [self._workers[cast("Connection", each)] for each in wait(list(self._workers))]

    def receive(self, worker: _Worker) -> list[Outcome]:
        """Return the outcomes that a worker hands over, and give it more runs; none of one that is lost."""
        try:
            outcomes: list[Outcome] = worker.connection.recv()
            if not worker.ready:
                # Without the scenarios that the plan keeps: the thread adds to them at any time.
                worker.connection.send((replace(self._work.plan), self._work.histories))
                worker.ready = True
            worker.runs.difference_update(outcome.run for outcome in outcomes)
            self._give(worker)
        except (EOFError, OSError):
            self._lose(worker)
            return []
        self.left -= len(outcomes)
        if worker.process is None:
            self._count_here(len(outcomes))
        return outcomes

    def _count_here(self, runs: int) -> None:
        # From the first outcomes on, since something may have been compiled for these.
        if self._since:
            self._done_here += runs
        else:
            self._since = time.monotonic()

    def _give(self, worker: _Worker) -> None:
        """See to it that a worker has a batch at hand beside the one that it works on."""
        size = max(1, min(BATCH, len(self._waiting) // (SHARES * self._jobs)))
        while self._waiting and len(worker.runs) <= size:
            batch = [self._waiting.popleft() for _ in range(min(size, len(self._waiting)))]
            worker.runs.update(batch)
            # Where the worker is lost its connection says so next, and others get the batch.
            with suppress(OSError):
                worker.connection.send(batch)

    def _lose(self, worker: _Worker) -> None:
        """Give the runs of a worker that is lost to the others."""
        del self._workers[worker.connection]
        _end(worker)
        self._lost += 1
        if worker.process is None or self._lost > MOST_LOST:
            how = f"exit status {worker.process.returncode}" if worker.process else "see the error above"
            raise RunError(
                f"{self._lost} workers were lost ({how}), mostly for want of memory; what has ended is kept: go on with"
                " --resume and fewer --jobs"
            )
        self._waiting.extendleft(sorted(worker.runs, reverse=True))
        for other in self._workers.values():
            if other.ready:
                self._give(other)

    def close(self) -> None:
        """End all workers, in the middle of a run too."""
        with ExitStack() as stack:
            for worker in self._workers.values():
                stack.callback(_end, worker)


def _end(worker: _Worker) -> None:
    worker.connection.close()
    if worker.process:
        with worker.process:
            worker.process.kill()
