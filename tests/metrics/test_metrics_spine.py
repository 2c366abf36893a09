"""Lumbar spine under shocks: the response to a sine, doses of counted peaks, and what peers find."""

import numpy as np
import pytest

from seatsim.metrics.spine import assess_spine, join_spinal_doses, spinal_dose, spine_response, spine_transfer


@pytest.mark.parametrize("frequency", [1.0, 4.9, 16.0, 40.0])
def test_a_sine_comes_out_with_gain_and_phase_of_the_transfer_function(frequency):
    time, gain = np.arange(10_000) / 500.0, spine_transfer(frequency)
    found = spine_response(np.sin(2 * np.pi * frequency * time), 500.0)[4000:9000]
    expected = np.imag(gain * np.exp(2j * np.pi * frequency * time))[4000:9000]
    np.testing.assert_allclose(found, expected, atol=2e-5)


def test_the_spine_follows_slow_motion_and_resonates_near_5_hz():
    assert spine_transfer(0.0) == 1.0
    grid = np.linspace(0.5, 80.0, 1600)
    gains = np.abs(spine_transfer(grid))
    assert 4.0 < grid[np.argmax(gains)] < 6.0 and gains.max() > 1.5 and gains[-1] < 0.5


def test_the_dose_counts_the_largest_value_of_each_positive_stretch():
    assert spinal_dose([0.0, 1.0, 2.0, 1.0, -3.0, 0.5, -1.0]) == pytest.approx(1.07 * (2.0**6 + 0.5**6) ** (1 / 6))
    assert spinal_dose(np.tile([1.0, -1.0], 64)) == pytest.approx(2 * 1.07)
    assert spinal_dose([-1.0, -2.0]) == 0.0


def test_doses_add_by_sixth_powers_and_grow_with_the_sixth_root_of_time():
    assert join_spinal_doses([1.0, 1.0]) == pytest.approx(2 ** (1 / 6))
    assert join_spinal_doses([3.0], [64.0]) == pytest.approx(6.0)


def test_risks_are_those_of_a_peer():
    # phonometry 3.3.0: injury_risk(m_z x 10, start_age=20, years=45, days_per_year=240), injury_probability.
    found = assess_spine(10.0)
    assert found["man"] == pytest.approx((0.29, 0.34773296828865, 0.01354628820673), rel=1e-9)
    assert found["woman"] == pytest.approx((0.25, 0.25087880872146, 0.00689517187577), rel=1e-9)
