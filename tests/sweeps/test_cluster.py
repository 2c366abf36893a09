"""Engine `dask`: the same bytes on an embedded cluster and on one that was started beside it, whose worker may die."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections import Counter
from contextlib import ExitStack
from itertools import chain
from threading import Thread

import pytest

from seatsim.sweeps import parts

from .conftest import bytes_of, floor_code

FLOORS = floor_code(
    "logged",
    """
        if folder := os.environ.get("LOGGED_FLOORS"):
            with open(f"{folder}/{os.getpid()}.log", "a") as log:
                log.write(f"{seed}\\n")
            if seed == 15 and not (stuck := Path(folder, "stuck")).exists():
                stuck.write_text(str(os.getpid()))
                time.sleep(60)
""",
)
"""A floor that says which process makes it for which seed; the first one for a seed takes a minute."""
TASK = 10
"""Runs of a task; there are more tasks than are sent at once."""


@pytest.fixture(autouse=True)
def small_tasks(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(parts, "RUNS_OF_PART", TASK)


@pytest.fixture
def address(tmp_path):
    """Start a scheduler and two workers, which note their floors in the folder `floors`; return its address."""
    (tmp_path / "floors").mkdir()
    with socket.create_server(("127.0.0.1", 0)) as free:
        host, port = free.getsockname()
    environment = {**os.environ, "LOGGED_FLOORS": str(tmp_path / "floors")}
    scheduler = ["dask_scheduler", "--host", host, "--port", str(port)]
    worker = ["dask_worker", f"tcp://{host}:{port}", "--nthreads", "1", "--no-nanny"]
    with ExitStack() as ends:
        for module, *options in (scheduler, worker, worker):
            command = [sys.executable, "-m", f"distributed.cli.{module}", *options, "--no-dashboard"]
            process = subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL, cwd=tmp_path)
            ends.enter_context(process)
            ends.callback(process.kill)
        await_that(lambda: answers(host, port))
        yield f"tcp://{host}:{port}"


@pytest.mark.slow
def test_an_embedded_cluster_gives_the_same_bytes(write_sweep, tmp_path, seatsim_command):
    path = write_sweep(runs=203)
    assert seatsim_command("sweep", path, "--out", tmp_path / "local")[0] == 0
    assert seatsim_command("sweep", path, "--out", tmp_path / "dask", "--engine", "dask", "--jobs", "2")[0] == 0
    assert bytes_of(tmp_path / "dask") == bytes_of(tmp_path / "local")


@pytest.mark.slow
def test_a_worker_that_dies_costs_its_tasks_once(write_sweep, tmp_path, seatsim_command, address, forget_own_code):
    (tmp_path / "floors.py").write_text(FLOORS)
    vary = {"excitation": [{"kind": "logged"}]}
    own = ["--with", tmp_path / "floors.py"]
    path = write_sweep(vary=vary, runs=None, replicates=20 * TASK)
    assert seatsim_command("sweep", path, "--out", tmp_path / "local", *own)[0] == 0
    stuck = tmp_path / "floors" / "stuck"

    def kill_stuck():
        await_that(lambda: stuck.exists() and stuck.read_text())
        os.kill(int(stuck.read_text()), signal.SIGKILL)

    killer = Thread(target=kill_stuck)
    killer.start()
    options = ["--engine", "dask", "--address", address, *own]
    assert seatsim_command("sweep", path, "--out", tmp_path / "dask", *options)[0] == 0
    killer.join()
    assert bytes_of(tmp_path / "dask") == bytes_of(tmp_path / "local")
    made = {log.stem: log.read_text().split() for log in (tmp_path / "floors").glob("*.log")}
    again = {seed for seed, times in Counter(chain.from_iterable(made.values())).items() if times > 1}
    assert len(made) == 2 and set(map(str, range(TASK, 16))) <= again <= set(made[stuck.read_text()])
    assert all(len(seeds) == len(set(seeds)) for seeds in made.values())


def await_that(holds):
    deadline = time.monotonic() + 600
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def answers(host, port):
    try:
        socket.create_connection((host, port)).close()
    except ConnectionRefusedError:
        return False
    return True
