"""Weights by the gap."""

import numpy as np
import pytest

from seatsim.diagnosis.noise import weigh_gap

from .noisy import RUNS, draw, mean_squares, pose


def test_weights_by_the_gap_give_every_channel_the_same_share_of_it():
    problem = pose()
    residuals = draw(problem, 0.3 * problem.spread)
    weights = weigh_gap(problem, residuals)
    # 10 % of the gap counts as noise, so that the gap itself has the mean square 1 / 0.1^2 of independent numbers.
    found, _ = mean_squares(weights, residuals)
    np.testing.assert_allclose(found, 100.0 * weights.independent, rtol=0.06)
    # The gap of all channels and runs counts as much as 40 numbers of unit size.
    assert sum(np.sum(weights(residuals[run], run) ** 2) for run in RUNS) == pytest.approx(40.0, rel=0.05)
