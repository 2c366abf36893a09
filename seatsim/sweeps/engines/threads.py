"""Engine `local`: threads over the compiled kernel, which releases Python's lock."""

from __future__ import annotations

import queue
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from seatsim.sweeps.engines.base import Work, simulate_one
from seatsim.sweeps.outcome import Outcome

BATCH = 20
"""Runs that a thread takes at once."""
LONGEST_WAIT = 0.2
"""Seconds after which a thread hands over what it has, so that little is lost where the process is killed."""
SWITCH_INTERVAL = 5e-4
"""Seconds that a thread may keep Python's lock while another waits to start its next compiled call; Python's own 5 ms
are longer than a run."""


class ThreadEngine(NamedTuple):
    """Simulates runs on `jobs` threads of this process."""

    jobs: int

    def __call__(self, work: Work) -> Iterator[list[Outcome]]:
        """Yield outcomes as threads hand them over."""
        batches = _Shared(work)
        left = sum(map(len, work.tasks))
        with _short_switches():
            try:
                for _ in range(min(self.jobs, left)):
                    # A daemon does not keep the process from ending, however long its run still takes.
                    threading.Thread(target=batches.simulate, daemon=True).start()
                while left:
                    outcomes = batches.outcomes.get()
                    if isinstance(outcomes, BaseException):
                        raise outcomes
                    left -= len(outcomes)
                    yield outcomes
            finally:
                batches.stopped.set()


class _Shared:
    """What the threads share: the batches that are left, and the outcomes."""

    def __init__(self, work: Work) -> None:
        self.work = work
        self.outcomes: queue.SimpleQueue[list[Outcome] | BaseException] = queue.SimpleQueue()
        self.stopped = threading.Event()
        self._batches = (task[at : at + BATCH] for task in work.tasks for at in range(0, len(task), BATCH))
        self._taking = threading.Lock()

    def simulate(self) -> None:
        try:
            while batch := self._take():
                self._simulate_batch(batch)
        except BaseException as error:
            self.outcomes.put(error)

    def _take(self) -> Sequence[int]:
        with self._taking:
            return next(self._batches, ())

    def _simulate_batch(self, batch: Sequence[int]) -> None:
        found: list[Outcome] = []
        since = time.monotonic()
        for run in batch:
            if self.stopped.is_set():
                return
            found.append(simulate_one(self.work.plan, run, run, self.work.histories))
            if time.monotonic() - since > LONGEST_WAIT:
                self.outcomes.put(found)
                found, since = [], time.monotonic()
        if found:
            self.outcomes.put(found)


@contextmanager
def _short_switches() -> Iterator[None]:
    before = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_INTERVAL)
    try:
        yield
    finally:
        sys.setswitchinterval(before)
