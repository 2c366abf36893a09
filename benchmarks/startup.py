"""Time from a call to the first sample in a fresh process: `python benchmarks/startup.py`.

Processes share one cache folder, empty at first: the first compiles, the others load. Printed are the import, the
call (digest of the sources, compiled code from disk, a run of two samples), and `seatsim.run` of the quickstart with
four runs, from its import to its table.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

PROCESSES = 4
CALL = """
import time
start = time.perf_counter()
import numpy as np
import seatsim.simulation.simulate
from seat_run import floor, seatsim_run, setup
acceleration, parts = np.zeros(2), setup(1)
imported = time.perf_counter()
seatsim_run(acceleration, parts)[0]()
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


def python(code: str, environment: dict[str, str]) -> str:
    """Run Python in this folder and return what it prints."""
    folder = Path(__file__).parent
    command = [sys.executable, "-c", code]
    return subprocess.run(command, env=environment, cwd=folder, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    main()
