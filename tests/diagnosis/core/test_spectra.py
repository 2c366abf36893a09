"""Smoothed spectra against plain loops, Wiener's filter against its formula, and signals of random phases."""

import numpy as np
import pytest

from seatsim.diagnosis.spectra import randomise_phases, smooth_spectrum, wiener_share


def averaged(power):
    """Return the average over 15 % of the frequency to either side, at least 4 bins, bin by bin."""
    found = np.empty_like(power)
    for k in range(power.shape[1]):
        half = max(4, int(0.15 * k))
        found[:, k] = power[:, max(0, k - half) : k + half + 1].mean(axis=1)
    return found


def test_a_smoothed_spectrum_is_the_mean_over_a_relative_band():
    power = np.random.default_rng(0).exponential(size=(2, 90))
    np.testing.assert_allclose(smooth_spectrum(power), averaged(power), rtol=1e-10)


def test_wieners_share_is_signal_over_signal_and_noise():
    # Whitened noise has the power 2, of real and imaginary part; a signal of the power 6 is then 3/4 of both.
    np.testing.assert_allclose(wiener_share(np.array([8.0, 4.0, 2.0, 1.0])), [0.75, 0.5, 0.0, 0.0])


@pytest.mark.parametrize("samples", [100, 101])
def test_random_phases_keep_the_spectrum_and_change_the_signal(samples):
    signal = np.random.default_rng(5).standard_normal(samples)
    drawn = randomise_phases(signal, np.random.default_rng(6))
    assert drawn.shape == signal.shape
    inner = slice(1, -1 if samples % 2 == 0 else None)
    np.testing.assert_allclose(np.abs(np.fft.rfft(drawn))[inner], np.abs(np.fft.rfft(signal))[inner], rtol=1e-9)
    assert abs(np.corrcoef(drawn, signal)[0, 1]) < 0.5
    np.testing.assert_array_equal(drawn, randomise_phases(signal, np.random.default_rng(6)))
    phases = np.angle(np.fft.rfft(randomise_phases(np.eye(1, 4001)[0], np.random.default_rng(7)))[1:-1])
    # Over the whole circle, so that their mean direction vanishes.
    assert abs(np.mean(np.exp(1j * phases))) < 0.1
    assert phases.max() > 3.0 and phases.min() < -3.0
