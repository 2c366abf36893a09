"""How much effects move a rig, against root mean squares that are known, and which effects stand for each other."""

import numpy as np
import pytest

from seatsim.diagnosis.movement import (
    group_equivalent,
    is_material,
    measure_gap_taken,
    measure_movements,
    measure_remainders,
    measure_shares_left,
)
from seatsim.diagnosis.objective import Evaluation, Parameters

from .toy import offer, place, pose_tones

RUNS = {"first": 200, "second": 400}
SIZES = {"a.one": (0.3, 0.0), "b.two": (0.1, 0.5), "c.three": (0.0, 0.02)}


def pose(noise=(0.1, 0.02), sizes=SIZES):
    return pose_tones(sizes, noise, RUNS)


def evaluated(objective, deviation=0.0, **amounts):
    terms = [(offer(name.replace("_", ".")), amount) for name, amount in amounts.items()]
    return objective.evaluate([place(objective.problem, *terms, deviations=[deviation])])[0]


def test_a_movement_is_the_rms_of_what_an_effect_changes_in_standard_deviations():
    objective = pose()
    moves = measure_movements(objective.problem, evaluated(objective, 0.3, a_one=1.0, b_two=-2.0))
    np.testing.assert_allclose(moves, [[0.3, 0.0], [0.2, 1.0]], atol=1e-12)


@pytest.mark.parametrize(
    "noise, size, material",
    [
        # In quiet channels from 0.05 standard deviations on, as the recording's contract has it.
        ((0.0, 0.0), (0.051, 0.0), True),
        ((0.0, 0.0), (0.049, 0.0), False),
        ((0.0, 0.0), (0.0, 0.051), True),
        # In noisy ones from the noise on.
        ((0.2, 0.2), (0.201, 0.0), True),
        ((0.2, 0.2), (0.199, 0.0), False),
        # One channel must fulfil both.
        ((0.2, 0.0), (0.19, 0.04), False),
        ((0.2, 0.0), (0.19, 0.06), True),
        ((0.0, 0.2), (0.06, 0.0), True),
    ],
)
def test_an_effect_is_material_by_size_and_by_noise(noise, size, material):
    objective = pose(noise, {"a.one": size})
    assert is_material(objective.problem, evaluated(objective, a_one=1.0)) is material


def test_a_remainder_is_what_exceeds_the_noise_in_standard_deviations():
    objective = pose((0.05, 0.01))
    found = measure_remainders(objective.problem, evaluated(objective, b_two=1.0))
    np.testing.assert_allclose(found, np.sqrt([0.3**2 - 0.05**2, 0.02**2 - 0.01**2]))
    # Less than the noise is nothing.
    whole = evaluated(objective, a_one=1.0, b_two=1.0, c_three=0.8)
    np.testing.assert_allclose(measure_remainders(objective.problem, whole), 0.0)


def stated(by_run, remainder=(0.0, 0.0)):
    """Return an evaluation with a mean square of every channel by run, and a remainder in standard deviations."""
    whitened = {run: np.sqrt(np.outer(mean, np.ones(10))) for run, mean in zip(RUNS, by_run, strict=True)}
    residuals = {run: np.outer(remainder, np.ones(samples)) for run, samples in RUNS.items()}
    return Evaluation(Parameters(np.zeros(1)), residuals, whitened, 0.0)


def test_the_share_left_is_that_of_channels_with_a_material_gap():
    problem = pose((0.0, 0.0)).problem
    # Of an excess, 0.5 may be the colour of the noise: what is left of 2.0 and 0.75 are 1.5 and 0.25.
    after = stated([(3.0, 1.75), (3.0, 1.75)])
    before = [(9.0, 5.0), (9.0, 5.0)]
    shares = [1.5 / 8.0, 0.25 / 4.0]
    np.testing.assert_allclose(measure_shares_left(problem, stated(before, (0.1, 0.1)), after), shares)
    assert measure_shares_left(problem, stated(before, (0.1, 0.1)), stated([(1.4, 1.0)] * 2)) == [0.0, 0.0]
    # A gap of 0.03 standard deviations is not material, an excess of 0.1 is nothing to explain.
    np.testing.assert_allclose(measure_shares_left(problem, stated(before, (0.03, 0.1)), after), shares[1:])
    faint = [(9.0, 1.1), (9.0, 1.1)]
    np.testing.assert_allclose(measure_shares_left(problem, stated(faint, (0.1, 0.1)), after), shares[:1])
    assert measure_shares_left(problem, stated(faint, (0.03, 0.1)), after) == []
    found = measure_shares_left(problem, stated([(9.0, 1.16)] * 2, (0.051, 0.051)), after)
    assert len(found) == 2 and found[0] == pytest.approx(shares[0])


@pytest.mark.parametrize(
    "chosen, equivalent, groups",
    [
        ("a", [], []),
        ("a", ["b"], [["a", "b"]]),
        ("a", ["b", "c"], [["a", "b", "c"]]),
        # Sets of another size and the chosen one itself say nothing.
        ("a", ["bc", "a"], []),
        ("ab", ["a", "b"], []),
        ("", ["a"], []),
        ("ab", ["cb"], [["a", "c"]]),
        ("ab", ["cb", "ad"], [["a", "c"], ["b", "d"]]),
        # Two effects at once stand for two others: nobody knows which for which.
        ("ab", ["cd"], []),
        # Until it is known that c stands for a; then d stands for b, whatever the order of the sets.
        ("ab", ["cb", "cd"], [["a", "c"], ["b", "d"]]),
        ("ab", ["cd", "cb"], [["a", "c"], ["b", "d"]]),
        ("ab", ["cb", "ad", "cd", "ce", "fg"], [["a", "c"], ["b", "d", "e"]]),
        # Neither stands c for b as well, nor is it listed twice.
        ("ab", ["cb", "cb"], [["a", "c"]]),
        ("ab", ["cb", "ac"], [["a", "c"]]),
        ("ab", ["cb", "acd"], [["a", "c"]]),
        ("abc", ["abd", "eba", "ebd"], [["c", "d", "e"]]),
        ("abc", ["abd", "ebc", "ebd"], [["c", "d"], ["a", "e"]]),
    ],
)
def test_effects_that_stand_for_each_other_are_grouped(chosen, equivalent, groups):
    found = group_equivalent(frozenset(chosen), map(frozenset, equivalent))
    assert [[group[0], *sorted(group[1:])] for group in found] == groups


def test_the_gap_taken_is_a_share_of_what_a_right_model_would_take():
    objective = pose()
    # The weights expect the power 1 per run and frequency of the spectrum of N samples: 2 / N^2 for each frequency.
    left = np.sqrt(np.mean([2.0 / samples**2 * (samples // 2 + 1) for samples in RUNS.values()]))
    none, one, both = (
        evaluated(objective, **amounts) for amounts in ({}, {"a_one": 1.0}, {"a_one": 1.0, "b_two": 1.0})
    )
    before, after = np.sqrt(np.mean([0.3**2 + 0.1**2, 0.5**2 + 0.02**2])), np.sqrt(np.mean([0.1**2, 0.5**2 + 0.02**2]))
    assert measure_gap_taken(objective, none, one) == pytest.approx((before - after) / (before - left), rel=1e-6)
    assert measure_gap_taken(objective, none, both) > 0.9 > measure_gap_taken(objective, none, one)
    assert measure_gap_taken(objective, one, none) < 0.0 == measure_gap_taken(objective, one, one)
