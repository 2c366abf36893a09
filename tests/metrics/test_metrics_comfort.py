"""Comfort figures against closed forms, and how they scale."""

import math

import numpy as np
import pytest

from seatsim.metrics.comfort import (
    crest_factor,
    daily_exposure,
    dose,
    estimated_vdv,
    mtvv,
    running_rms,
    vdv,
    weighted_rms,
)

RATE = 1000.0


def sine(amplitude, frequency, seconds, sample_rate=RATE):
    return amplitude * np.sin(2 * np.pi * frequency * np.arange(int(seconds * sample_rate)) / sample_rate)


def test_weighted_rms_of_a_sine_is_the_weighted_amplitude(conform):
    # The start-up of the high-pass is 2 of 300 s.
    found = weighted_rms(sine(2.0, 5.0, 300), RATE)
    expected = 2 * 1.039 / math.sqrt(2)
    claim = "a_w of a sine of 5 Hz and 2 m/s^2, m/s^2"
    conform(claim, "ISO 2631-1:1997, table 3: 1.039", found, expected, tolerance=1e-3 * expected)


def test_vdv_of_a_sine(conform):
    found, expected = vdv(sine(3.0, 4.0, 60), RATE), 3 * (3 / 8 * 60) ** 0.25
    conform("VDV of a sine of 3 m/s^2 over 60 s, m/s^1.75", "A (3 T / 8)^(1/4)", found, expected, tolerance=1e-11)


def test_estimated_vdv_of_gaussian_motion_is_six_percent_high(conform):
    x = np.random.default_rng(2).normal(size=500_000)
    found = estimated_vdv(1.0, 500.0) / vdv(x, RATE)
    conform("estimated VDV over VDV of Gaussian motion", "1.4 / 3^(1/4)", found, 1.4 / 3**0.25, tolerance=0.01)


@pytest.mark.parametrize(("a_w", "hours"), [(0.5, 8), (1.0, 2)])
def test_daily_exposure(a_w, hours, conform):
    claim = f"A(8) of {hours} h at {a_w} m/s^2, m/s^2"
    conform(claim, "a_w sqrt(T / 8 h)", daily_exposure(a_w, hours * 3600), 0.5, tolerance=1e-12)


def test_running_rms_of_a_burst(conform):
    x = np.zeros(5000)
    x[2000:2500] = 2.0
    running = running_rms(x, RATE)
    assert running.shape == x.shape
    assert running[1999] == 0
    assert running[2249] == pytest.approx(1.0)
    assert running[2499:3000] == pytest.approx(math.sqrt(2))
    assert running[3499] == pytest.approx(0, abs=1e-6)
    claim = "MTVV of a burst of 2 m/s^2 over half a second, m/s^2"
    conform(claim, "closed form, window of 1 s", mtvv(x, RATE), math.sqrt(2), tolerance=1e-6)


def test_running_rms_stays_a_number_after_a_huge_shock():
    x = np.full(4000, 1e-6)
    x[10] = 1e9
    assert np.isfinite(running_rms(x, RATE)).all()


@pytest.mark.parametrize(
    ("signal", "expected"),
    [(sine(7.0, 5.0, 4), math.sqrt(2)), (np.array([1.0, -1.0, 1.0]), 1.0), (np.array([0.0, 0.0, 0.0, -2.0]), 2.0)],
)
def test_crest_factor(signal, expected):
    assert crest_factor(signal) == pytest.approx(expected, rel=1e-9)


def test_ratios_at_rest_are_not_numbers():
    still = np.zeros(2000)
    assert math.isnan(crest_factor(still))
    assert math.isnan(dose(still, RATE).vdv_ratio)


def test_dose_of_a_sine(conform):
    d = dose(sine(2.0, 5.0, 16), RATE)
    assert d.duration == 16.0
    for name, expected in {
        "rms": 2**0.5, "mtvv": 2**0.5, "estimated_vdv": 2.8 * 2**0.5,
        "crest_factor": 2**0.5, "mtvv_ratio": 1.0, "vdv_ratio": 1.5**0.25,
    }.items():  # fmt: skip
        claim = f"{name} of a weighted sine of 2 m/s^2 over 16 s"
        conform(claim, "closed form", getattr(d, name), expected, tolerance=1e-9)
