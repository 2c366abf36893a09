"""Time from a call to the first sample in a fresh process: `python benchmarks/startup.py`.

Processes share one cache folder, empty at first: the first compiles, the others load. Printed are the import, the
call itself (digest of the sources, compiled code from disk, a run of two samples), and a run through the command
line, from the shell's point of view.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROCESSES = 6
CALL = """
import time
start = time.perf_counter()
import numpy as np
import seatsim.simulation
from problem import floor, seatsim_run, setup
acceleration, parts = np.zeros(2), setup(1)
imported = time.perf_counter()
seatsim_run(acceleration, parts)[0]()
print(imported - start, time.perf_counter() - imported)
"""


def main() -> None:
    """Measure and print."""
    scenario = Path(__file__).parents[1] / "scenarios" / "quickstart.yaml"
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"SEATSIM_CACHE_DIR": folder}
        for process in range(PROCESSES):
            imported, called = map(float, python(["-c", CALL], environment).split())
            print(f"process {process + 1}: import {imported:.2f} s, from call to first sample {called:.3f} s")
        for process in range(PROCESSES // 2):
            start = time.perf_counter()
            python(["-m", "seatsim.cli", "run", str(scenario)], environment)
            print(f"command line, process {process + 1}: {time.perf_counter() - start:.2f} s in all")


def python(arguments: list[str], environment: dict[str, str]) -> str:
    """Run Python in this folder and return what it prints."""
    folder = Path(__file__).parent
    command = [sys.executable, *arguments]
    return subprocess.run(command, env=environment, cwd=folder, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    main()
