"""A few random parameters of every damper; the benchmark takes thousands."""

import os
import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).parents[2] / "benchmarks" / "parameter_space.py"


def test_every_damper_is_finite_passive_symmetric_and_inverted_for_random_parameters():
    # Without compiling, which would take longer than so few sets.
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, str(SCRIPT), "--sets", "38", "--seed", "1"]
    answer = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=300)
    header, *_, total = answer.stdout.splitlines()
    found = dict(zip(header.split()[1:], map(int, total.split()[1:]), strict=True))
    assert found == dict.fromkeys(found, 0) | {"refused": found["refused"]}
