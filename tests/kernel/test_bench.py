"""The damper bench as plain Python, against closed forms and `scipy.integrate`."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatsim.kernel import bench
from seatsim.kernel.bench import MOST_PARTS, TOLERANCE, run_bench
from seatsim.rig.temperature import TemperatureFactors

from .uncompiled import Linear

FACTORS = TemperatureFactors(-0.01, 0.0, -0.02, 20.0)


class Maxwell(NamedTuple):
    """Spring and dashpot in series, `F = k z`, `z' = v - z / time`, beside a term in the current; k may be negative."""

    k: float = 1e5
    time: float = 0.01

    def force(self, x, v, i, scaling, z):
        return self.k * z[0] + 100.0 * i + 1000.0 * x

    def rates(self, x, v, i, scaling, z):
        return (v - z[0] / self.time,)


def run(damper, rows, step, state=(), temperature=20.0, most=MOST_PARTS, tolerance=TOLERANCE, frequency=2.0):
    """Force every step of a sine of 1 cm, with a current that rises; samples are every half step."""
    time = 0.5 * step * np.arange(2 * rows - 1)
    x, v = 0.01 * np.sin(np.pi * 2 * frequency * time), 0.02 * np.pi * frequency * np.cos(2 * np.pi * frequency * time)
    warm = np.broadcast_to(np.asarray(temperature, dtype=float), time.shape)
    out = np.full(rows, np.nan)
    reached = run_bench(damper, FACTORS, x, v, 0.5 * time, warm, state, step, most, tolerance, out)
    return time[::2], x[::2], v[::2], out, reached


def test_a_damper_without_state_is_its_law():
    time, x, v, out, reached = run(Linear(friction=30.0), 50, 0.01)
    assert reached == 50
    expected = (800.0 + 150.0 * time) * v + 1000.0 * x + 30.0 * np.sign(v)
    assert out == pytest.approx(expected, rel=1e-12)


def test_temperature_is_that_of_the_row():
    warm = np.repeat([20.0, 50.0, 80.0], [21, 40, 38])
    time, x, v, out, _ = run(Linear(friction=30.0), 50, 0.01, temperature=warm)
    rise = warm[::2] - 20.0
    expected = (800.0 + 150.0 * time) * np.exp(-0.01 * rise) * v + 1000.0 * x + 30.0 * np.exp(-0.02 * rise) * np.sign(v)
    assert out == pytest.approx(expected, rel=1e-12)


def maxwell(damper, time, start, frequency=2.0):
    w = 2 * np.pi * frequency
    z = solve_ivp(
        lambda t, z: 0.01 * w * np.cos(w * t) - z / damper.time,
        (0.0, time[-1]),
        [start],
        t_eval=time,
        method="DOP853",
        rtol=1e-11,
        atol=1e-14,
    ).y[0]
    return damper.k * z + 50.0 * time + 10.0 * np.sin(w * time)


def test_a_state_is_integrated_to_the_fourth_order():
    errors = []
    for rows in (26, 51, 101):
        time, *_, out, _ = run(Maxwell(), rows, 0.2 / (rows - 1), (1e-4,), tolerance=1e9)
        errors.append(np.max(np.abs(out - maxwell(Maxwell(), time, 1e-4))))
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(4.0, abs=0.6)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_a_stiff_state_is_divided_until_the_tolerance_is_met(tolerance):
    damper = Maxwell(time=1e-3)
    time, *_, out, reached = run(damper, 41, 5e-3, (1e-4,), tolerance=tolerance)
    exact = maxwell(damper, time, 1e-4)
    assert reached == 41
    assert np.max(np.abs(out - exact) / (bench.FORCE_SCALE + np.abs(exact))) < 10.0 * tolerance


def test_a_state_that_runs_away_stops_the_bench():
    *_, out, reached = run(Maxwell(k=1.0, time=-1e-12), 20, 0.01, (1e-4,), most=1)
    assert reached == 1
    assert np.isfinite(out[0]) and np.isnan(out[1:]).all()
    with np.errstate(over="ignore", invalid="ignore"):
        *_, reached = run(Maxwell(k=1.0, time=-1e-9), 20, 0.01, (1e-4,), most=1)
    assert 1 < reached < 20


def test_between_the_samples_runs_their_parabola():
    samples = np.array([1.0, -0.5, 3.0])
    line = np.polynomial.Polynomial.fit([0.0, 0.5, 1.0], samples, 2)
    for s in (0.0, 0.2, 0.5, 0.75, 1.0):
        assert bench._between(samples, s) == pytest.approx(line(s), rel=1e-12)
