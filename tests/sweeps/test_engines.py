"""The local engine: processes beside this one, and what becomes of a sweep when one of them, or this one, ends."""

import os
import signal
import subprocess
import sys
import time

import pytest

from seatsim.schema.errors import RunError
from seatsim.sweeps.engines import local

from .conftest import bytes_of

SWEEP = """
import sys
from pathlib import Path
from seatsim.sweeps.engines import local
from seatsim.sweeps.execute import execute, prepare

local.WORTH_A_PROCESS = 1e-6
execute(prepare(Path(sys.argv[1])), Path(sys.argv[2]), local.LocalEngine(2))
"""


@pytest.fixture
def started(monkeypatch):
    """Have a process started whatever is left, and return the list of those that were."""
    monkeypatch.setattr(local, "WORTH_A_PROCESS", 1e-6)
    found, start = [], subprocess.Popen

    def remember(*arguments, **options):
        found.append(start(*arguments, **options))
        return found[-1]

    monkeypatch.setattr(local.subprocess, "Popen", remember)
    return found


def test_a_process_that_is_killed_has_its_runs_simulated_by_others(
    write_sweep, carry_out, tmp_path, started, monkeypatch
):
    path, killed, receive = write_sweep(runs=2000), [], local._Crew.receive
    carry_out(path, "alone", jobs=1)
    assert not started

    def receive_and_kill(crew, worker):
        outcomes = receive(crew, worker)
        if worker.process and outcomes and not killed:
            killed.append(len(worker.runs))
            worker.process.kill()
        return outcomes

    monkeypatch.setattr(local._Crew, "receive", receive_and_kill)
    # The thread of this process waits for what is taken from it, so that the other process has its turn.
    carry_out(path, jobs=2, progress=lambda done, runs: killed or time.sleep(0.1))
    assert killed[0] > 0 and [process.returncode for process in started] == [-signal.SIGKILL] * len(started)
    assert bytes_of(tmp_path / "out") == bytes_of(tmp_path / "alone")


def test_processes_that_are_lost_one_after_the_other_end_the_sweep(write_sweep, carry_out, started):
    def kill(done, runs):
        started[-1].kill() if started else None

    with pytest.raises(RunError, match=r"4 workers were lost \(exit status -9\).* go on with --resume"):
        carry_out(write_sweep(runs=100_000), jobs=2, progress=kill)
    assert all(process.poll() is not None for process in started)


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_no_process_outlives_the_command(how, write_sweep, tmp_path):
    path = write_sweep(runs=100_000)
    command = [sys.executable, "-c", SWEEP, str(path), str(tmp_path / "out")]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as process:
        while not (workers := children_of(process.pid)):
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(how)
    deadline = time.monotonic() + 10
    while any(map(is_alive, workers)) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(map(is_alive, workers))


def children_of(process):
    with open(f"/proc/{process}/task/{process}/children") as file:
        return [int(number) for number in file.read().split()]


def is_alive(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True
