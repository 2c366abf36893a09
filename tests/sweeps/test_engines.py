"""The local engine: processes beside this one, and what becomes of a sweep when one of them, or this one, ends."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import seatsim
from seatsim.scenario.loading import single
from seatsim.schema.errors import RunError
from seatsim.sweeps.engines import FLOORS_KEPT, LocalEngine, floor_of

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
    """A sweep of 60 runs in which one process dies."""
    (tmp_path / "deadly.py").write_text(DEADLY)
    (tmp_path / "one.life").touch()
    seatsim.use(tmp_path / "deadly.py")
    seeds = {"seed": {"from": 1, "to": 60, "steps": 60}}
    return write_sweep(vary={**seeds, "excitation": [{"kind": "deadly", "duration": 0.5}]}, runs=None)


def test_a_sweep_of_which_a_process_was_lost_is_gone_on_with(deadly, carry_out, tmp_path):
    carry_out(deadly, "alone", LocalEngine(1))
    assert list(tmp_path.glob("*.life")), "a process was started where one run at a time was asked for"
    # The thread of this process waits for what is taken from it, so that the other process has its turn.
    with pytest.raises(RunError, match=r"a process was lost.* go on with --resume"):
        carry_out(deadly, engine=EAGER, progress=lambda done, runs: time.sleep(0.2))
    assert 0 < len(seatsim.read_sweep(tmp_path / "out")) < 60
    carry_out(deadly, engine=EAGER, resume=True)
    assert bytes_of(tmp_path / "out") == bytes_of(tmp_path / "alone")


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


def test_a_floor_is_made_once_for_equal_scenarios_and_anew_for_another_seed_or_road(seat_file):
    def floor(**settings):
        return floor_of(single(seat_file, {"excitation.duration": 0.5, **settings}))

    first = floor(seed=1)
    assert floor(seed=1) is first
    for other in (floor(seed=2), floor(seed=1, **{"excitation.spectral_class": "EM1"})):
        assert not np.array_equal(other.acceleration, first.acceleration)
    for seed in range(2, 3 + FLOORS_KEPT):
        floor(seed=seed)
    again = floor(seed=1)
    assert again is not first
    np.testing.assert_array_equal(again.acceleration, first.acceleration)
