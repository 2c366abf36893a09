"""An accelerometer that stands still where the floor moves is told from one that follows."""

import numpy as np
import pytest

from seatsim.recordings.quality.sensors import check_floor_sensor, follows_floor
from seatsim.recordings.recording import load_recording

from ...faulty_recordings import RATE, blurred, limited, rewrite, stepped, with_play


@pytest.mark.parametrize("frequency", [0.5, 10.0])
def test_the_floor_of_a_sine_test_is_followed(copy, frequency):
    rewrite(copy, blurred(lambda values: 2.0 * np.sin(2 * np.pi * frequency / RATE * np.arange(len(values)))))
    assert follows_floor(load_recording(copy))


@pytest.fixture
def swinging():
    time = np.arange(5000) / RATE
    motion = 2.0 * np.sin(2 * np.pi * 1.3 * time) + 1.5 * np.sin(2 * np.pi * 3.7 * time)
    return motion + 0.01 * np.random.default_rng(3).standard_normal(len(time))


@pytest.mark.parametrize(
    ("fault", "kind", "words"),
    [(stepped, "steps", "steps or play"), (with_play, "steps", "steps or play"), (limited, "limit", "it is clipped")],
)
def test_the_kind_of_a_fault_is_named(under_test, swinging, fault, kind, words):
    import pandas as pd

    noise = 0.01 * np.random.default_rng(4).standard_normal(len(swinging))
    faulty = np.asarray(fault(pd.Series(swinging))) + noise
    found = list(check_floor_sensor(under_test({"floor_acceleration": faulty}, RATE, {"floor_acceleration": 0.01})))
    assert found and {(issue.kind, issue.severity) for issue in found} == {(kind, "warning")}
    assert all(words in issue.sentence for issue in found)


@pytest.mark.parametrize("amplitude", [0.05, 0.2])
def test_a_floor_so_slow_that_noise_hides_its_slope_shows_nothing_of_its_sensor(under_test, amplitude):
    motion = amplitude * np.sin(2 * np.pi * 0.3 / RATE * np.arange(5000))
    values = motion + 0.01 * np.random.default_rng(6).standard_normal(5000)
    run = under_test({"floor_acceleration": values}, RATE, {"floor_acceleration": 0.01})
    assert list(check_floor_sensor(run)) == []
