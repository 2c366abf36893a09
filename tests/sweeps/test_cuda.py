"""Engine `cuda`: the rows of engine `local` where numba simulates the device; what is refused without one."""

import os
import subprocess
import sys
from pathlib import Path

from seatsim.kernel import cuda_lanes
from seatsim.sweeps import device

FEEDBACK = {"law": "static_output_feedback", "gain": [2.0, 2147.6], "sample_time": 0.005}
NOISY = {"bandwidth": 80.0, "displacement_noise": 1e-4, "acceleration_noise": 0.05}
VARY = {
    "damper": [{"model": name} for name in ("modified_bouc_wen", "yu2019", "original_bingham", "modified_bouc_wen")],
    "controller": [
        FEEDBACK | {"sensors": NOISY},
        FEEDBACK | {"inverse": {"model": "modified_bouc_wen", "temperature": 20.0}},
        {"law": "skyhook", "damping": 2000.0, "sample_time": 0.002},
        {"law": "constant", "current": 0.2},
    ],
    "temperature": [20.0, 60.0, {"start": 20.0, "ambient": 10.0, "heat_capacity": 50.0, "conductance": 1.0}, 20.0],
    "actuator.delay": [0.0034, 0.0, 0.002, 0.0],
    "driver": [{"model": name} for name in ("single_mass", "single_mass", "iso5982", "single_mass")],
    "excitation.duration": [0.03, 0.4, 0.03, 0.01],
    "plant.travel": [[-0.004, 0.004], [-0.05, 0.05], [-0.05, 0.05], [-0.05, 0.05]],
    "effects": [
        [{"effect": "suspension.end_stop", "parameters": {"low": -0.0005, "high": 0.0005}}],
        [],
        [],
        [{"effect": "floor.unmeasured_input", "parameters": {"rms": 5.0}}],
    ],
}
"""The last of these runs has a force over time, for which a lane has no room."""


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
