"""Engine `cuda` in numba's simulator: the rows of engine `local`, also of what it gives back to that."""

import os
import subprocess
import sys
from pathlib import Path


def test_rows_are_those_of_the_local_engine(write_sweep, tmp_path):
    laws = [{"law": "skyhook", "damping": 2000.0, "sample_time": 0.005}, {"law": "constant", "current": 0.2}]
    write_sweep(
        vary={"controller": laws, "excitation.duration": [0.04, 0.06], "actuator.delay": [0.0, 0.0034]}, runs=None
    )
    program = Path(__file__).with_name("cuda_simulated.py")
    environment = os.environ | {"NUMBA_ENABLE_CUDASIM": "1"}
    command = [sys.executable, program, tmp_path]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "8 rows agree\n"
