"""Jobs in further processes of this machine: one pool, and one way to start its processes, for all commands.

Processes are spawned, since a fork would copy the threads of BLAS and numba in an unknown state. A script of a user
that makes some must therefore be one that can be imported: what it does stands under `if __name__ == "__main__":`.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from pathlib import Path
from threading import Thread
from typing import TypeVar, TypeVarTuple

from seatsim.schema.modules import started_elsewhere, use_all, used_files

_Result = TypeVar("_Result")
_Arguments = TypeVarTuple("_Arguments")
Progress = Callable[[int, int], None]
"""Called with jobs done and jobs in all."""


@contextmanager
def open_pool(processes: int, prepare: Callable[[], object] = tuple) -> Iterator[ProcessPoolExecutor]:
    """Give a pool of so many processes, which know the user's own files and have called `prepare`.

    They end with the block and with this process; where the block ends by an error, in the middle of a job.
    """
    before = set(active_children())
    start = (used_files(), prepare)
    with started_elsewhere():
        pool = ProcessPoolExecutor(processes, get_context("spawn"), initializer=_start_worker, initargs=start)
        try:
            yield pool
        except BaseException:
            for worker in set(active_children()) - before:
                worker.kill()
            raise
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def run_jobs(
    function: Callable[[*_Arguments], _Result],
    jobs: Sequence[tuple[*_Arguments]],
    processes: int,
    progress: Progress | None = None,
) -> list[_Result]:
    """Call a picklable function with each tuple of arguments and return the results in order.

    Up to `processes` processes share the jobs; with one process, or one job, none is started. The first error, and
    Ctrl-C, ends what has begun and cancels the rest.
    """
    results = []
    if processes <= 1 or len(jobs) <= 1:
        for job in jobs:
            results.append(function(*job))
            if progress:
                progress(len(results), len(jobs))
        return results
    with open_pool(min(processes, len(jobs))) as pool:
        futures = [pool.submit(function, *job) for job in jobs]
        for done, future in enumerate(as_completed(futures), 1):
            future.result()
            if progress:
                progress(done, len(jobs))
        return [future.result() for future in futures]


def _start_worker(files: tuple[Path, ...], prepare: Callable[[], object]) -> None:
    """Load the user's own files, leave Ctrl-C to the parent, which ends its children, and end where it was killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_parent, daemon=True).start()
    use_all(files)
    prepare()


def _end_with_parent() -> None:
    # Without this a process whose parent was killed goes on with its job, and waits for the next one for ever.
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
