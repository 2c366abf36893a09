"""Smoothed spectra against plain loops, and Wiener's filter against its formula."""

import numpy as np

from seatsim.diagnosis.spectra import smooth_spectrum, wiener_share


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
