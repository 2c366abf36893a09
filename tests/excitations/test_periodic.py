"""Tones and sweeps."""

import numpy as np
import pytest

from seatsim.excitations.periodic import Chirp, Sine, SteppedSine
from seatsim.schema.errors import InputError

STEP = 0.001


def test_sine_is_exact_after_its_first_second(conform):
    floor = Sine(0.01, 2.0, 5.0).floor(STEP, 0)
    t, omega = floor.time[1001:], 4 * np.pi
    for k, quantity in enumerate(("displacement", "velocity", "acceleration")):
        exact = 0.01 * np.imag((1j * omega) ** k * np.exp(1j * omega * t))
        deviation = np.max(np.abs(getattr(floor, quantity)[1001:] - exact)) / (0.01 * omega**k)
        claim = f"sine of 2 Hz, deviation of the {quantity} over its amplitude"
        conform(claim, "closed form", deviation, tolerance=1e-12)


def test_stepped_sine_holds_its_amplitude_in_every_step():
    frequencies, cycles = (1.0, 2.0, 5.0), 4
    made = SteppedSine(frequencies, cycles, 0.5)
    assert made.duration == pytest.approx(6 * (1 + 0.5 + 0.2))
    signal, start = made.floor(STEP, 0).displacement, 0.0
    for f in frequencies:
        held = signal[round((start + 1 / f) / STEP) : round((start + (1 + cycles) / f) / STEP)]
        assert np.sqrt(2 * np.mean(held**2)) == pytest.approx(0.5, rel=1e-3)
        spectrum = np.abs(np.fft.rfft(held))
        assert spectrum.argmax() == cycles
        start += (cycles + 2) / f
        end = round(start / STEP)
        assert abs(signal[min(end, len(signal) - 1)]) < 1e-6


@pytest.mark.parametrize(("start", "stop"), [(0.5, 20.0), (20.0, 0.5)])
def test_chirp_passes_its_frequencies(start, stop):
    duration = 60.0
    floor = Chirp(start, stop, 0.01, duration).floor(STEP, 0)
    crossings = np.flatnonzero(np.diff(np.signbit(floor.displacement[1:]))) * STEP
    middle = (crossings[1:] + crossings[:-1]) / 2
    measured = 0.5 / np.diff(crossings)
    part = middle / duration
    expected = start * (stop / start) ** part
    slow = (middle > 1) & (expected < 5)
    np.testing.assert_allclose(measured[slow], expected[slow], rtol=0.02)
    assert np.abs(floor.displacement[1000:]).max() == pytest.approx(0.01, rel=1e-3)


def test_chirp_of_acceleration_has_that_amplitude():
    acceleration = Chirp(1.0, 20.0, 2.0, 60.0, "acceleration").floor(STEP, 0).acceleration[5000:]
    peaks = np.abs(acceleration.reshape(-1)[: len(acceleration) // 1000 * 1000]).reshape(-1, 1000).max(axis=1)
    np.testing.assert_allclose(peaks, 2.0, rtol=0.02)


def test_chirp_between_equal_frequencies_is_refused():
    with pytest.raises(InputError, match="use kind: sine"):
        Chirp(3.0, 3.0, 0.01, 10.0).floor(STEP, 0)
