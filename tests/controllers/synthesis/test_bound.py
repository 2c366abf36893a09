"""The bound that no controller beats: where u or y cannot reach it is known, and it is the same from any gain."""

import time
from dataclasses import replace

import numpy as np
import pytest

from controllers.synthesis.certify import certify
from controllers.synthesis.lmi import compute_full_order_bound
from controllers.synthesis.norm import hinf_norm
from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.solve import compute_pointwise_bound, synthesise

ZERO = np.zeros((1, 2))


def lag(gain, seen, reached):
    """w drives a lag of DC gain `gain` onto z1; y sees it where `seen`, u acts on it where `reached`."""
    A, B1, B2 = np.diag([-2.0, -1.0]), [[2.0 * gain, 0.0], [0.0, 1.0]], [[1.0 * reached], [1.0]]
    return GeneralisedPlant(A, B1, B2, np.eye(2), [[1.0 * seen, 1.0]], np.zeros((2, 2)), np.zeros((2, 1)), ZERO)


def test_a_path_that_the_control_does_not_reach_stays():
    # u moves z2 alone, so that z1 is the lag itself: 3 at zero frequency.
    assert compute_pointwise_bound(lag(3.0, seen=True, reached=False), np.zeros((1, 1))) == pytest.approx(3.0, rel=1e-6)


def test_a_disturbance_that_is_not_measured_stays():
    assert compute_pointwise_bound(lag(3.0, seen=False, reached=True), np.zeros((1, 1))) == pytest.approx(3.0, rel=1e-6)


def test_nothing_is_left_where_controls_and_measurements_suffice(random_plant):
    plant = random_plant(4, nw=2, nu=2, nz=2, ny=2)
    gain = np.zeros((2, 2))
    plant = replace(plant, A=plant.A - 5 * np.eye(4))
    assert compute_pointwise_bound(plant, gain) == 0.0


@pytest.mark.parametrize("seed", range(4))
def test_the_bound_is_the_same_from_every_stabilising_gain_and_below_every_norm(random_plant, seed):
    plant = random_plant(seed, nw=3, nz=3)
    plant = replace(plant, A=plant.A - 6 * np.eye(4))
    random = np.random.default_rng(seed)
    gains = [np.zeros((2, 2)), 0.1 * random.standard_normal((2, 2))]
    first, second = (compute_pointwise_bound(plant, gain) for gain in gains)
    assert first == pytest.approx(second, rel=1e-3)
    assert 0 < first <= min(hinf_norm(plant.close(gain)).value for gain in gains)


def test_the_lmi_joins_where_there_is_a_certificate_and_time():
    # x' = x + w + u, z = (x, u), y = x: gains without limit come to 1, of which the frequency response shows sqrt(1/2).
    one, column = np.eye(1), np.zeros((2, 1))
    plant = GeneralisedPlant(one, one, one, [[1], [0]], one, column, [[0], [1]], 0 * one)
    gain = -5 * one
    proof = certify(plant, gain, hinf_norm(plant.close(gain)).value)
    assert compute_pointwise_bound(plant, gain) == pytest.approx(np.sqrt(0.5), rel=1e-6)
    late, soon = time.monotonic() - 1, time.monotonic() + 30
    assert compute_full_order_bound(plant, proof.factor, proof.gamma, late) == 0.0
    assert compute_full_order_bound(plant, proof.factor, proof.gamma, soon) == pytest.approx(1.0, rel=1e-4)
    assert synthesise(plant, max_gain=10.0, time_budget=30.0).lower_bound == pytest.approx(1.0, rel=1e-4)
