"""The Welch estimates agree with scipy's."""

import numpy as np
import pytest
from scipy import signal

from seatsim.metrics.spectra import cross_spectral_density, estimate_density, power_spectral_density, trusted_gain


@pytest.mark.parametrize(("samples", "length"), [(4000, 512), (4001, 511), (100, 100), (9, 1), (10, 3)])
def test_densities_are_those_of_scipy(samples, length, conform):
    x, y = np.random.default_rng(3).normal(size=(2, samples)) + 5.0
    frequency, cross = cross_spectral_density(x, y, 250.0, length)
    expected_frequency, expected = signal.csd(x, y, 250.0, nperseg=length)
    np.testing.assert_allclose(frequency, expected_frequency)
    power, scipys = power_spectral_density(x, 250.0, length)[1], signal.welch(x, 250.0, nperseg=length)[1]
    for name, found, reference in (("cross", cross, expected), ("power", power, scipys)):
        claim = f"{name} spectral density, {samples} samples in segments of {length}: greatest deviation over the peak"
        deviation = np.max(np.abs(found - reference)) / max(1e-15, np.max(np.abs(reference)))
        conform(claim, "scipy.signal", deviation, tolerance=1e-9)


def test_a_density_begins_above_what_the_mean_leaves():
    frequency, power = estimate_density(0.01, [np.sin(2 * np.pi * 1.03 * np.arange(0, 60, 0.01))])
    assert frequency[0] == pytest.approx(0.2)
    assert power[0] < 1e-5 * power.max()


def test_a_transmissibility_begins_with_its_density_and_has_no_stray_lines():
    random = np.random.default_rng(7)
    floor, other = random.standard_normal((2, 6000))
    # The driver follows the floor below 10 Hz; above, coherence is chance.
    slow = signal.butter(6, 10.0, fs=100.0, output="sos")
    driver = signal.sosfiltfilt(slow, floor) + 0.3 * (other - signal.sosfiltfilt(slow, other))
    frequency, gain = trusted_gain(floor, driver, 100.0, 50.0)
    assert frequency[0] == pytest.approx(estimate_density(0.01, [floor])[0][0])
    known = np.flatnonzero(np.isfinite(gain))
    stretches = np.split(known, np.flatnonzero(np.diff(known) > 1) + 1)
    assert min(map(len, stretches)) >= 3 and 9.0 < frequency[known[-1]] < 15.0
    np.testing.assert_allclose(gain[(frequency > 0.5) & (frequency < 5.0)], 1.0, atol=0.1)


def test_a_transmissibility_ends_where_it_is_not_trusted_and_has_no_islands_above():
    random = np.random.default_rng(7)
    floor, other = random.standard_normal((2, 6000))
    band = signal.butter(6, (8.0, 20.0), "bandstop", fs=100.0, output="sos")
    driver = signal.sosfiltfilt(band, floor) + 0.3 * (other - signal.sosfiltfilt(band, other))
    frequency, gain = trusted_gain(floor, driver, 100.0, 50.0)
    assert np.all(np.isfinite(gain[(frequency > 0.5) & (frequency < 7.0)])) and np.all(np.isnan(gain[frequency > 10.0]))
