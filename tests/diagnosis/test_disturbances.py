"""Effects with a stochastic signal: a force from outside, a bias drift; and what only looks like them."""

import dataclasses

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from seatsim.effects.base import EFFECTS
from seatsim.schema.registry import find
from seatsim.simulation.inputs import Forces

from .posed import pose, solved


def coloured(samples, low, high, seed, rate):
    """Random course of unit RMS between two frequencies in Hz."""
    noise = np.random.default_rng(seed).standard_normal(samples)
    course = sosfiltfilt(butter(2, [low, high], "bandpass", fs=rate, output="sos"), noise)
    return course / np.std(course)


CANDIDATES = {"suspension.friction", "damper.gas_spring", "sensor.gain", "sensor.bias", "floor.unmeasured_input"}
OTHERS = set(EFFECTS.names()) - CANDIDATES
"""Effects withheld where not they are tested, so that a search is quick."""


@pytest.fixture(scope="module")
def posed(sound):
    return pose(sound)


def disturbed(posed, disturb, effects=()):
    """Return the problem as it would have been recorded with effects and inputs that `disturb` makes of those known."""
    measured = {}
    for seed, run in enumerate(posed.runs):
        inputs = disturb(posed.inputs[run], seed)
        true = posed.simulated(run, posed.nominal, effects, inputs)
        measured[run] = true + posed.noise[:, None] * np.random.default_rng(7).standard_normal(true.shape)
    return dataclasses.replace(posed, measured=measured)


def pushed(low, high):
    """Return a disturbance: a random force on the frame of 15 N between two frequencies in Hz."""

    def push(inputs, seed):
        floor = inputs.floor
        return inputs._replace(
            forces=Forces(15.0 * coloured(len(floor.acceleration), low, high, seed, 1.0 / floor.step))
        )

    return push


def test_a_wandering_zero_of_the_floor_is_told_from_a_motion_of_it(posed):
    def wander(inputs, seed):
        floor = inputs.floor
        zero = 0.03 * coloured(len(floor.acceleration), 0.05, 0.2, seed, 1.0 / floor.step)
        return inputs._replace(floor=floor._replace(acceleration=floor.acceleration + zero))

    solution = solved(disturbed(posed, wander), OTHERS)
    assert (solution.stochastic, solution.discrepancy.channel) == ("sensor.bias", "floor_acceleration")


@pytest.mark.slow
def test_a_random_force_is_named_beside_an_effect_that_hides_it(posed):
    rubbing = find("effect", "suspension.friction")(force=20.0, presliding=2e-4)
    solution = solved(disturbed(posed, pushed(10.0, 14.0), [rubbing]))
    assert solution.stochastic == "floor.unmeasured_input"
    assert solution.decision.chosen.parameters.names == {"suspension.friction"}
    assert {share.block for share in solution.where} == {"floor", "suspension"}
