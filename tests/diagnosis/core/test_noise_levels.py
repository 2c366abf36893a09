"""Weights by the gap, and the power of broadband residuals."""

import numpy as np
import pytest

from seatsim.diagnosis.noise import measure_broadband, weigh_gap

from .noisy import RUNS, draw, mean_squares, pose
from .toy import NOISE, RATE


def test_weights_by_the_gap_give_every_channel_the_same_share_of_it():
    problem = pose()
    residuals = draw(problem, 0.3 * problem.spread)
    weights = weigh_gap(problem, residuals)
    # 10 % of the gap counts as noise, so that the gap itself has the mean square 1 / 0.1^2 of independent numbers.
    found, _ = mean_squares(weights, residuals)
    np.testing.assert_allclose(found, 100.0 * weights.independent, rtol=0.06)
    # The gap of all channels and runs counts as much as 40 numbers of unit size.
    assert sum(np.sum(weights(residuals[run], run) ** 2) for run in RUNS) == pytest.approx(40.0, rel=0.05)


def test_broadband_power_is_what_exceeds_the_stated_noise_above_all_compared():
    problem = pose({"highest_frequency": 40.0})
    # Powers of 2.6 and 1.6 of the stated one; the settings take from 2 on for broadband.
    found = measure_broadband(problem, draw(problem, np.sqrt([2.6, 1.6]) * NOISE))
    for run, count in RUNS.items():
        assert found[run].shape == (2, 1)
        assert found[run][0, 0] == pytest.approx(1.6 * NOISE[0] ** 2 * count, rel=0.25)
        assert found[run][1, 0] == 0.0


def test_content_that_is_compared_is_not_broadband():
    problem, low = pose({"highest_frequency": 40.0}), {}
    for run, values in draw(problem, 100.0 * NOISE).items():
        spectrum = np.fft.rfft(values)
        spectrum[:, np.fft.rfftfreq(values.shape[1], 1.0 / RATE) > 40.0] = 0.0
        low[run] = np.fft.irfft(spectrum, values.shape[1])
    found = measure_broadband(problem, low)
    assert all(np.all(values == 0.0) for values in found.values())
    # With all frequencies compared there is nothing to measure it on.
    every = measure_broadband(pose({"highest_frequency": 100.0}), draw(problem, 100.0 * NOISE))
    assert all(values.shape == (2, 1) and np.all(values == 0.0) for values in every.values())
