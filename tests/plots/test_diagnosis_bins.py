"""Figures behind the pictures of a diagnosis, against closed forms."""

import numpy as np
import pytest

from seatsim.diagnosis.result import Trace
from seatsim.plots.densities import PER_OCTAVE, average_bands, estimate_density
from seatsim.plots.diagnosis import bins
from seatsim.plots.labels import describe_channel

RATE = 200.0
TIME = np.arange(4000) / RATE


def held_out(measured, nominal, after=None, channel="damper_force"):
    after = nominal if after is None else after
    return Trace("run-a", channel, "N", 0.1, TIME, measured, nominal, nominal, after)


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


def test_the_density_of_white_noise_is_two_variances_a_sample():
    noise = np.random.default_rng(3).standard_normal((2, len(TIME)))
    frequency, power = estimate_density(1 / RATE, list(0.5 * noise))
    assert frequency[0] < 0.3 and frequency[-1] > 0.97 * RATE / 2
    assert np.average(power, weights=np.gradient(frequency)) == pytest.approx(2 * 0.25 / RATE, rel=0.05)
    assert estimate_density(1 / RATE, [noise[0][:40]])[0].size == 0


def test_bands_keep_their_mean_density():
    frequency = np.arange(0.0, 1000.0)
    centres, density = average_bands(frequency, frequency, 1.0)
    np.testing.assert_allclose(density, centres)
    assert centres[0] == 1.0 and np.all(np.diff(centres) > 0) and np.log2(centres[-1] / centres[-2]) < 1.5 / PER_OCTAVE


def test_quantities_of_an_axis():
    assert describe_channel("suspension_displacement", "m") == ("suspension displacement", "mm", 1e3)
    shown = describe_channel("frame_acceleration", "m/s^2")
    assert (shown.axis, shown.square) == ("frame acceleration [m/s²]", "(m/s²)²")
    assert describe_channel("count", "").unit == "-"
