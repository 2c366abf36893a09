"""Jobs in processes: results in order, progress, and errors that reach the caller."""

from __future__ import annotations

import pytest

from seatsim.schema.processes import run_jobs

JOBS = [(7, 2), (9, 4), (11, 3)]


@pytest.mark.parametrize("processes", [1, 2])
def test_results_come_in_order_and_progress_counts(processes: int) -> None:
    counts: list[tuple[int, int]] = []
    assert run_jobs(divmod, JOBS, processes, lambda done, total: counts.append((done, total))) == [
        (3, 1),
        (2, 1),
        (3, 2),
    ]
    assert counts[-1] == (3, 3) and [done for done, _ in counts] == sorted(done for done, _ in counts)


@pytest.mark.parametrize("processes", [1, 2])
def test_an_error_reaches_the_caller(processes: int) -> None:
    with pytest.raises(ZeroDivisionError):
        run_jobs(divmod, [(1, 0), *JOBS], processes)


def test_no_jobs_start_no_process() -> None:
    assert run_jobs(divmod, [], 2) == []
