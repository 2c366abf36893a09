"""Effects with a random signal: how they are found, and how the search goes on beside them."""

import numpy as np
import pytest

from seatsim.diagnosis.localise.discrepancy import Discrepancy
from seatsim.diagnosis.localise.disturbance import BIAS_DRIFT, Disturbance, add_strength
from seatsim.diagnosis.noise import NoiseWeights
from seatsim.diagnosis.result import Cause, Estimate

from .toy import CHANNELS, pose, record


@pytest.fixture(scope="module")
def problem(folder):
    return pose(record(folder, runs={"first": 800, "second": 600}, channels=CHANNELS[:4], noise=0.01))


def test_the_share_of_a_signal_that_a_repeat_shows_again(folder, problem):
    repeated = pose(
        record(folder, runs={"first": 800, "again": 600}, channels=CHANNELS[:4], repeats={"again": "first"})
    )
    first, other = np.random.default_rng(5).standard_normal((2, 800))
    signals = {"first": first, "again": 1.0 + 2.0 * first[:600], "second": other[:600]}
    found = Disturbance(BIAS_DRIFT, Discrepancy("sensor", "error", "N", signals, {}), {}, NoiseWeights({}))
    assert found.measure_share_repeated(repeated) == pytest.approx(1.0)
    assert found.measure_share_repeated(problem) == 0.0
    signals["again"] = other[:600]
    assert found.measure_share_repeated(repeated) < 0.02


def test_a_cause_has_the_strength_of_its_signal_and_the_channel_that_errs():
    cause = Cause(BIAS_DRIFT, 0.9, 0.1, {"share": Estimate(1.0, 0.1, "-")})
    found = Discrepancy("sensor", "error", "N", {"a": np.full(3, 3.0), "b": np.full(3, -4.0)}, {}, "damper_force")
    strong = add_strength(cause, found)
    assert strong[:3] == cause[:3] and list(strong.parameters) == ["channel", "rms"]
    assert strong.parameters["channel"] == "damper_force"
    assert strong.parameters["rms"] == Estimate(pytest.approx(np.sqrt(12.5)), 0.0, "N")
    assert list(add_strength(cause, found._replace(channel="")).parameters) == ["rms"]
