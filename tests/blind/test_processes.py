"""Jobs in processes: results in order, progress, and errors that reach the caller."""

import pytest

from seatsim.schema.processes import run_jobs

JOBS = [(7, 2), (9, 4), (11, 3)]


@pytest.mark.parametrize("processes", [1, 2])
def test_results_come_in_order_with_progress_and_an_error_reaches_the_caller(processes):
    counts = []
    found = run_jobs(divmod, JOBS, processes, lambda done, total: counts.append((done, total)))
    assert found == [(3, 1), (2, 1), (3, 2)]
    assert counts[-1] == (3, 3) and [done for done, _ in counts] == sorted(done for done, _ in counts)
    with pytest.raises(ZeroDivisionError):
        run_jobs(divmod, [(1, 0), *JOBS], processes)


def test_no_jobs_start_no_process():
    assert run_jobs(divmod, [], 2) == []
