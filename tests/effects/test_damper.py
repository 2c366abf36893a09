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


def test_an_elastic_mount_and_a_dashpot_are_a_maxwell_element():
    """S + T S' = c v with T = c / K, and 1 / 5000 s more in which the piston's speed settles."""
    stiffness, c, hertz = 2e5, 600.0, 5.0
    x, v = cycles(frequency=hertz, count=10)
    force = bench([record("damper.free_play", gap=0.0, stiffness=stiffness)], x, v, damper=INERT._replace(c_a=c))
    settled = slice(len(force) // 2, None)
    expected = np.max(v) * c / math.hypot(1.0, 2.0 * math.pi * hertz * (c / stiffness + 2e-4))
    assert np.max(np.abs(force[settled])) == pytest.approx(expected, rel=0.01)
