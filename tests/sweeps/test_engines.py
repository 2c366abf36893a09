"""The local engine: processes beside this one, and what becomes of a sweep when one of them, or this one, ends."""

import os
import signal
import subprocess
import sys
import time

import pytest

import seatsim
from seatsim.schema.errors import RunError
from seatsim.sweeps.engines import LocalEngine

from .conftest import bytes_of, floor_code

EAGER = LocalEngine(2, worth_a_process=1e-9)
"""Starts a process whatever is left."""
SWEEP = """
import sys
from pathlib import Path
from seatsim.sweeps.engines import LocalEngine
from seatsim.sweeps.execute import execute, prepare

execute(prepare(Path(sys.argv[1])), Path(sys.argv[2]), LocalEngine(2, worth_a_process=1e-9))
"""
DEADLY = floor_code(
    "deadly",
    """
        if parent_process():
            for life in Path(__file__).parent.glob("*.life"):
                life.unlink()
                os.kill(os.getpid(), signal.SIGKILL)
""",
)
"""A floor whose making ends the process, where this is not the one of the command, as often as is left of it."""


@pytest.fixture
def deadly(write_sweep, tmp_path, forget_own_code):
    """Return a function that writes a sweep in which as many processes die, one after the other."""
    (tmp_path / "deadly.py").write_text(DEADLY)
    seatsim.use(tmp_path / "deadly.py")

    def write(deaths, runs=60):
        for number in range(deaths):
            (tmp_path / f"{number}.life").touch()
        seeds = {"seed": {"from": 1, "to": runs, "steps": runs}}
        return write_sweep(vary={**seeds, "excitation": [{"kind": "deadly", "duration": 0.5}]}, runs=None)

    return write


def test_the_runs_of_a_process_that_is_killed_are_simulated_by_others(deadly, carry_out, tmp_path):
    carry_out(deadly(1), "alone", LocalEngine(1))
    assert list(tmp_path.glob("*.life")), "a process was started where one run at a time was asked for"
    # The thread of this process waits for what is taken from it, so that the other process has its turn.
    carry_out(deadly(1), engine=EAGER, progress=lambda done, runs: time.sleep(0.2))
    assert not list(tmp_path.glob("*.life"))
    assert bytes_of(tmp_path / "out") == bytes_of(tmp_path / "alone")


@pytest.mark.slow
def test_processes_that_are_lost_one_after_the_other_end_the_sweep(deadly, carry_out, tmp_path):
    with pytest.raises(RunError, match=r"processes were lost 4 times.* go on with --resume"):
        carry_out(deadly(10, runs=2000), engine=EAGER)
    assert 0 < len(seatsim.read_sweep(tmp_path / "out")) < 2000


@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_no_process_outlives_the_command(how, write_sweep, tmp_path):
    path = write_sweep(runs=100_000)
    command = [sys.executable, "-c", SWEEP, str(path), str(tmp_path / "out")]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as process:
        while not (workers := children_of(process.pid)):
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(how)
    deadline = time.monotonic() + 120
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
