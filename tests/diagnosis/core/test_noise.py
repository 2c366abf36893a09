"""Whitened noise has the mean square 1, whatever it is made of, and weights invert the spectrum that is stated."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.noise import NoiseWeights, weigh_noise
from seatsim.diagnosis.spectra import smooth_spectrum

from .noisy import draw, mean_squares, pose
from .toy import NOISE, RATE


@pytest.fixture
def more_replicates(monkeypatch):
    """Carry noise by 12 simulations, whose spectra are known well enough to be compared with exact ones."""
    monkeypatch.setattr("seatsim.diagnosis.noise._REPLICATES", 12)


def test_stated_noise_is_whitened_to_mean_square_1_in_every_channel():
    problem = pose({"model_error": 0.0})
    weights = weigh_noise(problem)
    found, count = mean_squares(weights, draw(problem, NOISE))
    np.testing.assert_allclose(found, 1.0, atol=3.5 * np.sqrt(2.0 / count))
    low, count = mean_squares(weights, draw(problem, 2.0 * NOISE))
    np.testing.assert_allclose(low, 4.0, atol=4.0 * 3.5 * np.sqrt(2.0 / count))


def test_noise_of_the_floor_is_carried_through_the_rig_and_counts(more_replicates):
    gain, noise = np.array([3.0, 0.5]), 0.4
    problem = pose({"model_error": 0.0}, floor_noise=noise, floor_gain=tuple(gain))
    weights, rng = weigh_noise(problem), np.random.default_rng(11)
    quiet, carried = draw(problem, NOISE), gain[:, None] * noise
    drawn = {run: own + carried * rng.standard_normal(own.shape[1]) for run, own in quiet.items()}
    found, count = mean_squares(weights, drawn)
    # Beside the numbers' own error, that of a spectrum estimated from 12 x 9 bins or more.
    np.testing.assert_allclose(found, 1.0, atol=3.5 * np.sqrt(2.0 / count) + 0.02)
    power = NOISE**2 + (gain * noise) ** 2
    level = np.mean(2.0 / weights.weights["first"] ** 2, axis=1) / 1800
    np.testing.assert_allclose(level, power, rtol=0.05)


def test_a_small_share_of_the_signal_counts_as_noise():
    problem = pose({"model_error": 0.1}, {"first": 300})
    measured = problem.measured["first"]
    signal = smooth_spectrum(np.abs(np.fft.rfft(measured - measured.mean(axis=1, keepdims=True))) ** 2)
    expected = NOISE[:, None] ** 2 * 300 + 0.1**2 * signal
    np.testing.assert_allclose(2.0 / weigh_noise(problem).weights["first"] ** 2, expected[:, :150], rtol=1e-9)


@pytest.mark.parametrize("counts", [True, False])
def test_what_repeats_differ_by_counts_where_it_is_more_than_the_noise_and_there_alone(counts):
    runs = {"first": 400, "again": 300, "other": 600}
    problem = pose({"model_error": 0.0}, runs=runs, repeats={"again": "first"})
    time = np.arange(600) / RATE
    tone = np.tile(np.sin(2.0 * np.pi * 40.0 * time), (2, 1))
    measured = {"first": np.zeros((2, 400)), "again": tone[:, :300], "other": tone}
    weights = weigh_noise(dataclasses.replace(problem, measured=measured), counts).weights
    for run, count in runs.items():
        power, frequency = 2.0 / weights[run] ** 2 / count, np.arange(count // 2) * RATE / count
        near = np.abs(frequency - 40.0) < 3.0
        far = np.abs(frequency - 40.0) > 12.0
        assert np.all(power[1, near] > 10.0 * NOISE[1] ** 2) == counts
        np.testing.assert_allclose(power[1, far], NOISE[1] ** 2)
        # Half of the tone's power, 1/4 N of |X|^2 / N at one of the two sides, spread over 19 bins of 300 rows.
        peak = 0.5 * 300 / 4 / 19 if counts else NOISE[1] ** 2
        assert power[1, np.argmin(np.abs(frequency - 40.0))] == pytest.approx(peak, rel=0.01)


def test_what_a_force_may_have_done_to_all_channels_weighs_as_little_as_its_power_says():
    rng, count = np.random.default_rng(2), 40
    power = rng.uniform(0.5, 2.0, (2, count))
    force = rng.standard_normal((2, count)) + 1j * rng.standard_normal((2, count))
    weights = NoiseWeights({"first": power}).add_force({"first": 3.0 * force})
    white = NoiseWeights({"first": np.full((2, count), 2.0)})

    def draw(*shape):
        return (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2.0)

    drawn = np.sqrt(power) * draw(4000, 2, count) + 3.0 * force * draw(4000, 1, count)
    parts = np.concatenate([drawn.real, drawn.imag], axis=-1)
    whitened = weights.convert(parts, "first", white)
    np.testing.assert_allclose(np.mean(whitened**2, axis=0), 1.0, atol=0.15)
    np.testing.assert_allclose(np.mean(whitened[:, 0] * whitened[:, 1], axis=0), 0.0, atol=0.1)
    np.testing.assert_allclose(white.convert(whitened, "first", weights), parts, atol=1e-9)
    np.testing.assert_allclose(weights.expect("first"), power + 9.0 * np.abs(force) ** 2)
