"""The bench against closed forms, its order of convergence, and its refusals."""

import math

import numpy as np
import pytest

from seatsim.dampers.bingham import Bingham
from seatsim.dampers.bouc_wen import BoucWen
from seatsim.schema.errors import RunError
from seatsim.simulation.damper_bench import bench_force, centring, sine_test

VISCOUS = BoucWen(c_a=700.0, alpha_a=0.0, alpha_b=0.0)


def motion(steps, duration):
    """Extension without reversal, so that a Bouc-Wen model is smooth: position, velocity, step."""
    t = np.linspace(0.0, duration, 2 * steps + 1)
    return 0.01 * t + 0.001 * np.sin(4.0 * t), 0.01 + 0.004 * np.cos(4.0 * t), duration / steps


def test_a_viscous_damper_is_its_own_equivalent_damping(conform):
    test = sine_test(VISCOUS, 0.004, 2.0, 0.0, 20.0)
    claim, peak = "viscous damper of 700 N s/m, sine of 4 mm, 2 Hz", 700.0 * 0.004 * 4 * math.pi
    conform(f"{claim}: equivalent damping, N s/m", "c", test.equivalent_damping, 700.0, tolerance=7e-7)
    conform(f"{claim}: peak force, N", "c X omega", test.peak_force, peak, tolerance=1e-9 * peak)


def test_energy_of_a_set_valued_bingham_cycle(conform):
    damper = Bingham(c_a=300.0, c_b=0.0, fc_a=50.0, fc_b=400.0, v_ref=0.0)
    test = sine_test(damper, 0.006, 1.5, 0.5, 20.0)
    expected = 4 * 250.0 * 0.006 + math.pi * 300.0 * 3 * math.pi * 0.006**2
    claim = "set-valued Bingham, energy of a cycle, J"
    conform(claim, "4 fc X + pi c omega X^2", test.dissipated_energy, expected, tolerance=1e-5 * expected)


def test_the_last_cycle_is_returned_with_both_ends():
    test = sine_test(VISCOUS, 0.004, 2.0, 0.0, 20.0, cycles=2, samples=100)
    assert len(test.time) == len(test.force) == 101
    assert test.time[0] == pytest.approx(0.5) and test.time[-1] == pytest.approx(1.0)
    assert test.displacement[25] == pytest.approx(0.004)
    assert test.velocity[0] == pytest.approx(0.004 * 4 * math.pi)


def test_the_bench_converges_with_order_four():
    damper = BoucWen(A=500.0, beta=200.0, gamma=300.0)
    exact = bench_force(damper, *motion(4096, 0.4)[:2], 0.5, 20.0, 0.4 / 4096)[-1]
    errors = []
    for steps in (16, 32, 64):
        x, v, step = motion(steps, 0.4)
        errors.append(abs(bench_force(damper, x, v, 0.5, 20.0, step)[-1] - exact))
    orders = np.diff(np.log2(errors))
    assert np.all(orders < -3.7), orders


def test_stiff_states_are_divided():
    # 2e6 per metre at 0.01 m/s is a rate of 2e4 per second, on steps of a tenth of a second.
    damper = BoucWen(A=2e6, beta=1e6, gamma=1e6, n=1.0)
    x, v, step = motion(4, 0.4)
    force = bench_force(damper, x, v, 0.5, 20.0, step)
    assert force[1:] == pytest.approx((250.0 + 175.0) * v[2::2] + 355.0, rel=1e-3)


@pytest.mark.filterwarnings("ignore:overflow", "ignore:invalid value")
def test_a_run_that_runs_away_is_an_error():
    damper = BoucWen(beta=-1e9, gamma=0.0)
    with pytest.raises(RunError, match="not finite"):
        bench_force(damper, *motion(50, 5.0)[:2], 0.5, 20.0, 0.1)


def test_motion_off_centre_is_noticed():
    t = np.linspace(0.0, 10.0, 5001)
    x, v = 0.005 * np.sin(9 * t), 0.045 * np.cos(9 * t)
    assert centring(x, v) == ""
    assert "not passive here" in centring(x + 0.004, v)
    assert centring(np.zeros(10), np.zeros(10)) == ""
