"""Effects with a stochastic signal: a force from outside, a bias drift; and what only looks like them."""

import dataclasses

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from seatsim.schema.registry import find
from seatsim.simulation.inputs import Forces

from .posed import pose, solved

RATE = 500.0


def coloured(samples, low, high, seed, rate=RATE):
    """Random course of unit RMS between two frequencies in Hz."""
    noise = np.random.default_rng(seed).standard_normal(samples)
    course = sosfiltfilt(butter(2, [low, high], "bandpass", fs=rate, output="sos"), noise)
    return course / np.std(course)


@pytest.fixture(scope="module")
def posed(sound):
    return pose(sound)


def noisy(posed, true):
    return true + posed.noise[:, None] * np.random.default_rng(7).standard_normal(true.shape)


def test_a_wandering_zero_of_the_floor_is_told_from_a_motion_of_it(posed):
    measured = {}
    for seed, run in enumerate(posed.runs):
        floor = posed.inputs[run].floor
        wander = 0.03 * coloured(len(floor.acceleration), 0.05, 0.2, seed, 1.0 / floor.step)
        moving = floor._replace(acceleration=floor.acceleration + wander)
        measured[run] = noisy(posed, posed.simulated(run, posed.nominal, (), posed.inputs[run]._replace(floor=moving)))
    solution = solved(dataclasses.replace(posed, measured=measured))
    assert (solution.stochastic, solution.discrepancy.channel) == ("sensor.bias", "floor_acceleration")


@pytest.mark.slow
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


@pytest.mark.slow
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
