"""Bench records of a Bouc-Wen damper, made by prescribing its motion and current."""

import math

import numpy as np
import pytest

from seatsim.dampers.bouc_wen import BoucWen
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.rig.coil import Coil, relax
from seatsim.simulation.damper_bench import bench_force

RATE = 1000.0
DAMPER = BoucWen(c_a=300.0, c_b=500.0, alpha_a=50.0, alpha_b=700.0, A=4000.0, beta=2000.0, gamma=2000.0)


def lagged(command, step, rate, rate_fall=0.0):
    """The current of a coil behind a command that holds from its sample on."""
    coil = Coil(rate=rate, rate_fall=rate_fall)
    current = np.array(command, dtype=float)
    for k in range(1, len(current)):
        current[k] = relax(coil, current[k - 1], command[k - 1], step)
    return current


@pytest.fixture
def damper():
    """The damper of the records."""
    return DAMPER


@pytest.fixture(scope="session")
def record():
    """Make a record of `x(t)` under `current(t)`; `lag` is the coil's rates, behind which the command is recorded."""

    def make(motion, seconds, current=lambda t: 0.0 * t, damper=DAMPER, lag=(), noise=0.0, temperature=None):
        step = 1.0 / RATE
        fine = 0.5 * step * np.arange(2 * round(seconds * RATE) + 1)
        x = motion(fine)
        v = np.gradient(x, fine, edge_order=2)
        command = current(fine)
        flowing = lagged(command, 0.5 * step, *lag) if lag else command
        force = bench_force(damper, x, v, flowing, 20.0, step)
        rng = np.random.default_rng(1)
        force = force + noise * rng.standard_normal(len(force))
        warmth = None if temperature is None else temperature(fine[::2])
        return BenchRecord("made", "made.csv", RATE, x[::2], v[::2], force, command[::2], bool(lag), warmth)

    return make


@pytest.fixture(scope="session")
def sine():
    """Return `amplitude sin(w t)` about an offset, between rests of half a second and two cycles up and down."""

    def motion(amplitude, frequency, cycles=12, offset=0.0):
        ends = 0.5 + np.array([0.0, 2.0, cycles - 2.0, cycles]) / frequency

        def x(t):
            size = np.interp(t, ends, [0.0, 1.0, 1.0, 0.0])
            return offset + amplitude * size * np.sin(2.0 * math.pi * frequency * (t - 0.5))

        return x, cycles / frequency + 1.0

    return motion
