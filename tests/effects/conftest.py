"""Shared rigs."""

import pytest

from ..text import parse
from .rigs import seat

BOUC_WEN = parse("""
    {c_a: 250.0, c_b: 350.0, alpha_a: 45.0, alpha_b: 620.0, k0: 0.0, x0: 0.0, f0: 0.0, A: 2000.0, beta: 1000.0,
     gamma: 1000.0, n: 2.0}
""")


@pytest.fixture(scope="session")
def bingham(tmp_path_factory):
    """The seat with a Bingham damper."""
    return seat(tmp_path_factory.mktemp("bingham"))


@pytest.fixture(scope="session")
def bouc_wen(tmp_path_factory):
    """The seat with a Bouc-Wen damper."""
    return seat(tmp_path_factory.mktemp("bouc_wen"), {"damper.model": "bouc_wen", "damper.parameters": BOUC_WEN})
