"""Spectral classes EM1 to EM9."""

import numpy as np
import pytest
from scipy.signal import welch

from seatsim.excitations.iso7096 import CLASSES, LOWEST, Iso7096, acceleration_density

# Peak of every class's density in (m/s^2)^2/Hz and its frequency in Hz, as the HVLab HRV toolbox codes them.
PEAKS = {
    "EM1": (2.20, 1.94),
    "EM2": (2.40, 2.12),
    "EM3": (1.71, 2.12),
    "EM4": (0.53, 2.12),
    "EM5": (0.76, 2.09),
    "EM6": (0.34, 7.65),
    "EM7": (5.54, 3.24),
    "EM8": (0.40, 3.33),
    "EM9": (0.78, 4.01),
}


@pytest.mark.parametrize("name", CLASSES)
def test_density_integrates_to_the_stated_rms_and_peak(name):
    f = np.linspace(0, 20, 200001)
    density = acceleration_density(f, name)
    assert np.sqrt(np.trapezoid(density, f)) == pytest.approx(CLASSES[name].rms, abs=0.006)
    peak, at = PEAKS[name]
    assert density.max() == pytest.approx(peak, abs=0.011)
    assert f[density.argmax()] == pytest.approx(at, abs=0.02)
    assert not density[(f < LOWEST) | (f > CLASSES[name].highest)].any()


@pytest.mark.parametrize("name", CLASSES)
def test_realisation_has_the_rms_of_its_class(name):
    acceleration = Iso7096(name, 60.0).floor(0.002, 11).acceleration[500:]
    assert np.sqrt(np.mean(acceleration**2)) == pytest.approx(CLASSES[name].rms, rel=0.02)


@pytest.mark.parametrize("name", CLASSES)
def test_density_of_realisations_stays_within_a_tenth_of_the_peak(name):
    runs = [Iso7096(name, 300.0).floor(0.01, seed).acceleration[100:] for seed in range(4)]
    f, density = np.mean([welch(run, 100.0, nperseg=1024) for run in runs], axis=0)
    target = acceleration_density(f, name)
    inside = (f > 1.1) & (f < 0.95 * CLASSES[name].highest)
    assert np.abs(density - target)[inside].max() < 0.1 * target.max()
