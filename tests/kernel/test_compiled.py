"""Compiled code computes what the same functions compute as plain Python."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
RUN = """
import json, sys
from seatsim.compilation import jit
if sys.argv[2] == "strict":
    for options in (jit.ARITHMETIC, jit.INLINED):
        options["fastmath"] = False
import seatsim
history = seatsim.run(sys.argv[1], {"excitation.duration": 0.2}).runs[0].history
print(json.dumps({name: [value.hex() for value in values.tolist()] for name, values in history.channels.items()}))
"""


def run(file, way, folder, **environment):
    """The channels of a run in a process of its own, every number in full."""
    environment = os.environ | {"SEATSIM_CACHE_DIR": str(folder)} | environment
    command = [sys.executable, "-c", RUN, str(file), way]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    return {name: [float.fromhex(value) for value in values] for name, values in json.loads(done.stdout).items()}


@pytest.mark.slow
def test_a_run_is_that_of_plain_python_to_the_last_bit(seat_file, tmp_path):
    plain = run(seat_file, "plain", tmp_path, NUMBA_DISABLE_JIT="1")
    strict = run(seat_file, "strict", tmp_path)
    assert plain.keys() == strict.keys()
    for name, values in plain.items():
        assert np.array_equal(values, strict[name], equal_nan=True), name
    # As it is shipped, sums may be fused and reordered, which shows in the last digits only.
    fused = run(seat_file, "fused", os.environ.get("SEATSIM_CACHE_DIR", tmp_path / "fused"))
    for name, values in plain.items():
        scale = np.max(np.abs(values))
        assert fused[name] == pytest.approx(values, rel=1e-9, abs=1e-10 * scale, nan_ok=True), name
