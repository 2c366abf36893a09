"""Polish of a kinked minimum: the known optima of the seat, within limits, from gains nearby."""

import time

import numpy as np
import pytest

from controllers.synthesis.objective import NormObjective
from controllers.synthesis.polish import polish

OPTIMA = {10.0: 1.0681900, 30.0: 1.1359585, 50.0: 1.1848133}
GAINS = {10.0: [-1937.2, 2013.9], 30.0: [967.0, 2339.1], 50.0: [3268.6, 2613.3]}


def objective(plant, limit=1e6):
    limits = np.full((1, 2), limit)
    return NormObjective([plant], limits, np.ones((1, 2)))


def later():
    return time.monotonic() + 30


@pytest.mark.parametrize("e1", OPTIMA)
def test_reaches_the_known_optimum_from_nearby(seat, e1):
    problem = objective(seat(e1))
    entries = polish(problem, 1.3 * np.array(GAINS[e1]), later())
    assert problem.norm(entries) == pytest.approx(OPTIMA[e1], rel=1e-6)
    np.testing.assert_allclose(entries, GAINS[e1], rtol=5e-4)


def test_several_plants_are_polished_together(seat):
    plants = [seat(50.0, m=m) for m in (50.0, 120.0)]
    limits = np.full((1, 2), 1e6)
    problem = NormObjective(plants, limits, np.ones((1, 2)))
    entries = polish(problem, np.array([4000.0, 3000.0]), later())
    assert problem.norm(entries) == pytest.approx(1.24271, rel=1e-5)


def test_limits_hold(seat):
    problem = objective(seat(50.0), 2000.0)
    entries = polish(problem, np.array([1500.0, 1500.0]), later())
    assert np.abs(entries).max() <= 2000.0
    assert entries[1] > 1900.0
    assert problem.norm(entries) < problem.norm(np.array([1500.0, 1500.0]))
    # A lower limit that the optimum at -1937 lies beyond.
    problem = objective(seat(10.0), 1500.0)
    entries = polish(problem, np.array([-1000.0, 1400.0]), later())
    assert -1500.0 <= entries[0] < -1400.0 and entries[1] <= 1500.0


def test_what_is_not_stable_or_has_no_time_comes_back(seat):
    problem = objective(seat(30.0))
    wild, fine = np.array([0.0, -1e5]), np.array([500.0, 2000.0])
    assert polish(problem, wild, later()) is wild
    assert polish(problem, fine, time.monotonic() - 1) is fine
