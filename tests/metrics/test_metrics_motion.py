"""Figures of motion, force and energy, and the transmissibility."""

import math

import numpy as np
import pytest
from scipy import signal as sp

from seatsim.metrics.motion import electrical_energy, end_stop_hits, energy_residual, force_tracking_error, peak, rms
from seatsim.metrics.spectra import trusted_gain
from seatsim.schema.errors import InputError


def test_rms_and_peak_of_a_sine():
    x = 3 * np.sin(2 * np.pi * np.arange(1000) / 100)
    assert rms(x) == pytest.approx(3 / math.sqrt(2))
    assert peak(x) == pytest.approx(3.0)
    assert peak([-5.0, 2.0]) == 5.0


def test_a_lost_sample_is_not_hidden():
    assert math.isnan(rms([1.0, math.nan]))
    assert math.isnan(peak([1.0, math.nan]))


@pytest.mark.parametrize(
    ("displacement", "hits"),
    [
        ([0, 0.01, 0.02], 0),
        ([0, 0.05, 0.06, 0.07, 0.05], 1),
        ([0, 0.06, 0.0, 0.06, 0.0, -0.06], 3),
        ([0.06, 0.06], 1),
        ([0.06, -0.06, 0.06], 3),
        ([0.05, -0.05], 0),
        ([math.nan, 0.06], 1),
    ],
)
def test_end_stop_hits(displacement, hits):
    assert end_stop_hits(displacement, (-0.05, 0.05)) == hits


def test_force_tracking_error():
    error = force_tracking_error([100.0, -100.0, 100.0, math.nan], [90.0, -110.0, 90.0, 5000.0])
    assert error == pytest.approx((10.0, 0.1))


def test_force_tracking_error_without_a_wanted_force():
    assert all(math.isnan(v) for v in force_tracking_error([math.nan] * 3, [1.0] * 3))
    error, relative = force_tracking_error([0.0, 0.0], [3.0, 3.0])
    assert error == 3.0 and math.isnan(relative)


def test_electrical_energy():
    time = np.linspace(0, 10, 1001)
    assert electrical_energy(np.full(1001, 2.0), 5.0, 100.0) == pytest.approx(200.0)
    assert electrical_energy(np.sin(2 * np.pi * time), 5.0, 100.0) == pytest.approx(25.0)
    with pytest.raises(InputError, match="resistance"):
        electrical_energy([1.0], 0.0, 100.0)


def test_energy_residual():
    time = np.linspace(0, 1, 101)
    parts = [0.6 * time, 0.3 * time, 0.09 * time + 7.0]
    assert energy_residual(time, parts) == pytest.approx(0.01)
    assert energy_residual(time, [*parts, 0.01 * time]) == pytest.approx(0.0, abs=1e-15)


def seat(rate):
    """Single mass on spring and damper, 1.5 Hz and damping ratio 0.3, as digital sections at `rate`."""
    w, zeta = 2 * math.pi * 1.5, 0.3
    return sp.bilinear([2 * zeta * w, w * w], [1, 2 * zeta * w, w * w], rate)


@pytest.mark.parametrize("seconds", [60, 300])
def test_transmissibility_of_a_known_seat(seconds, conform):
    rate = 200.0
    floor = np.random.default_rng(11).normal(size=int(seconds * rate))
    driver = sp.lfilter(*seat(rate), floor)
    frequency, gain = trusted_gain(floor, driver, rate, 10.0)
    band = frequency > 0.5
    _, truth = sp.freqz(*seat(rate), frequency[band], fs=rate)
    claim = f"transmissibility of one mass from {seconds} s of noise, greatest relative deviation, 0.5 to 10 Hz"
    conform(claim, "scipy.signal.freqz", np.abs(gain[band] / np.abs(truth) - 1).max(), tolerance=0.08)


def test_floor_at_rest_has_no_transmissibility():
    assert np.isnan(trusted_gain(np.zeros(1000), np.ones(1000), 100.0, 50.0)[1]).all()
