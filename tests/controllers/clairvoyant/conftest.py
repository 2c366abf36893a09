"""A short held-force problem, and the same in all forces at once."""

import numpy as np
import pytest

from controllers.clairvoyant.problem import HeldForceProblem, transcribe
from controllers.clairvoyant.recursion import ForceBand
from seatsim.rig.plant import Plant

SEAT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0, damper_ratio=0.8)


@pytest.fixture(scope="session")
def band():
    """A damper of the size of the quickstart's."""
    return ForceBand(c=250.0, f=45.0, b=600.0, a=665.0)


@pytest.fixture(scope="session")
def problem():
    """A quarter of a second on a rough floor, from a start out of rest."""
    random = np.random.default_rng(4)
    floor = np.convolve(6.0 * random.standard_normal(261), np.ones(10) / 10, mode="same")
    return HeldForceProblem(transcribe(SEAT, floor, 0.001, 5, (0.004, -0.15)), 30.0**2)


@pytest.fixture(scope="session")
def dense(problem):
    """The same in all forces at once.

    Return H, h, the constant, and G: criterion F H F + 2 h F + constant, damper velocity G F + w0.
    """
    t, n = problem.transcription, problem.intervals
    states = np.zeros((n, len(t.A), n))
    for k in range(1, n):
        states[k] = t.A @ states[k - 1]
        states[k, :, k - 1] += t.B
    y = np.concatenate([states, np.eye(n)[:, None, :]], axis=1)
    Q = t.acceleration.Q + problem.weight * t.travel.Q
    q = t.acceleration.q + problem.weight * t.travel.q
    H, h = np.einsum("kif,ij,kjg->fg", y, Q, y), np.einsum("kif,ki->f", y, q)
    return H, h, t.acceleration.free + problem.weight * t.travel.free, np.einsum("i,kif->kf", t.velocity, y)
