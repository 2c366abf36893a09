"""The held-force problem against an integration of seat and weighting."""

import numpy as np
import pytest
from scipy.signal import lsim

from controllers.clairvoyant.problem import transcribe
from seatsim.metrics.weighting import weight
from seatsim.rig.plant import Plant, state_space

SEAT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0, damper_ratio=0.8)
STEP, EVERY, START = 0.001, 5, (0.004, -0.15)


@pytest.fixture(scope="module")
def floor():
    return np.convolve(6.0 * np.random.default_rng(4).standard_normal(264), np.ones(10) / 10, mode="same")


@pytest.fixture(scope="module")
def problem(floor):
    return transcribe(SEAT, floor, STEP, EVERY, START)


@pytest.fixture(scope="module")
def force():
    return 200.0 * np.random.default_rng(5).standard_normal(52)


def motion(floor, held, start):
    """Travel and acceleration of the driver under floor and a force held over samples, at samples, by fine steps."""
    s, fine = state_space(SEAT), 20
    time = np.arange((len(floor) - 1) * fine + 1) * STEP / fine
    shaken = np.interp(time, np.arange(len(floor)) * STEP, floor)
    x = lsim((s.A, s.B1, np.eye(4), np.zeros((4, 1))), shaken, time, [*start, 0.0, 0.0])[2]
    x += lsim((s.A, s.B2, np.eye(4), np.zeros((4, 1))), np.append(np.repeat(held, fine), held[-1]), time, interp=False)[
        2
    ]
    return x[::fine, 0], (x[::fine] @ s.C1.T)[:, 1], x[::fine]


def test_states_and_velocities_under_a_force(problem, floor, force):
    used = 52 * EVERY + 1
    travel, _, x = motion(floor[:used], np.repeat(force, EVERY), START)
    alone = motion(floor[:used], np.zeros(52 * EVERY), START)[2]
    s = np.zeros(len(problem.A))
    for k in range(52):
        mean = problem.velocity @ np.append(s, force[k]) + problem.free_velocity[k]
        wanted = 0.8 * (travel[EVERY * (k + 1)] - travel[EVERY * k]) / (EVERY * STEP)
        assert mean == pytest.approx(wanted, rel=1e-6, abs=1e-7)
        s = problem.A @ s + problem.B * force[k]
        np.testing.assert_allclose(s[:4], (x - alone)[EVERY * (k + 1)], atol=1e-8)


def test_criteria_are_mean_squares_of_weighted_acceleration_and_travel(problem, floor, force):
    used = 52 * EVERY + 1
    assert problem.step == pytest.approx(0.005)
    assert len(problem.free_velocity) == 52
    y, s = [], np.zeros(len(problem.A))
    for value in force:
        y.append(np.append(s, value))
        s = problem.A @ s + problem.B * value
    y = np.array(y)
    found = [m.free + np.sum(y * (y @ m.Q + 2 * m.q)) for m in (problem.acceleration, problem.travel)]
    travel, acceleration, _ = motion(floor[:used], np.repeat(force, EVERY), START)
    # All samples of the record count, those after the last whole interval as zero.
    assert found[1] == pytest.approx(np.sum(travel**2) / len(floor), rel=1e-6)
    # The filter of the metrics takes the acceleration for linear between samples, the problem knows its jumps.
    assert found[0] == pytest.approx(np.sum(weight(acceleration, 1 / STEP) ** 2) / len(floor), rel=0.05)
    quiet = motion(floor[:used], np.zeros(52 * EVERY), START)
    assert problem.travel.free == pytest.approx(np.sum(quiet[0] ** 2) / len(floor), rel=1e-9)
    assert problem.acceleration.free == pytest.approx(np.sum(weight(quiet[1], 1 / STEP) ** 2) / len(floor), rel=1e-9)
