"""Objective ratings are those computed by hand, and those of another program at 10 kHz."""

import numpy as np
import pytest

from seatsim.metrics.objective_rating import ObjectiveRating, rate_agreement

RATE = 1e4
TIME = np.arange(1500) / RATE
PULSE = np.exp(-(((TIME - 0.07) / 0.015) ** 2))


def figures(reference, curve, rate=RATE):
    return list(rate_agreement(reference, curve, rate)[:4])


@pytest.mark.parametrize("curve", [PULSE, -3.0 * PULSE, np.sin(2 * np.pi * 80 * TIME), np.ones(5), TIME])
def test_identical_curves_agree_fully(curve):
    found = rate_agreement(curve, curve, RATE)
    assert found == ObjectiveRating(1.0, 1.0, 1.0, 1.0, 0.0)
    assert found.overall == pytest.approx(1.0)


def test_a_constant_that_is_off_is_rated_as_by_hand():
    # Of a reference of 1: 0.2 off is two thirds of the way from 0.05 to 0.5, and 0.4 of the 0.5 that are rated 0.
    found = rate_agreement(np.ones(100), 1.2 * np.ones(100), RATE)
    assert found[:5] == pytest.approx(((0.3 / 0.45) ** 2, 1.0, 0.6, 1.0, 0.0))
    assert found.overall == pytest.approx(0.4 * (2 / 3) ** 2 + 0.2 * 2.6)
    assert figures(np.ones(100), 1.5 * np.ones(100)) == pytest.approx([0.0, 1.0, 0.0, 1.0])
    assert figures(np.ones(100), 1.04 * np.ones(100))[0] == 1.0


@pytest.mark.parametrize("late", [7, -7, 19, -19, 20])
def test_a_block_that_is_shifted_is_rated_as_by_hand(late):
    block = np.zeros(100)
    block[40:55] = 2.0
    found = rate_agreement(block, np.roll(block, late), 500.0)
    wrong = min(2 * abs(late), 30)
    assert found == pytest.approx((1.0 - wrong / 100, 1.0 - abs(late) / 20, 1.0, 1.0, late / 500.0))


def test_a_block_that_lasts_longer_is_warped_into_place():
    block, longer = np.zeros(100), np.zeros(100)
    block[40:50], longer[40:52] = 1.0, 1.0
    assert figures(block, longer)[2] == 1.0
    # Warped by at most 19 of 200 samples, the ends of the block reach over 20 samples each and 11 stay at either side.
    block, longer = np.zeros(200), np.zeros(200)
    block[95:105], longer[65:135] = 1.0, 1.0
    assert figures(block, longer)[2] == pytest.approx(1.0 - 22 / 48 / 0.5)


@pytest.mark.parametrize(
    ("curve", "expected"),
    [
        (1.1 * PULSE, (0.978047, 1.0, 0.962055, 0.95)),
        (PULSE + 0.2, (0.444444, 1.0, 0.039548, 1.0)),
        (np.exp(-(((TIME - 0.075) / 0.02) ** 2)), (0.836207, 0.833333, 0.996217, 0.791314)),
        (-PULSE, (0.688658, 0.0, 0.0, 0.348385)),
    ],
)
def test_figures_are_those_of_objective_rating_metrics(curve, expected):
    """Made by version 1.3 of that package; an equal sine of 80 Hz it rates 0.917, since rounding shifts it a period."""
    assert figures(PULSE, curve) == pytest.approx(expected, abs=2e-6)


def test_a_curve_at_rest_correlates_with_nothing():
    assert figures(PULSE, 0.0 * PULSE)[1:] == pytest.approx([1.0, 0.0, 0.5])
