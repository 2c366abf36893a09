"""Effects with a stochastic signal: a force from outside, a bias drift; and what only looks like them."""

import dataclasses

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from seatsim.diagnosis.localise.discrepancy import Discrepancy, is_bias_drift, is_from_outside
from seatsim.diagnosis.localise.regression import predict_share
from seatsim.diagnosis.localise.stochastic import find_bias_drift
from seatsim.diagnosis.noise import measure_broadband
from seatsim.diagnosis.objective import Evaluation
from seatsim.diagnosis.parameters import Parameters
from seatsim.diagnosis.settings.diagnosis_settings import DiagnosisSettings
from seatsim.diagnosis.settings.localising import LocalisationSettings
from seatsim.schema.registry import find
from seatsim.simulation.inputs import Forces

from .posed import pose, solved

RATE = 500.0
SETTINGS = LocalisationSettings()


def coloured(samples, low, high, seed, rate=RATE):
    """Random course of unit RMS between two frequencies in Hz."""
    noise = np.random.default_rng(seed).standard_normal(samples)
    course = sosfiltfilt(butter(2, [low, high], "bandpass", fs=rate, output="sos"), noise)
    return course / np.std(course)


def left(courses, block="suspension"):
    shares = {"velocity": 0.02, "everything": 0.03}
    signals = dict(enumerate(courses))
    return Discrepancy(block, "force", "N", signals, shares, comparable=signals)


def test_a_force_from_outside_is_as_strong_in_every_run():
    course = coloured(5000, 1.0, 20.0, 1)
    assert is_from_outside(DiagnosisSettings(), left([8.0 * course, 9.0 * course]), RATE)
    assert not is_from_outside(DiagnosisSettings(), left([8.0 * course, 14.0 * course]), RATE)


def test_regressors_at_rest_predict_nothing():
    courses = {run: coloured(2000, 1.0, 20.0, seed) for seed, run in enumerate("ab")}
    assert predict_share(SETTINGS, {run: np.zeros((3, 2000)) for run in courses}, courses) == 0.0
    assert predict_share(SETTINGS, {run: course[None] for run, course in courses.items()}, courses) > 0.99


def test_a_zero_wanders_slowly():
    slow, fast = coloured(12000, 0.02, 0.2, 2), coloured(12000, 2.0, 20.0, 3)
    assert is_bias_drift(SETTINGS, left([slow, slow + 0.1 * fast], "sensor"), RATE, 0.0)
    assert not is_bias_drift(SETTINGS, left([fast], "sensor"), RATE, 0.0)
    # What the sensor's own noise accounts for does not speak against a drift.
    assert not is_bias_drift(SETTINGS, left([slow + fast], "sensor"), RATE, 0.0)
    assert is_bias_drift(SETTINGS, left([slow + fast], "sensor"), RATE, float(np.sqrt(np.mean(fast**2))))
    assert not is_bias_drift(SETTINGS, left([slow]), RATE, 0.0)


@pytest.fixture(scope="module")
def posed(sound):
    return pose(sound)


def noisy(posed, true):
    return true + posed.noise[:, None] * np.random.default_rng(7).standard_normal(true.shape)


def test_a_wandering_zero_is_named_with_its_channel(posed):
    k, measured = posed.channels.index("frame_acceleration"), {}
    rate = posed.recording.header.sample_rate
    for seed, run in enumerate(posed.runs):
        true = posed.simulated(run, posed.nominal, ())
        true[k] += 0.3 * posed.spread[k] * coloured(true.shape[1], 0.05, 0.2, seed, rate)
        measured[run] = noisy(posed, true)
    solution = solved(dataclasses.replace(posed, measured=measured))
    assert solution.stochastic == "sensor.bias"
    assert solution.discrepancy.channel == "frame_acceleration"


def test_a_wandering_zero_of_the_floor_is_told_from_a_motion_of_it(posed):
    measured = {}
    for seed, run in enumerate(posed.runs):
        floor = posed.inputs[run].floor
        wander = 0.03 * coloured(len(floor.acceleration), 0.05, 0.2, seed, 1.0 / floor.step)
        moving = floor._replace(acceleration=floor.acceleration + wander)
        measured[run] = noisy(posed, posed.simulated(run, posed.nominal, (), posed.inputs[run]._replace(floor=moving)))
    solution = solved(dataclasses.replace(posed, measured=measured))
    assert (solution.stochastic, solution.discrepancy.channel) == ("sensor.bias", "floor_acceleration")


def test_a_zero_that_wanders_beside_an_effect_is_named_too(posed):
    heavier, k, measured = find("effect", "driver.mass")(change=12.0), posed.channels.index("damper_force"), {}
    for seed, run in enumerate(posed.runs):
        true = posed.simulated(run, posed.nominal, [heavier])
        true[k] += 0.12 * posed.spread[k] * coloured(true.shape[1], 0.2, 0.35, seed, posed.recording.header.sample_rate)
        measured[run] = noisy(posed, true)
    solution = solved(dataclasses.replace(posed, measured=measured))
    assert (solution.stochastic, solution.discrepancy.channel) == ("sensor.bias", "damper_force")
    assert solution.decision.verdict == "known"
    assert [term.effect for term in solution.decision.chosen.parameters.terms] == ["driver.mass"]
    assert {share.block for share in solution.where} == {"sensor", "driver"}


def test_one_channel_that_stays_open_has_a_wandering_zero_unless_it_is_the_travel(posed):
    still = {run: np.zeros_like(values) for run, values in posed.measured.items()}

    def of(**shares):
        rest = {run: values.copy() for run, values in still.items()}
        for name, share in shares.items():
            k = posed.channels.index(name)
            for values in rest.values():
                values[k] = share * posed.spread[k] * coloured(values.shape[1], 0.05, 0.2, 1, 250.0)
        return find_bias_drift(posed, Evaluation(Parameters(posed.nominal), rest, {}, 0.0))

    assert of(damper_force=0.1).channel == "damper_force"
    assert of(damper_force=0.01) is None
    assert of(damper_force=0.1, frame_acceleration=0.07) is None
    assert of(suspension_displacement=0.1) is None


def test_a_random_force_is_named_unless_it_is_withheld(posed):
    measured = {}
    for seed, run in enumerate(posed.runs):
        floor = posed.inputs[run].floor
        push = 15.0 * coloured(len(floor.acceleration), 1.0, 15.0, seed, 1.0 / floor.step)
        true = posed.simulated(run, posed.nominal, (), posed.inputs[run]._replace(forces=Forces(push)))
        measured[run] = noisy(posed, true)
    shaken = dataclasses.replace(posed, measured=measured)
    assert solved(shaken).stochastic == "floor.unmeasured_input"
    assert solved(shaken, ("floor.unmeasured_input",)).decision.verdict == "unknown"


def test_a_random_force_is_named_beside_an_effect_that_hides_it(posed):
    rubbing, measured = find("effect", "suspension.friction")(force=20.0, presliding=2e-4), {}
    for seed, run in enumerate(posed.runs):
        floor = posed.inputs[run].floor
        push = 15.0 * coloured(len(floor.acceleration), 10.0, 14.0, seed, 1.0 / floor.step)
        true = posed.simulated(run, posed.nominal, [rubbing], posed.inputs[run]._replace(forces=Forces(push)))
        measured[run] = noisy(posed, true)
    solution = solved(dataclasses.replace(posed, measured=measured))
    assert solution.stochastic == "floor.unmeasured_input"
    assert solution.decision.chosen.parameters.names == {"suspension.friction"}
    assert {share.block for share in solution.where} == {"floor", "suspension"}


def test_broadband_noise_is_seen_above_the_compared_band(posed):
    run, k = posed.runs[0], posed.channels.index("frame_acceleration")
    quiet = posed.noise[:, None] * np.random.default_rng(3).standard_normal(posed.measured[run].shape)
    assert not np.any(measure_broadband(posed, {run: quiet})[run])
    loud = np.where(np.arange(len(quiet))[:, None] == k, 10.0 * quiet, quiet)
    found = measure_broadband(posed, {run: loud})[run]
    assert np.flatnonzero(found).tolist() == [k]
    assert found[k, 0] == pytest.approx(99.0 * posed.noise[k] ** 2 * quiet.shape[1], rel=0.1)


def test_chatter_hides_no_cause(posed):
    heavier = find("effect", "driver.mass")(change=12.0)
    k, measured = posed.channels.index("frame_acceleration"), {}
    for seed, run in enumerate(posed.runs):
        true = posed.simulated(run, posed.nominal, [heavier])
        true[k] += 0.3 * posed.spread[k] * np.random.default_rng(seed).standard_normal(true.shape[1])
        measured[run] = noisy(posed, true)
    solution = solved(dataclasses.replace(posed, measured=measured))
    assert solution.decision.verdict == "known"
    assert [term.effect for term in solution.decision.chosen.parameters.terms] == ["driver.mass"]
