"""Time from a call to the first sample in a fresh process: `python benchmarks/startup.py`.

Processes share one cache folder, empty at first: the first compiles, the others load. Printed are the import, the
call (digest of the sources, compiled code from disk, a run of two samples), `seatsim.run` of the quickstart with
four runs, from its import to its table, the whole command that a newcomer gives, and the processor time of `--help` of
every command.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from seatsim.cli.app import app

PROCESSES = 4
CALL = """
import time
start = time.perf_counter()
import numpy as np
import seatsim.simulation.simulate
from seat_run import make_setup, prepare_run
acceleration, parts = np.zeros(2), make_setup(1)
imported = time.perf_counter()
prepare_run(acceleration, parts)
print(imported - start, time.perf_counter() - imported)
"""
RUN = """
import time
start = time.perf_counter()
import seatsim
seatsim.run("quickstart").table
print(time.perf_counter() - start)
"""


def main() -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"SEATSIM_CACHE_DIR": folder}
        for process in range(1, PROCESSES + 1):
            imported, called = map(float, python(CALL, environment).split())
            print(f"process {process}: import {imported:.2f} s, from call to first sample {called:.3f} s")
        for process in range(1, PROCESSES + 1):
            print(f"process {process}: quickstart {float(python(RUN, environment)):.2f} s")
    with tempfile.TemporaryDirectory() as folder:
        for process in (1, 2):
            command = ["run", "quickstart", "--out", f"{folder}/out"]
            wall, cpu = time_command(command, os.environ | {"SEATSIM_CACHE_DIR": folder})
            print(f"process {process}: seatsim run quickstart {wall:.2f} s, {cpu:.2f} s of processors")
    for each in app.registered_commands:
        name = each.name or getattr(each.callback, "__name__", "").replace("_", "-")
        cpu = min(time_command([name, "--help"], dict(os.environ))[1] for _ in range(PROCESSES))
        print(f"seatsim {name} --help: {cpu:.3f} s of a processor")


def time_command(arguments: list[str], environment: dict[str, str]) -> tuple[float, float]:
    """Run a command of seatsim, and return the time it takes and that of the processors, user and system, in s."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    command = [sys.executable, "-m", "seatsim", *arguments]
    subprocess.run(command, env=environment, check=True, capture_output=True)
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def python(code: str, environment: dict[str, str]) -> str:
    """Run Python in this folder and return what it prints."""
    folder = Path(__file__).parent
    command = [sys.executable, "-c", code]
    return subprocess.run(command, env=environment, cwd=folder, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    main()
