"""Jobs in fresh processes, in one place."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from multiprocessing import active_children, get_context, parent_process
from pathlib import Path
from threading import Thread
from typing import TypeVar, TypeVarTuple

from seatsim.schema.modules import started_elsewhere, use_all, used_files

Result = TypeVar("Result")
Arguments = TypeVarTuple("Arguments")
Progress = Callable[[int, int], None]
"""Called with jobs done and jobs in all."""


def run_jobs(
    function: Callable[[*Arguments], Result],
    jobs: Sequence[tuple[*Arguments]],
    processes: int,
    progress: Progress | None = None,
) -> list[Result]:
    """Call a picklable function with each tuple of arguments and return the results in order.

    Up to `processes` spawned processes share the jobs (a fork would copy the threads of BLAS and numba in an unknown
    state); with one process, or one job, none is started. The first error, and Ctrl-C, cancels what has not begun.
    """
    if processes <= 1 or len(jobs) <= 1:
        return _run_here(function, jobs, progress)
    workers, files = min(processes, len(jobs)), (used_files(),)
    with started_elsewhere():
        pool = ProcessPoolExecutor(workers, get_context("spawn"), initializer=_start_worker, initargs=files)
        futures = [pool.submit(function, *job) for job in jobs]
    waiting = set(futures)
    try:
        while waiting:
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for future in done:
                future.result()
            if progress:
                progress(len(jobs) - len(waiting), len(jobs))
    except KeyboardInterrupt:
        for worker in active_children():
            worker.terminate()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
    return [future.result() for future in futures]


def _run_here(
    function: Callable[[*Arguments], Result], jobs: Sequence[tuple[*Arguments]], progress: Progress | None
) -> list[Result]:
    results = []
    for job in jobs:
        results.append(function(*job))
        if progress:
            progress(len(results), len(jobs))
    return results


def _start_worker(files: tuple[Path, ...]) -> None:
    """Load the user's own files, leave Ctrl-C to the parent, which ends its children, and end where it was killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_parent, daemon=True).start()
    use_all(files)


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
