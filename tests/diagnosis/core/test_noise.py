"""Whitened noise has the mean square 1, whatever it is made of, and weights invert the spectrum that is stated."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.input_noise import carry_force
from seatsim.diagnosis.noise import NoiseWeights, weigh_noise
from seatsim.recordings.recording import ChannelEntry

from .noisy import RUNS, draw, mean_squares, pose
from .toy import NOISE, RATE


def averaged(power, half_width=0.15):
    """Return the average over at least 4 bins and `half_width` of the frequency to either side, bin by bin."""
    return np.array([
        power[:, max(0, k - max(4, int(half_width * k))) : k + max(4, int(half_width * k)) + 1].mean(axis=1)
        for k in range(power.shape[1])
    ]).T  # fmt: skip


def test_stated_noise_is_whitened_to_mean_square_1_in_every_channel():
    problem = pose({"model_error": 0.0})
    weights = weigh_noise(problem)
    found, count = mean_squares(weights, draw(problem, NOISE))
    np.testing.assert_allclose(found, 1.0, atol=3.5 * np.sqrt(2.0 / count))
    low, count = mean_squares(weights, draw(problem, 2.0 * NOISE))
    np.testing.assert_allclose(low, 4.0, atol=4.0 * 3.5 * np.sqrt(2.0 / count))


def test_whitened_numbers_are_real_and_imaginary_parts_below_the_highest_frequency():
    problem = pose({"model_error": 0.0, "highest_frequency": 30.0})
    weights, residual = weigh_noise(problem), draw(problem, NOISE)["first"]
    # 1800 rows at 200 Hz: bins every 1/9 Hz, those below 30 Hz.
    assert weights.bins == {"first": 270, "second": 360}
    whitened = weights(residual, "first")
    assert whitened.shape == (2, 540)
    expected = np.fft.rfft(residual)[:, :270] * np.sqrt(2.0 / 1800) / NOISE[:, None]
    np.testing.assert_allclose(whitened, np.hstack([expected.real, expected.imag]), rtol=1e-9, atol=1e-12)


def test_without_a_highest_frequency_all_below_half_the_rate_are_compared():
    weights = weigh_noise(pose({"highest_frequency": 1e3}))
    assert weights.bins == {"first": 900, "second": 1200}
    assert weights.weights["first"].shape == (2, 900)


def test_noise_of_the_floor_is_carried_through_the_rig_and_counts():
    gain, noise = np.array([3.0, 0.5]), 0.4
    problem = pose({"model_error": 0.0, "replicates": 12}, floor_noise=noise, floor_gain=tuple(gain))
    weights, rng = weigh_noise(problem), np.random.default_rng(11)
    drawn = {
        run: own + gain[:, None] * noise * rng.standard_normal(own.shape[1])
        for run, own in draw(problem, NOISE).items()
    }
    found, count = mean_squares(weights, drawn)
    # Beside the numbers' own error, that of a spectrum estimated from 12 x 9 bins or more.
    np.testing.assert_allclose(found, 1.0, atol=3.5 * np.sqrt(2.0 / count) + 0.02)
    power = NOISE**2 + (gain * noise) ** 2
    level = np.mean(2.0 / weights.weights["first"] ** 2, axis=1) / 1800
    np.testing.assert_allclose(level, power, rtol=0.05)


def test_the_floors_noise_is_drawn_as_often_as_the_settings_say_and_the_same_every_time():
    problem = pose({"replicates": 5}, floor_noise=0.4, floor_gain=(3.0, 0.5))
    first, calls = weigh_noise(problem), len(problem.calls)
    # Each run is simulated without noise once, and with newly drawn noise.
    assert calls == 2 * (1 + 5)
    second = weigh_noise(problem)
    np.testing.assert_array_equal(first.weights["second"], second.weights["second"])


def test_a_small_share_of_the_signal_counts_as_noise():
    problem = pose({"model_error": 0.1, "smoothing": 0.2}, {"first": 300})
    measured = problem.measured["first"]
    signal = averaged(np.abs(np.fft.rfft(measured - measured.mean(axis=1, keepdims=True))) ** 2, 0.2)
    expected = NOISE[:, None] ** 2 * 300 + 0.1**2 * signal
    np.testing.assert_allclose(2.0 / weigh_noise(problem).weights["first"] ** 2, expected[:, :150], rtol=1e-9)


def test_a_model_error_that_the_recording_states_stands_for_the_small_share():
    problem = pose({"model_error": 0.1}, {"first": 300})
    for stated in (0.0, 0.3):
        header = problem.recording.header._replace(model_error=stated)
        told = dataclasses.replace(problem, recording=dataclasses.replace(problem.recording, header=header))
        same = pose({"model_error": stated}, {"first": 300})
        np.testing.assert_array_equal(weigh_noise(told).weights["first"], weigh_noise(same).weights["first"])


def test_an_offset_of_a_channel_is_no_signal():
    problem = pose(runs={"first": 300})
    shifted = dataclasses.replace(problem, measured={"first": problem.measured["first"] + 50.0})
    np.testing.assert_allclose(weigh_noise(shifted).weights["first"], weigh_noise(problem).weights["first"], rtol=1e-8)


def test_a_channel_without_noise_has_the_least_power():
    problem = pose({"model_error": 0.0, "least_power": 1e-3}, noise=(0.0, 0.02))
    power = 2.0 / weigh_noise(problem).weights["first"] ** 2 / 1800
    np.testing.assert_allclose(power[0], 1e-3 * problem.spread[0] ** 2)
    np.testing.assert_allclose(power[1], np.maximum(0.02**2, 1e-3 * problem.spread[1] ** 2))


def test_errors_of_channels_add_to_the_noise():
    problem = pose({"model_error": 0.0})
    errors = {run: np.array([[7.0], [0.0]]) for run in RUNS}
    power = 2.0 / weigh_noise(problem).add(errors).weights["second"] ** 2
    np.testing.assert_allclose(power[0], NOISE[0] ** 2 * 2400 + 7.0)
    np.testing.assert_allclose(power[1], NOISE[1] ** 2 * 2400)


def test_a_random_force_counts_with_its_spectrum_wherever_it_comes_from():
    problem = pose({"model_error": 0.0, "replicates": 12}, force_gain=(0.0, 0.3))
    rng = np.random.default_rng(3)
    forces = {run: 2.0 * rng.standard_normal(count + 201) for run, count in RUNS.items()}
    found = weigh_noise(problem).add(carry_force(problem, forces))
    level = np.mean(2.0 / found.weights["second"] ** 2, axis=1) / 2400
    np.testing.assert_allclose(level, NOISE**2 + np.array([0.0, 0.6]) ** 2, rtol=0.05)
    without = weigh_noise(problem)
    np.testing.assert_array_equal(found.weights["second"][0], without.weights["second"][0])


def test_a_burst_of_the_force_counts_as_if_it_were_spread_over_the_run():
    problem = pose({"model_error": 0.0, "replicates": 12}, force_gain=(0.0, 0.3))
    burst = np.zeros(2401 + 200)
    # Within the first second, which is not compared.
    burst[:150] = 8.0 * np.random.default_rng(3).standard_normal(150)
    found = weigh_noise(problem).add(carry_force(problem, {"first": burst[:2001], "second": burst}))
    level = np.mean(2.0 / found.weights["second"][1] ** 2) / 2400
    assert level == pytest.approx(NOISE[1] ** 2 + (0.3 * 8.0) ** 2 * 150 / 2601, rel=0.2)


def test_the_spectrum_of_the_carried_noise_is_smoothed():
    problem = pose({"model_error": 0.0}, floor_noise=0.4, floor_gain=(3.0, 0.5))
    power = 1.0 / weigh_noise(problem).weights["second"][:, 600:] ** 2
    # Three draws of at least 181 bins each; unsmoothed, their mean would scatter by 1/sqrt(3).
    assert np.all(power.std(axis=1) < 0.1 * power.mean(axis=1))


def test_noise_of_the_current_is_carried_only_where_no_command_is_recorded():
    seen = []

    class Logging(type(pose())):
        def simulated(self, run, deviations, effects, inputs=None):
            if inputs is not None:
                seen.append(inputs.floor)
            return super().simulated(run, deviations, effects, inputs)

    plain = pose(runs={"first": 300})
    channels = plain.recording.channels | {"coil_current": ChannelEntry("A", 0.03)}
    kept = {each.name: getattr(plain, each.name) for each in dataclasses.fields(plain)}
    kept["recording"] = dataclasses.replace(plain.recording, channels=channels)
    still = np.zeros(len(plain.inputs["first"].floor.acceleration))
    for command in (None, still):
        floor = plain.inputs["first"].floor._replace(command=command, coil_current=still + 1.0)
        kept["inputs"] = {"first": plain.inputs["first"]._replace(floor=floor)}
        weigh_noise(Logging(**kept))
    drawn, commanded = seen[:3], seen[3:]
    assert [np.std(each.coil_current[::2]) for each in drawn] == pytest.approx([0.03] * 3, rel=0.15)
    assert all(np.mean(each.coil_current) == pytest.approx(1.0, abs=0.01) for each in drawn)
    assert all(np.all(each.coil_current == 1.0) for each in commanded)
    assert not np.array_equal(drawn[0].coil_current, drawn[1].coil_current)


def test_a_sensors_noise_is_drawn_row_by_row_and_linear_between_rows():
    seen = []

    class Logging(type(pose())):
        def simulated(self, run, deviations, effects, inputs=None):
            if inputs is not None:
                seen.append(inputs.floor.acceleration)
            return super().simulated(run, deviations, effects, inputs)

    plain = pose(runs={"first": 3000}, floor_noise=0.25)
    weigh_noise(Logging(**{each.name: getattr(plain, each.name) for each in dataclasses.fields(plain)}))
    rows = seen[0][::2]
    assert np.std(rows) == pytest.approx(0.25, rel=0.05)
    np.testing.assert_allclose(seen[0][1:-1:2], 0.5 * (rows[:-1] + rows[1:]), atol=1e-12)


def test_what_repeats_differ_by_counts_where_it_is_more_than_the_noise():
    problem = pose({"model_error": 0.0}, runs={"first": 4000, "again": 4000}, repeats={"again": "first"})
    rng = np.random.default_rng(8)
    level = np.array([5.0 * NOISE[0], 0.2 * NOISE[1]])
    own = problem.signals["first"]["a"]
    measured = {run: own + level[:, None] * rng.standard_normal(own.shape) for run in problem.runs}
    weights = weigh_noise(dataclasses.replace(problem, measured=measured))
    for run in problem.runs:
        power = np.mean(2.0 / weights.weights[run] ** 2, axis=1) / 4000
        np.testing.assert_allclose(power, [level[0] ** 2, NOISE[1] ** 2], rtol=0.1)


def test_a_repeat_of_a_run_that_is_left_out_says_nothing():
    problem = pose({"model_error": 0.0}, runs={"first": 400, "again": 400}, repeats={"again": "first"})
    alone = weigh_noise(problem.on_runs(["again"]))
    np.testing.assert_allclose(2.0 / alone.weights["again"][1] ** 2, NOISE[1] ** 2 * 400)


def test_repeats_that_differ_at_one_frequency_count_there_alone():
    runs = {"first": 400, "again": 300, "other": 600}
    problem = pose({"model_error": 0.0}, runs=runs, repeats={"again": "first"})
    time = np.arange(600) / RATE
    tone = np.sin(2.0 * np.pi * 40.0 * time)
    measured = {run: np.zeros((2, count)) for run, count in runs.items()} | {"again": np.tile(tone[:300], (2, 1))}
    measured["other"] = np.tile(tone, (2, 1))
    weights = weigh_noise(dataclasses.replace(problem, measured=measured)).weights
    for run, count in runs.items():
        power, frequency = 2.0 / weights[run] ** 2 / count, np.arange(count // 2) * RATE / count
        near = np.abs(frequency - 40.0) < 3.0
        far = np.abs(frequency - 40.0) > 12.0
        assert np.all(power[1, near] > 10.0 * NOISE[1] ** 2)
        np.testing.assert_allclose(power[1, far], NOISE[1] ** 2)
        # Half of the tone's power, 1/4 N of |X|^2 / N at one of the two sides, spread over 19 bins of 300 rows.
        assert power[1, np.argmin(np.abs(frequency - 40.0))] == pytest.approx(0.5 * 300 / 4 / 19, rel=0.01)


def test_weights_are_frozen():
    with pytest.raises(dataclasses.FrozenInstanceError):
        NoiseWeights({}).power = {}
