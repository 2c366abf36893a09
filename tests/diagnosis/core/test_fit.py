"""Steps and fits against scipy's bounded least squares on the stacked problem, which is exact on a linear rig."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from seatsim.diagnosis.fit import fit, solve_step
from seatsim.diagnosis.objective import PRIOR_STD

from .toy import (
    Cubed,
    Edge,
    add_up,
    draw_signals,
    make_problem,
    offer,
    offer_two,
    place,
    stack,
    weigh_stated,
)

NAMES = ["nominal", "nuisance 0", "nuisance 1", "a.one", "a.one beside", "b.two"]
PAIR = offer_two("a.one", (-2.0, 0.5), (-9.0, -9.0), (9.0, 9.0))
SINGLE = offer("b.two", start=0.5)


def pose(amounts):
    signals = draw_signals(NAMES)
    return weigh_stated(make_problem(signals, add_up(signals, amounts), nuisances=2))


def starting(objective, *terms, deviations=None):
    start = objective.evaluate([place(objective.problem, *terms, deviations=deviations)])[0]
    return start, objective.linearise_nuisances(start)


def bounded(jacobian, residual, count, vector, low, high):
    """Return the step by scipy, with the prior as further rows of the least-squares problem."""
    prior = np.eye(count, len(vector)) / PRIOR_STD
    rows, target = np.vstack([jacobian, prior]), np.concatenate([residual, -vector[:count] / PRIOR_STD])
    return lsq_linear(rows, target, (low - vector, high - vector), method="bvls", tol=1e-14).x


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("reach", [0.05, 0.4, 50.0])
def test_a_step_is_that_of_bounded_least_squares_with_the_prior(seed, reach):
    rng = np.random.default_rng(seed)
    # Components of very unlike sizes, as dampings and travels are.
    jacobian = rng.standard_normal((60, 6)) * np.array([1.0, 30.0, 0.2, 5.0, 1e3, 0.01])
    residual, vector = jacobian @ rng.standard_normal(6) + rng.standard_normal(60), 0.3 * rng.standard_normal(6)
    low, high = vector - reach * rng.random(6), vector + reach * rng.random(6)
    arguments = (3, vector, low, high)
    step = solve_step(jacobian.T @ jacobian, jacobian.T @ residual, *arguments)
    expected = bounded(jacobian, residual, *arguments)
    size = np.linalg.norm(jacobian, axis=0)
    np.testing.assert_allclose(step * size, expected * size, atol=1e-5 * np.abs(expected * size).max())
    if reach < 1.0:
        active = np.isclose(expected, low - vector) | np.isclose(expected, high - vector)
        assert active.any()
        assert np.all(step >= low - vector - 1e-6) and np.all(step <= high - vector + 1e-6)


def test_a_fit_keeps_the_bounds_and_is_the_best_within_them():
    objective = pose({"a.one": 3.0, "b.two": 1.2, "nuisance 0": 4.0})
    narrow = SINGLE._replace(low=(-0.5,), high=(0.7,))
    start, nuisances = starting(objective, (PAIR, -2.0, 0.5), (narrow, 0.5))
    found = fit(objective, start, nuisances)
    matrix, target = stack(objective, ["a.one", "a.one beside", "b.two"])
    limits = np.array([-1.0, -1.0, -9.0, -9.0, -0.5]), np.array([1.0, 1.0, 9.0, 9.0, 0.7])
    best = lsq_linear(matrix, target, limits, method="bvls").x
    values = np.concatenate([found.parameters.deviations, *found.parameters.values])
    np.testing.assert_allclose(values, best, rtol=1e-4, atol=1e-5)
    assert values[0] == 1.0 and values[4] == 0.7


def test_more_steps_never_cost_more_and_end_at_the_minimum(monkeypatch):
    # The cube of an amount acts, so that a whole step goes far too far.
    objective = pose({"b.two": 8.0})
    start, nuisances = starting(objective, (offer("b.two", low=0.0, high=20.0, cls=Cubed), 0.5))

    def fit_in(steps):
        with monkeypatch.context() as patch:
            patch.setattr("seatsim.diagnosis.fit._MOST_STEPS", steps)
            return fit(objective, start, nuisances)

    ends = [fit_in(steps) for steps in range(7)]
    costs = [end.cost for end in ends]
    assert costs == sorted(costs, reverse=True) and costs[1] > costs[2] > costs[3]
    assert ends[6].parameters.values[0][0] == pytest.approx(2.0, rel=0.01)
    assert fit(objective, start, nuisances).cost == costs[6]


def test_a_rig_that_leaves_all_bounds_is_no_better_than_the_start():
    objective = pose({"b.two": 1.2})
    start, nuisances = starting(objective, (offer("b.two", start=2.0, cls=Edge), 2.0))
    assert fit(objective, start, nuisances).cost == np.inf


def test_a_component_beyond_its_bound_by_rounding_stays_where_it_is():
    matrix, right = np.eye(2), np.array([-3.0, 3.0])
    beyond = np.array([-1.0 - 1e-10, 1.0 + 1e-10])
    step = solve_step(matrix, right, 0, beyond, -np.ones(2), np.ones(2))
    np.testing.assert_array_equal(step, 0.0)
