"""Effects with a stochastic signal: how they are found, what they add to the noise, how they stand beside others."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.decide import Decision
from seatsim.diagnosis.localise.discrepancy import Discrepancy
from seatsim.diagnosis.localise.stochastic import (
    BIAS_DRIFT,
    FORCE_FROM_OUTSIDE,
    add_strength,
    add_to_noise,
    find_bias_drift,
    merge_effect,
    name_stochastic_effect,
)
from seatsim.diagnosis.noise import weigh_noise
from seatsim.diagnosis.objective import Evaluation
from seatsim.diagnosis.result import Cause, Estimate, Share
from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.diagnosis.spectra import smooth_spectrum

from .toy import CHANNELS, RATE, SKIP, add_taps, place, pose, record

SETTINGS = DiagnosisSettings()


@pytest.fixture(scope="module")
def problem(folder):
    return pose(record(folder, runs={"first": 400, "second": 300}, channels=CHANNELS[:4], noise=0.01))


def left(problem, *gaps):
    """Return a rig that leaves white residuals of some size, in standard deviations of the channels beyond noise."""
    rng, residuals = np.random.default_rng(1), {}
    level = np.sqrt((np.array(gaps) * problem.spread) ** 2 + problem.noise**2)
    for run, values in problem.measured.items():
        drawn = rng.standard_normal(values.shape)
        residuals[run] = level[:, None] * drawn / np.sqrt(np.mean(drawn**2, axis=1, keepdims=True))
    return Evaluation(place(problem), residuals, {}, 0.0)


@pytest.mark.parametrize(
    ("gaps", "channel"),
    [
        ((0.1, 0.0, 0.0, 0.049), "frame_acceleration"),
        ((0.1, 0.0, 0.0, 0.051), None),
        ((0.0, 0.02, 0.0, 0.05), "damper_force"),
        # Not material.
        ((0.049, 0.0, 0.0, 0.0), None),
        ((0.051, 0.0, 0.0, 0.0), "frame_acceleration"),
        # A slow error of the travel is creep.
        ((0.0, 0.0, 0.3, 0.0), None),
        ((0.1, 0.1, 0.0, 0.0), None),
    ],
)
def test_a_drift_is_sought_in_the_one_channel_that_stays_open(problem, gaps, channel):
    evaluation = left(problem, *gaps)
    found = find_bias_drift(problem, evaluation)
    if channel is None:
        assert found is None
        return
    k = CHANNELS.index(channel)
    assert (found.block, found.channel, found.quantity) == ("sensor", channel, f"error of {channel}")
    assert found.unit == problem.recording.channels[channel].unit
    assert all(np.array_equal(found.signals[run], evaluation.residuals[run][k]) for run in problem.runs)
    assert "everything" in found.shares


def discrepancy(block, frequency=5.0, ratio=1.0, predicted=0.0, channel="", rms=2.0):
    signals = {}
    for k, (run, samples) in enumerate({"first": 400, "second": 300}.items()):
        wave = np.sqrt(2.0) * np.sin(2.0 * np.pi * frequency * np.arange(samples) / RATE)
        signals[run] = rms * wave * ratio**k
    return Discrepancy(block, "force", "N", signals, {"velocity": predicted, "everything": predicted}, channel, signals)


@pytest.mark.parametrize(
    ("found", "effect"),
    [
        (discrepancy("suspension"), FORCE_FROM_OUTSIDE),
        (discrepancy("suspension", ratio=2.0), ""),
        (discrepancy("suspension", predicted=0.3), ""),
        (discrepancy("damper"), ""),
        (discrepancy("driver"), ""),
        (discrepancy("sensor"), ""),
        (discrepancy("sensor", frequency=0.25), BIAS_DRIFT),
        (discrepancy("sensor", frequency=0.25, ratio=5.0, predicted=0.9), BIAS_DRIFT),
        (discrepancy("suspension", frequency=0.25), FORCE_FROM_OUTSIDE),
        (discrepancy("driver", frequency=0.25), ""),
    ],
)
def test_what_a_discrepancy_may_be(problem, found, effect):
    assert name_stochastic_effect(problem, found) == effect


def test_without_a_load_cell_a_force_of_the_damper_may_be_one_from_outside(problem):
    short = dataclasses.replace(problem, channels=CHANNELS[:3])
    assert name_stochastic_effect(short, discrepancy("damper")) == FORCE_FROM_OUTSIDE
    assert name_stochastic_effect(short, discrepancy("damper", predicted=0.3)) == ""
    assert name_stochastic_effect(short, discrepancy("driver")) == ""


def decide(groups=()):
    return Decision("unknown", None, list(groups), {"driver.mass": 0.3, BIAS_DRIFT: 0.1}, 0.2, 0.7)


def test_the_effect_is_known_beside_what_else_was_found():
    decision, where = merge_effect(SETTINGS, decide(), [Share("driver", 0.75), Share("coil", 0.25)], BIAS_DRIFT)
    assert decision.verdict == "known" and (decision.none, decision.unknown) == (0.01, 0.1)
    assert decision.probabilities == {"driver.mass": 0.3, BIAS_DRIFT: 0.9}
    assert [share.block for share in where] == ["sensor", "driver", "coil"]
    assert [share.share for share in where] == pytest.approx([0.6, 0.3, 0.1])


def test_a_cause_has_the_strength_of_its_signal_and_the_channel_that_errs():
    cause = Cause(BIAS_DRIFT, 0.9, 0.1, {"share": Estimate(1.0, 0.1, "-")})
    found = Discrepancy("sensor", "error", "N", {"a": np.full(3, 3.0), "b": np.full(3, -4.0)}, {}, "damper_force")
    strong = add_strength(cause, found)
    assert strong[:3] == cause[:3] and list(strong.parameters) == ["channel", "rms"]
    assert strong.parameters["channel"] == "damper_force"
    assert strong.parameters["rms"] == Estimate(pytest.approx(np.sqrt(12.5)), 0.0, "N")
    assert list(add_strength(cause, found._replace(channel="")).parameters) == ["rms"]


def powers_beyond(problem, effect, found):
    """Return the power of the noise by run that is added to what was there, whatever that was."""
    before = weigh_noise(problem).add({run: np.full((4, 1), 0.3) for run in problem.runs})
    after = add_to_noise(problem, before, effect, found)
    return {run: after.power[run] - before.power[run] for run in problem.runs}


def test_a_drift_of_the_floors_sensor_adds_what_its_motion_leaves_in_all_channels(problem):
    found = discrepancy("sensor", 0.25, channel="floor_acceleration", rms=0.3)
    beyond = powers_beyond(problem, BIAS_DRIFT, found)
    for run, power in beyond.items():
        whole = np.zeros(len(problem.recording.table(run)["floor_acceleration"]))
        whole[SKIP : SKIP + len(found.signals[run])] = found.signals[run]
        change = add_taps("floor", whole)[:4, SKIP : SKIP + len(found.signals[run])]
        expected = smooth_spectrum(np.abs(np.fft.rfft(change)) ** 2, 0.15)[:, : power.shape[1]]
        assert np.allclose(power, expected, rtol=1e-6, atol=1e-9 * np.max(expected))
