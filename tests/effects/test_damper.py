"""What each effect of the damper does on a bench, where the motion is prescribed."""

import math

import numpy as np
import pytest

from .rigs import BINGHAM, INERT, STEP, bench, cycles, record, strokes


@pytest.mark.parametrize("lift", [0.0, 1.0])
def test_remanence_leaves_force_after_a_drop_and_none_before_current_flowed(lift):
    effects = [record("damper.remanence", width=0.05, lift=lift)]
    current = np.repeat([0.0, 1.0, 0.0], [801, 800, 800])
    x, v = 0.05 * STEP * np.arange(2401), np.full(2401, 0.1)
    extra = (bench(effects, x, v, current) - bench([], x, v, current)) / BINGHAM.fc_b
    assert np.max(np.abs(extra[:400])) < 1e-12
    assert extra[790] == pytest.approx(-0.05 if lift == 0.0 else 0.0, abs=1e-4)
    assert extra[1200] == pytest.approx(0.05 * (1.0 + lift), abs=1e-4)


@pytest.mark.parametrize("turning", [0.0, 1e-4])
def test_free_play_gives_no_force_over_a_travel_after_each_reversal(turning):
    gap, softness = 2e-3, 0.3
    x, v = strokes(speed=0.1, length=0.01, count=4)
    force = bench([record("damper.free_play", gap=gap, softness=softness, turning=turning)], x, v, 0.5)
    nominal = bench([], x, v, 0.5)
    for stroke in (1, 2, 3):
        travel = 0.1 * STEP * np.arange(100)
        share = (force / nominal)[100 * stroke : 100 * (stroke + 1)]
        free = (travel > 0.1 * gap) & (travel < (1.0 - softness) * gap - 1e-4)
        assert np.max(np.abs(share[free])) == 0.0
        assert share[travel > 2.0 * gap] == pytest.approx(1.0, abs=0.02)


def test_a_play_that_motion_opens_lets_go_of_a_damper_that_still_pulls():
    pulling = INERT._replace(f0=2000.0)
    x, v = strokes(speed=0.1, length=0.01, count=2)
    forces = {
        turning: bench([record("damper.free_play", gap=2e-3, softness=0.05, turning=turning)], x, v, damper=pulling)
        for turning in (0.0, 1e-4)
    }
    turned = slice(105, 115)
    assert np.max(np.abs(forces[1e-4][turned])) == 0.0
    assert forces[0.0][turned] == pytest.approx(2000.0, abs=1.0)


def test_an_elastic_mount_and_a_dashpot_are_a_maxwell_element():
    """S + T S' = c v with T = c / K, and 1 / 5000 s more in which the piston's speed settles."""
    stiffness, c, hertz = 2e5, 600.0, 5.0
    x, v = cycles(frequency=hertz, count=10)
    force = bench([record("damper.free_play", gap=0.0, stiffness=stiffness)], x, v, damper=INERT._replace(c_a=c))
    settled = slice(len(force) // 2, None)
    expected = np.max(v) * c / math.hypot(1.0, 2.0 * math.pi * hertz * (c / stiffness + 2e-4))
    assert np.max(np.abs(force[settled])) == pytest.approx(expected, rel=0.01)


def test_an_elastic_mount_keeps_the_gap():
    gap, stiffness = 2e-3, 4e6
    x, v = strokes(speed=0.1, length=0.01, count=4)
    force = bench([record("damper.free_play", gap=gap, stiffness=stiffness)], x, v, 0.5)
    nominal = bench([], x, v, 0.5)
    travel = 0.1 * STEP * np.arange(100)
    unloading = np.max(np.abs(nominal)) / stiffness
    for stroke in (1, 2, 3):
        share = (force / nominal)[100 * stroke : 100 * (stroke + 1)]
        free = (travel > unloading + 2e-4) & (travel < gap - 2e-4)
        assert np.max(np.abs(share[free])) < 1e-6
        assert share[travel > gap + 4.0 * unloading] == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("values", [{"travel": 1e-3}, {"lag": 0.01}, {"travel": 1e-3, "share": 0.5}])
def test_preyield_hysteresis_opens_a_loop_in_the_force_over_speed(values):
    x, v = cycles(amplitude=0.004, frequency=1.5)
    force, nominal = bench([record("damper.preyield_hysteresis", **values)], x, v), bench([], x, v)
    speed, late = v[::2], len(nominal) // 3
    rising = (np.abs(speed) < 0.01) & (np.gradient(speed) > 0) & (np.arange(len(speed)) > late)
    falling = (np.abs(speed) < 0.01) & (np.gradient(speed) < 0) & (np.arange(len(speed)) > late)
    assert np.mean(force[falling]) - np.mean(force[rising]) > 50.0
    assert abs(np.mean(nominal[falling]) - np.mean(nominal[rising])) < 5.0
    fast = (np.abs(speed) > 0.95 * np.max(np.abs(speed))) & (np.arange(len(speed)) > late)
    assert force[fast] == pytest.approx(nominal[fast], rel=0.25)
