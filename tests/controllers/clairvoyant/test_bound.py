"""The lower bound: its ascent on known functions, its hats, and what it may not exceed."""

import numpy as np
import pytest

from controllers.clairvoyant.bound import (
    _ascend,
    _build_hat_functions,
    _find_constant_multipliers,
    _make_dual_function,
    _sum_hats,
    find_lower_bound,
)
from controllers.clairvoyant.feasible import find_best_run


def test_the_ascent_comes_near_the_top_of_a_concave_function():
    H, top = np.geomspace(1.0, 1e3, 40), np.random.default_rng(0).uniform(-1, 1, 40)
    calls = []

    def objective(y):
        calls.append(y)
        return (5.0 - 0.5 * np.sum(H * (y - top) ** 2), -H * (y - top)) if np.abs(y).max() < 3 else None

    reached = _ascend(objective, np.zeros(40))
    assert objective(reached)[0] > 5.0 - 1e-4
    assert len(calls) < 160
    np.testing.assert_array_equal(_ascend(lambda y: None, top), top)


def test_the_dual_function_has_the_gradient_of_its_value(problem, band):
    hats = _build_hat_functions(problem.intervals, problem.transcription.step)
    y = np.log(np.repeat([3e-5, 2e-5, 1e-8], hats.shape[1]))
    dual = _make_dual_function(problem, band, hats, 1e-5)
    _, found = dual(y)
    for k in (0, 5, hats.shape[1] + 3, 2 * hats.shape[1] + 4):
        step = np.zeros_like(y)
        step[k] = 1e-4
        assert found[k] == pytest.approx((dual(y + step)[0] - dual(y - step)[0]) / 2e-4, rel=1e-4)
    assert dual(y + np.random.default_rng(0).uniform(-5, 15, len(y))) is None


def test_the_bound_lies_below_every_run_and_above_that_of_constant_multipliers(problem, band, dense):
    run = find_best_run(problem, band)
    found = find_lower_bound(problem, band, run.cost)
    hats = _build_hat_functions(problem.intervals, problem.transcription.step)
    y = _find_constant_multipliers(problem, band, hats, run.cost)
    constant = problem.minimise_lagrangian(band, _sum_hats(hats, y), 0.0).bound
    assert 0 < constant < found.value < run.cost
    # Without any limit on the force the criterion would be far lower.
    H, h, free, _ = dense
    assert found.value > free - h @ np.linalg.solve(H + 1e-12 * np.eye(len(H)), h)
    again = problem.minimise_lagrangian(band, _sum_hats(hats, found.logarithms), 0.0)
    assert again.bound == pytest.approx(found.value, rel=1e-12)
    np.testing.assert_allclose(again.gain, found.gain)
    assert found.value > 0.9 * run.cost


def test_a_start_without_a_minimum_is_retreated_from(problem, band):
    run = find_best_run(problem, band)
    nodes = _build_hat_functions(problem.intervals, problem.transcription.step).shape[1]
    wild = np.log(np.repeat([0.1, 0.1, 1e-9], nodes))
    found = find_lower_bound(problem, band, run.cost, wild)
    assert 0.8 * run.cost < found.value < run.cost
