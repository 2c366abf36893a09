"""Figures behind the pictures of a diagnosis, against closed forms."""

import numpy as np
import pytest

from seatsim.diagnosis.result import Trace
from seatsim.plots.averaging import average_bands
from seatsim.plots.diagnosis import bins
from seatsim.plots.frame import describe_quantity, format_number

RATE = 200.0
TIME = np.arange(4000) / RATE


def held_out(measured, nominal, after=None, channel="damper_force"):
    after = nominal if after is None else after
    return Trace("run-a", channel, "N", 0.1, TIME, measured, nominal, nominal, after)


def test_residuals_are_measured_less_simulated():
    measured = np.sin(TIME)
    left = bins.compute_residual(held_out(measured, 0.5 * measured, 0.9 * measured))
    np.testing.assert_allclose(left.before, 0.5 * measured)
    np.testing.assert_allclose(left.after, 0.1 * measured)


def test_the_nominal_gap_is_over_the_standard_deviation():
    measured = 7.0 + np.sin(2 * np.pi * TIME)
    assert bins.nominal_gap(held_out(measured, measured - 0.3)) == pytest.approx(0.3 * np.sqrt(2))
    assert bins.nominal_gap(held_out(np.ones_like(TIME), np.zeros_like(TIME))) == 0.0


def test_the_first_second_is_dropped():
    rest = bins.drop_start(held_out(TIME, TIME))
    assert rest.time[0] == 1.0 and len(rest.time) == len(rest.measured) == len(rest.after) == 3800
    groups = bins.group_by_channel([held_out(TIME, TIME), held_out(TIME, TIME, channel="b"), held_out(TIME, TIME)])
    assert {name: len(group) for name, group in groups.items()} == {"damper_force": 2, "b": 1}


def test_levels_in_bins():
    x = np.repeat([0.5, 1.5], bins.FEWEST)
    values = np.where(x < 1, 3.0, -4.0) + np.tile([1.0, -1.0], bins.FEWEST)
    borders = np.array([0.0, 1.0, 2.0])
    cells = bins.map_rms(x, np.zeros_like(x), values, (borders, np.array([-1.0, 1.0, 3.0])))
    assert cells.shape == (2, 2)
    np.testing.assert_allclose(cells, [[np.sqrt(10.0), np.sqrt(17.0)], [np.nan, np.nan]])


def test_borders_leave_out_extremes():
    values = np.concatenate([np.linspace(0, 1, 10_000), [1e6]])
    borders = bins.bin_edges(values, 4)
    assert len(borders) == 5 and borders[-1] < 1.0 and np.ptp(np.diff(borders)) == pytest.approx(0.0, abs=1e-12)


def test_what_stands_still_does_not_vary():
    assert bins.varies(np.linspace(0, 1, 100))
    assert not bins.varies(None) and not bins.varies(np.empty(0)) and not bins.varies(np.full(50, 3.0))
    assert not bins.varies(5.0 + 1e-3 * np.linspace(0, 1, 100))


def test_the_spectrum_of_white_noise_is_two_variances_a_sample():
    noise = np.random.default_rng(3).standard_normal((2, len(TIME)))
    frequency, power = bins.estimate_spectrum(TIME, list(0.5 * noise))
    assert frequency[0] == bins.LOWEST and frequency[-1] == RATE / 2
    assert np.mean(power[:-1]) == pytest.approx(2 * 0.25 / RATE, rel=0.05)


def test_bands_keep_their_mean_density():
    frequency, power = np.arange(1.0, 33.0), np.arange(1.0, 33.0)
    centres, density, count = average_bands(frequency, power, 1.0, 1)
    assert count.tolist() == [1, 2, 4, 8, 16, 1]
    np.testing.assert_allclose(density, centres)
    np.testing.assert_allclose(centres, [1.0, 2.5, 5.5, 11.5, 23.5, 32.0])


def test_numbers_and_units_of_an_axis():
    assert [format_number(value) for value in (123.4, 9.96, 0.123, -2.0, 0.0001)] == [
        "123",
        "10",
        "0.12",
        "−2",
        "0.0001",
    ]
    assert describe_quantity("suspension_displacement", "m")[1:] == ("mm", 1e3)
    assert describe_quantity("frame_acceleration", "m/s^2").axis == "frame acceleration [m/s²]"
    assert describe_quantity("count", "").unit == "-"
