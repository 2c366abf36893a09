"""Effects with a random signal: how they are found, and how the search goes on beside them."""

import numpy as np
import pytest

from seatsim.diagnosis.localise.discrepancy import Discrepancy
from seatsim.diagnosis.localise.disturbance import BIAS_DRIFT, Disturbance, add_strength, find_bias_drift
from seatsim.diagnosis.noise import NoiseWeights
from seatsim.diagnosis.result import Cause, Estimate

from .toy import CHANNELS, place, pose, record, weigh_stated


@pytest.fixture(scope="module")
def problem(folder):
    return pose(record(folder, runs={"first": 800, "second": 600}, channels=CHANNELS[:4], noise=0.01))


def left(problem, *gaps, cycles=1):
    """Return a rig that leaves a tone of so many cycles a run, its RMS in standard deviations of the channels."""
    rng, residuals = np.random.default_rng(1), {}
    for run, values in problem.measured.items():
        noise = rng.standard_normal(values.shape)
        wave = np.cos(2.0 * np.pi * cycles * np.linspace(0.0, 1.0, values.shape[1], endpoint=False))
        noise /= np.sqrt(np.mean(noise**2, axis=1, keepdims=True))
        slow = np.outer(np.array(gaps) * problem.spread, wave / np.sqrt(np.mean(wave**2)))
        residuals[run] = slow + problem.noise[:, None] * noise
    return weigh_stated(problem).weigh(place(problem), residuals)


@pytest.mark.parametrize(
    ("gaps", "channel"),
    [
        ((0.1, 0.0, 0.0, 0.048), "frame_acceleration"),
        ((0.1, 0.0, 0.0, 0.053), None),
        ((0.0, 0.02, 0.0, 0.055), "damper_force"),
        # Not material.
        ((0.047, 0.0, 0.0, 0.0), None),
        ((0.053, 0.0, 0.0, 0.0), "frame_acceleration"),
        # A slow error of the travel is creep.
        ((0.0, 0.0, 0.3, 0.0), None),
        ((0.1, 0.1, 0.0, 0.0), None),
    ],
)
def test_a_drift_is_sought_in_the_one_channel_that_stays_open(problem, gaps, channel):
    objective, evaluation = weigh_stated(problem), left(problem, *gaps)
    drift = find_bias_drift(objective, evaluation)
    if channel is None:
        assert drift is None
        return
    k, found = CHANNELS.index(channel), drift.found
    assert (drift.effect, found.block, found.channel) == (BIAS_DRIFT, "sensor", channel)
    assert (found.quantity, found.unit) == (f"error of {channel}", problem.recording.channels[channel].unit)
    assert "everything" in found.shares
    for run in problem.runs:
        # Above the frequencies that are compared nothing is left of the sensor's noise.
        assert np.std(drift.traces[run][k] - evaluation.residuals[run][k]) < problem.noise[k]
        assert not np.any(np.delete(drift.traces[run], k, axis=0))
    assert find_bias_drift(objective, left(problem, *gaps, cycles=20)) is None


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
