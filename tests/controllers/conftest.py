"""Plants for the tests of the synthesis."""

import importlib.util
import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from controllers.synthesis import SEAT_TIME_BUDGET, GeneralisedPlant, synthesise


@pytest.fixture(scope="session")
def seat():
    """Build the exact seat: disturbance z0'', control Fd, z = (e1 x, zc''), y = (x, v)."""

    def build(e1, structure=None, ms=20.0, m=80.0, kf=4600.0, cf=200.0, kc=60000.0, cc=1500.0):
        both = 1 / m + 1 / ms
        frame, cushion = [-kf / ms, -cf / ms, kc / ms, cc / ms], [kf / ms, cf / ms, -kc * both, -cc * both]
        A = [[0, 1, 0, 0], frame, [0, 0, 0, 1], cushion]
        C1 = [[e1, 0, 0, 0], [0, 0, -kc / m, -cc / m]]
        nothing = np.zeros((2, 1))
        B1, B2, C2 = [[0], [-1], [0], [0]], [[0], [-1 / ms], [0], [1 / ms]], np.eye(2, 4)
        return GeneralisedPlant(A, B1, B2, C1, C2, nothing, nothing, nothing, structure)

    return build


@pytest.fixture(scope="session")
def designed(seat):
    """The design for the exact seat, by e1, synthesised once."""
    return cache(lambda e1: synthesise(seat(e1), time_budget=SEAT_TIME_BUDGET))


@pytest.fixture
def random_plant():
    """Build a random plant with all eight matrices full."""

    def build(seed, n=4, nw=2, nu=2, nz=3, ny=2, structure=None):
        random = np.random.default_rng(seed)
        shapes = ((n, n), (n, nw), (n, nu), (nz, n), (ny, n), (nz, nw), (nz, nu), (ny, nw))
        return GeneralisedPlant(*(random.standard_normal(shape) for shape in shapes), structure)

    return build


@pytest.fixture(scope="session")
def exact_certificates():
    """Load the script that verifies designs in rational arithmetic."""
    path = Path(__file__).parents[2] / "benchmarks" / "exact_certificates.py"
    spec = importlib.util.spec_from_file_location("exact_certificates", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def complib(shared):
    """Load a problem of the COMPleib benchmark."""

    def load(name):
        p = json.loads((shared / "complib" / f"{name}.json").read_text())
        return GeneralisedPlant(*(p[key] for key in ("A", "B1", "B", "C1", "C", "D11", "D12", "D21")))

    return load
