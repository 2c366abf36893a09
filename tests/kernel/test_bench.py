"""The damper bench as plain Python: the temperature of each row, and a state that runs away."""

from typing import NamedTuple

import numpy as np
import pytest

from seatsim.kernel.bench import MOST_PARTS, TOLERANCE, run_bench
from seatsim.rig.temperature import TemperatureFactors

from .uncompiled import Linear

FACTORS = TemperatureFactors(-0.01, 0.0, -0.02, 20.0)
ROWS, STEP = 50, 0.01
TIME = 0.5 * STEP * np.arange(2 * ROWS - 1)
X, V = 0.01 * np.sin(4.0 * np.pi * TIME), 0.04 * np.pi * np.cos(4.0 * np.pi * TIME)


class Growing(NamedTuple):
    """`F = z`, `z' = v + rate z`."""

    rate: float

    def force(self, x, v, i, scaling, z):
        return z[0]

    def rates(self, x, v, i, scaling, z):
        return (v + self.rate * z[0],)


def run(damper, temperature, state=(), most=MOST_PARTS):
    """Return the force at every row, with a current that rises, and the row that was reached."""
    out = np.full(ROWS, np.nan)
    warm = np.broadcast_to(temperature, TIME.shape)
    return out, run_bench(damper, FACTORS, X, V, 0.5 * TIME, warm, state, STEP, most, TOLERANCE, out)


def test_temperature_is_that_of_the_row():
    warm = np.repeat([20.0, 50.0, 80.0], [21, 40, 38])
    out, reached = run(Linear(friction=30.0), warm)
    viscous, yielding = np.exp(-0.01 * (warm[::2] - 20.0)), np.exp(-0.02 * (warm[::2] - 20.0))
    expected = (800.0 + 150.0 * TIME[::2]) * viscous * V[::2] + 1000.0 * X[::2] + 30.0 * yielding * np.sign(V[::2])
    assert reached == ROWS and out == pytest.approx(expected, rel=1e-12)


def test_a_state_that_runs_away_stops_the_bench():
    out, reached = run(Growing(1e12), 20.0, (1e-4,), most=1)
    assert reached == 1
    assert np.isfinite(out[0]) and np.isnan(out[1:]).all()
    with np.errstate(over="ignore", invalid="ignore"):
        assert 1 < run(Growing(1e9), 20.0, (1e-4,), most=1)[1] < ROWS
