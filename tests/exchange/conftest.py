"""Hosts in C, which the benchmarks use too."""

import importlib.util
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture(scope="session")
def host():
    """The module that runs units in a host in C."""
    spec = importlib.util.spec_from_file_location("fmu_host", BENCHMARKS / "fmu_host.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["fmu_host"] = module
    spec.loader.exec_module(module)
    return module
