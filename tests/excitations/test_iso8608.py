"""Random roads carry the spectrum of ISO 8608."""

import numpy as np
import pytest
from scipy.signal import welch

from seatsim.excitations.road import Road, displacement_density

STEP, SPEED = 0.002, 20.0
OCTAVES = [(0.5 * 2**k, 2**k) for k in range(6)]


def octave_ratios(seed, road_class="C"):
    """Band powers of the floor's acceleration over those of the class, octaves from 0.5 to 32 Hz."""
    floor = Road(road_class, SPEED, 120.0, through="direct").floor(STEP, seed)
    f, measured = welch(floor.acceleration[1000:], 1 / STEP, nperseg=8192, window="hann")
    f, measured = f[1:], measured[1:]
    target = displacement_density(f / SPEED, road_class) / SPEED * (2 * np.pi * f) ** 4
    bands = [(f >= low) & (f < high) for low, high in OCTAVES]
    return np.array([measured[b].sum() / target[b].sum() for b in bands])


@pytest.mark.parametrize(("road_class", "mean"), [(name, 16e-6 * 4.0**k) for k, name in enumerate("ABCDEFGH")])
def test_geometric_means_of_the_classes(road_class, mean, conform):
    density = displacement_density(np.array([0.1]), road_class)[0]
    conform(f"class {road_class}, density at 0.1 cycle/m, m^3", "ISO 8608", density, mean, tolerance=1e-9 * mean)


def test_density_falls_with_the_square_of_the_wavenumber(conform):
    density = displacement_density(np.array([0.2]), "A")[0]
    conform("class A, density at 0.2 cycle/m, m^3", "ISO 8608, exponent 2", density, 4e-6, tolerance=4e-15)


def test_octave_bands_of_the_mean_over_seeds(conform):
    ratios = np.array([octave_ratios(seed) for seed in range(12)])
    np.testing.assert_allclose(ratios[5], 1.0, atol=0.12)
    for (low, high), ratio in zip(OCTAVES, np.mean(ratios, axis=0), strict=True):
        claim = f"road of class C, power from {low:g} to {high:g} Hz over that of the class, mean of 12 seeds"
        conform(claim, "ISO 8608", ratio, 1.0, tolerance=0.03)


def test_velocity_has_the_variance_of_a_flat_spectrum(conform):
    # G_v = 4 pi^2 n0^2 Gd V is constant between 0.011 V and 2.83 V.
    floor = Road("C", SPEED, 200.0, through="direct").floor(STEP, 1)
    expected = 4 * np.pi**2 * 0.1**2 * 256e-6 * SPEED * (2.83 - 0.011) * SPEED
    variance = np.var(floor.velocity[1000:])
    claim = "road of class C at 20 m/s, variance of the velocity, (m/s)^2"
    conform(claim, "4 pi^2 n0^2 Gd V times the band", variance, expected, tolerance=0.02 * expected)


def test_classes_are_scaled_copies():
    a, c = (Road(k, SPEED, 20.0).floor(STEP, 9).acceleration for k in "AC")
    np.testing.assert_allclose(c, 4 * a, rtol=1e-9, atol=1e-12)


def test_nothing_beyond_the_band():
    floor = Road("C", 10.0, 100.0, through="direct").floor(STEP, 1)
    f, density = welch(floor.acceleration[1000:], 1 / STEP, nperseg=8192, window="blackmanharris")
    assert density[f > 2.9 * 10].max() < 1e-6 * density.max()
