"""When noise that is stated is to be corrected: where what is seen is noise of the sensor, and all of it."""

import dataclasses

import numpy as np
import pytest
from scipy.signal import butter, lfilter, sosfiltfilt

from seatsim.recordings.quality.sensors import check_noise

RATE, ROWS = 250.0, 3000
TIME = np.arange(ROWS) / RATE
CHANNEL = "frame_acceleration"
SWELL = 5.0 * (1.0 + np.sin(0.8 * TIME)) * np.sin(9.0 * TIME)
"""m/s^2; a motion that swells and dies away."""


def white(seed):
    return np.random.default_rng(seed).standard_normal(ROWS)


@pytest.fixture
def found(under_test):
    """A function from the channel of two runs, the second a repeat or not, and its stated noise to the issues."""

    def check(values, stated, is_repeat=False):
        runs = [
            under_test({CHANNEL: each}, RATE, {CHANNEL: stated}, name) for name, each in zip("ab", values, strict=True)
        ]
        entry = runs[1].recording.runs["b"]._replace(repeat_of="a" if is_repeat else None)
        whole = dataclasses.replace(runs[0].recording, runs={**runs[0].recording.runs, "b": entry})
        runs = [run._replace(recording=whole) for run in runs]
        return [(issue.severity, issue.sentence) for issue in check_noise(runs)]

    return check


def test_noise_of_the_sensor_that_is_stated_too_small_is_to_be_corrected(found):
    values = [SWELL + white(seed) for seed in (0, 1)]
    for is_repeat in (False, True):
        [(severity, said)] = found(values, 0.2, is_repeat)
        assert severity == "warning" and "is seen; correct it" in said
    assert found(values, 0.6) == []


def test_broadband_motion_that_swells_with_the_rest_is_no_noise(found):
    values = [SWELL + (0.3 + np.abs(SWELL)) * white(seed) for seed in (0, 1)]
    [(severity, said)] = found(values, 0.05)
    assert severity == "note" and "grows with the motion: it is no noise of the sensor" in said


def test_broadband_motion_that_comes_again_is_no_noise(found):
    motion = 9.0 * np.sin(9.0 * TIME) + white(3)
    values = [motion + 0.1 * white(seed) for seed in (0, 1)]
    [(severity, said)] = found(values, 0.1, is_repeat=True)
    assert severity == "note" and "comes again when the excitation is repeated" in said
    # Without the repeat nothing tells it from noise.
    assert [severity for severity, _ in found(values, 0.1)] == ["warning"]


def test_filtered_noise_is_not_taken_for_less_than_it_is_where_repeats_show_all_of_it(found):
    motion = 9.0 * np.sin(9.0 * TIME)
    noise = [lfilter([0.1], [1.0, -0.9], white(seed)) for seed in (0, 1)]
    values = [motion + each for each in noise]
    stated = float(np.std(noise[0]))
    assert found(values, stated, is_repeat=True) == []
    assert [severity for severity, _ in found(values, stated)] == ["warning"]
    assert [severity for severity, _ in found(values, 10.0 * stated, is_repeat=True)] == ["warning"]


@pytest.mark.parametrize("highest", [0.1, 0.4])
def test_a_filter_that_took_the_noise_is_named_and_nothing_is_to_be_corrected(found, highest):
    values = [sosfiltfilt(butter(6, highest, output="sos"), SWELL + white(seed)) for seed in (0, 1)]
    [(severity, said)] = found(values, 1.0)
    assert severity == "note" and "it was filtered" in said and "correct" not in said


def test_repeats_show_what_the_noise_is_to_be_corrected_to(found):
    motion = 9.0 * np.sin(9.0 * TIME)
    [(_, said)] = found([motion + 0.1 * white(seed) for seed in (0, 1)], 1.0, is_repeat=True)
    assert "repeats differ by 0.1 only; correct it" in said
