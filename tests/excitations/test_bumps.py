"""Bumps: geometry, impulses at kinks, refusals."""

import numpy as np
import pytest

from seatsim.excitations.road import Bumps
from seatsim.schema.errors import InputError

HALF = Bumps("half_sine", 0.04, 1.0, 5.0, 3.0, patch=0.05, through="direct")


def shape(name, s, height, length):
    inside = (s >= 0) & (s <= length)
    form = np.sin(np.pi * s / length) if name == "half_sine" else (1 - np.cos(2 * np.pi * s / length)) / 2
    return np.where(inside, height * form, 0.0)


@pytest.mark.parametrize("name", ["half_sine", "haversine"])
def test_road_under_a_small_patch_is_the_bump(name):
    made = HALF._replace(shape=name, patch=0.01, number=3, spacing=2.5)
    floor = made.floor(0.0002, 0)
    s = 5.0 * (floor.time - 1.0) - 0.005
    expected = sum(shape(name, s - 2.5 * k, 0.04, 1.0) for k in range(3))
    np.testing.assert_allclose(floor.displacement, expected, atol=3.5e-4)


@pytest.mark.parametrize("name", ["half_sine", "haversine"])
def test_patch_takes_the_mean_elevation(name, conform):
    made = HALF._replace(shape=name, patch=0.3)
    floor = made.floor(0.001, 0)
    k = 1100
    edge = 5.0 * (floor.time[k] - 1.0)
    under = shape(name, np.linspace(edge - 0.3, edge, 100001), 0.04, 1.0)
    claim, mean = f"{name} bump under a patch of 0.3 m, elevation, m", under.mean()
    conform(claim, "mean elevation under the patch", floor.displacement[k], mean, tolerance=1e-4 * mean)


@pytest.mark.parametrize(("step", "first"), [(0.002, 1.0), (0.001, 1.00013), (0.00037, 1.0), (0.0001, 1.00013)])
def test_impulse_at_the_kink_has_its_area_at_any_step(step, first):
    # Past the pulse, which takes 10 ms, the floor rises at the mean slope under the patch.
    floor = HALF._replace(first=first).floor(step, 0)
    k = round(1.02 / step)
    edge = 5.0 * (floor.time[k] - first)
    slope = 0.04 * (np.sin(np.pi * edge) - np.sin(np.pi * (edge - 0.05))) / 0.05
    area = np.trapezoid(floor.acceleration[: k + 1], dx=step)
    assert area == pytest.approx(5.0 * slope, rel=1e-3)
    assert area == pytest.approx(5.0 * 0.04 * np.pi, rel=0.05)
    total = np.trapezoid(floor.acceleration, dx=step)
    assert abs(total) < 1e-9


def test_pulse_height_is_that_of_the_patch(conform):
    peak, expected = HALF.floor(0.0002, 0).acceleration.max(), 5.0**2 * 0.04 * np.pi / 0.05
    claim = "half-sine bump, peak acceleration, m/s^2"
    conform(claim, "v^2 h pi / (L patch)", peak, expected, tolerance=0.01 * expected)


def test_cab_comes_to_rest_after_the_bump():
    floor = Bumps("half_sine", 0.05, 1.0, 8.0, 12.0).floor(0.001, 0)
    assert np.abs(floor.acceleration[-100:]).max() < 1e-4
    assert np.abs(floor.displacement[-100:]).max() < 1e-5
    assert np.abs(floor.acceleration[:1000]).max() < 1e-3


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"number": 2, "spacing": 0.5}, "would overlap; permitted: at least 1 m"),
        ({"number": 3, "spacing": 10.0}, "after the run's end at 3 s"),
        ({"first": 2.95}, "lengthen duration"),
    ],
)
def test_impossible_rows_are_refused(change, message):
    with pytest.raises(InputError, match=message):
        HALF._replace(**change).floor(0.001, 0)
