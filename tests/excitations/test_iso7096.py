"""Spectral classes EM1 to EM9."""

import numpy as np
import pytest
from scipy.signal import welch

from seatsim.excitations.iso7096 import CLASSES, LOWEST, Iso7096, acceleration_density

from ..text import beside, parse

SOURCE = "ISO 7096:2000 as the HVLab toolbox codes it"
# RMS of every class in m/s^2, peak of its density in (m/s^2)^2/Hz, and the frequency of the peak in Hz.
STATED = parse(beside(__file__, "iso7096.yaml"))


@pytest.mark.parametrize("name", CLASSES)
def test_density_integrates_to_the_stated_rms_and_peak(name, conform):
    f = np.linspace(0, 20, 200001)
    density = acceleration_density(f, name)
    rms, peak, at = STATED[name]
    found = np.sqrt(np.trapezoid(density, f))
    conform(f"{name}, RMS of the density, m/s^2", SOURCE, found, rms, tolerance=0.006)
    conform(f"{name}, peak of the density, (m/s^2)^2/Hz", SOURCE, density.max(), peak, tolerance=0.011)
    conform(f"{name}, frequency of the peak, Hz", SOURCE, f[density.argmax()], at, tolerance=0.02)
    assert not density[(f < LOWEST) | (f > CLASSES[name].highest)].any()


@pytest.mark.parametrize("name", CLASSES)
def test_realisation_has_the_rms_of_its_class(name, conform):
    acceleration = Iso7096(name, 60.0).floor(0.002, 11).acceleration[500:]
    rms, stated = np.sqrt(np.mean(acceleration**2)), STATED[name][0]
    conform(f"{name}, RMS of 60 s at 500 Hz, m/s^2", SOURCE, rms, stated, tolerance=0.02 * stated)


@pytest.mark.parametrize("name", CLASSES)
def test_density_of_realisations_stays_within_a_tenth_of_the_peak(name, conform):
    runs = [Iso7096(name, 300.0).floor(0.01, seed).acceleration[100:] for seed in range(4)]
    f, density = np.mean([welch(run, 100.0, nperseg=1024) for run in runs], axis=0)
    target = acceleration_density(f, name)
    inside = (f > 1.1) & (f < 0.95 * CLASSES[name].highest)
    deviation = np.abs(density - target)[inside].max() / target.max()
    conform(f"{name}, deviation of the density of 20 min over its peak", SOURCE, deviation, tolerance=0.1)
