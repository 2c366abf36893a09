"""Engine `cuda`: the rows of engine `local` where numba simulates the device; what is refused without one."""

import os
import subprocess
import sys
from pathlib import Path

from seatsim.kernel import cuda_lanes
from seatsim.sweeps import device

from ..text import beside, parse

VARY = parse(beside(__file__, "cuda_runs.yaml"))


def test_rows_are_those_of_the_local_engine(write_sweep, tmp_path):
    write_sweep(vary=VARY, runs=None, design="zip")
    environment = os.environ | {"NUMBA_ENABLE_CUDASIM": "1"}
    command = [sys.executable, Path(__file__).with_name("cuda_simulated.py"), tmp_path]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("1 of 4 runs are simulated on the processor: ") and "4 rows agree" in done.stdout


def test_what_cannot_be_done_is_one_sentence(write_sweep, tmp_path, seatsim_command, monkeypatch):
    path, out = write_sweep(runs=2), tmp_path / "out"
    for compiler, options, sentence in (
        (True, ["--keep", "histories"], "no histories are kept on the device"),
        (None, [], 'install it with: pip install "seatsim[cuda]"'),
        (True, [], "no CUDA device can be used here"),
    ):
        monkeypatch.setattr(device, "find_spec", lambda name, compiler=compiler: compiler)
        monkeypatch.setattr(cuda_lanes, "has_device", lambda: False)
        status, _, err = seatsim_command("sweep", path, "--out", out, "--engine", "cuda", *options)
        assert status == 2 and sentence in err and err.count("\n") == 1 and not out.exists()
