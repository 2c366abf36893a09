"""Sensors: filters against scipy.signal, noise that follows the seed, and what a law then sees in a run."""

import numpy as np
import pytest
from scipy.signal import cont2discrete, lfilter

from seatsim.rig.control import Measurement
from seatsim.rig.sensors import Sensors, at_rest

STEP, EVERY = 0.001, 5
PERIOD = STEP * EVERY
NOTHING = Measurement(*np.zeros(len(Measurement._fields)))
WB, WD, WC = (2 * np.pi * f for f in (80.0, 40.0, 0.1))


def filtered(numerator, denominator, u, step):
    b, a, _ = cont2discrete((numerator, denominator), step, method="foh")
    return lfilter(np.ravel(b), a, u)


def readings(sensors, x, rates, floor):
    """What the law sees of N steps, a row a sample: displacement, velocities and accelerations."""
    made, s, rows = sensors.instruments(STEP, PERIOD), at_rest(0.0), []
    for k in range(len(x)):
        s = made.advance_filters(floor[k], x[k], rates[k], s)
        if k % EVERY == 0:
            y, s = made.read(NOTHING, np.zeros((1, 4)), 0, s)
            rows.append(y)
    return Measurement(*np.array(rows).T)


@pytest.fixture(scope="module")
def motion():
    rng = np.random.default_rng(3)
    walk = np.vstack([np.zeros(4), rng.standard_normal((1999, 4))])
    x, frame, driver, floor = lfilter([0.2], [1, -0.8], walk, axis=0).T
    rates = np.zeros((len(x), 4))
    rates[:, 1], rates[:, 3] = frame - floor, driver - frame
    seen = readings(Sensors(floor_accelerometer=True), 0.01 * x, rates, floor)
    return 0.01 * x, frame, driver, floor, seen


def test_readings_are_the_anti_alias_low_pass(motion):
    x, frame, driver, floor, seen = motion
    pairs = {"displacement": x, "frame_acceleration": frame, "driver_acceleration": driver, "floor_acceleration": floor}
    for name, true in pairs.items():
        expected = filtered([WB], [1, WB], true, STEP)[::EVERY]
        np.testing.assert_allclose(getattr(seen, name), expected, rtol=1e-9, atol=1e-12)


def test_velocities_are_made_of_readings(motion):
    seen = motion[-1]
    v = filtered([WD, 0.0], [1, WD], seen.displacement, PERIOD)
    np.testing.assert_allclose(seen.velocity, v, rtol=1e-9, atol=1e-9)
    frame, driver = (seen.frame_velocity, seen.frame_acceleration), (seen.driver_velocity, seen.driver_acceleration)
    for velocity, reading in (frame, driver):
        np.testing.assert_allclose(velocity, filtered([1.0], [1, WC], reading, PERIOD), rtol=1e-9, atol=1e-9)


def test_rounding_of_the_filter_does_not_grow_in_the_velocity():
    # A reading that stays far from zero: a lag beside it would agree with it in nearly every digit.
    made, s = Sensors().instruments(STEP, PERIOD), at_rest(1e6)
    for _ in range(50):
        y, s = made.take(NOTHING._replace(displacement=1e6), s)
        assert y.velocity == 0.0


def test_a_displaced_start_is_no_motion():
    made, s = Sensors().instruments(STEP, PERIOD), at_rest(0.02)
    for _ in range(10):
        y, s = made.read(NOTHING, np.zeros((1, 4)), 0, made.advance_filters(0.0, 0.02, (0.0,) * 4, s))
    assert y.velocity == pytest.approx(0.0, abs=1e-12)


def test_noise_follows_the_seed_and_has_the_stated_size():
    sensors = Sensors(displacement_noise=1e-4, acceleration_noise=0.05)
    noise = sensors.noise(20000, 7)
    np.testing.assert_array_equal(noise, sensors.noise(20000, 7))
    assert not np.allclose(noise, sensors.noise(20000, 8))
    np.testing.assert_allclose(noise.std(axis=0), [1e-4, 0.05, 0.05, 0.05], rtol=0.02)
    assert np.abs(np.corrcoef(noise.T) - np.eye(4)).max() < 0.03
