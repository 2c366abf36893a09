"""Costs against sums over all numbers, and Jacobians against the rig's own linear map and central differences."""

import numpy as np
import pytest

from .toy import Cubed, Edge, add_up, draw_signals, make_problem, offer, offer_two, place, weigh_stated, whiten

NAMES = ["nominal", "nuisance 0", "nuisance 1", "a.one", "a.one beside", "b.two"]
PAIR = offer_two("a.one", (-2.0, 0.5), (-9.0, -9.0), (9.0, 9.0))
CUBE = offer("b.two", start=0.5, cls=Cubed)


@pytest.fixture(scope="module")
def objective():
    signals = draw_signals(NAMES)
    return weigh_stated(make_problem(signals, add_up(signals, {"a.one": 1.5, "nuisance 1": 0.5}), nuisances=2))


@pytest.fixture(scope="module")
def rig(objective):
    return place(objective.problem, (PAIR, 1.0, -0.5), (CUBE, 0.8), deviations=[0.25, -0.5])


@pytest.fixture(scope="module")
def evaluation(objective, rig):
    return objective.evaluate([rig])[0]


def test_the_cost_is_the_whitened_square_and_the_prior(objective, rig, evaluation):
    problem = objective.problem
    total = 0.0
    for run in problem.runs:
        own = problem.signals[run]
        left = problem.measured[run] - own["nominal"] - 0.25 * own["nuisance 0"] + 0.5 * own["nuisance 1"]
        left = left - own["a.one"] + 0.5 * own["a.one beside"] - 0.8**3 * own["b.two"]
        np.testing.assert_allclose(evaluation.residuals[run], left)
        np.testing.assert_allclose(evaluation.whitened[run], objective.weights(left, run))
        total += np.sum(objective.weights(left, run) ** 2)
    prior = (0.25**2 + 0.5**2) / 0.58**2
    assert evaluation.cost == pytest.approx(total + prior, rel=1e-12)
    assert evaluation.parameters is rig


def test_at_an_upper_bound_the_difference_is_taken_downwards(objective):
    top = objective.evaluate([place(objective.problem, (CUBE, 10.0), deviations=[1.0, 0.0])])[0]
    jacobian = objective.linearise(top, [0, 2]).jacobian
    assert all(abs(shift[1][0]) <= 1.0 for shift in objective.problem.calls)
    found = np.hstack([jacobian[run] for run in objective.problem.runs])
    np.testing.assert_allclose(found[0], whiten(objective, "nuisance 0"), rtol=1e-6, atol=1e-6)
    # Backwards from 10 by 0.01: 3 a^2 - 3 a step + step^2, in natural sizes of 0.5.
    below = 0.5 * (3 * 10.0**2 - 3 * 10.0 * 0.01 + 0.01**2)
    np.testing.assert_allclose(found[1], below * whiten(objective, "b.two"), rtol=1e-5, atol=1e-4)


def test_a_rig_that_cannot_be_simulated_a_step_away_has_no_sensitivity(objective):
    edge = place(objective.problem, (offer("b.two", cls=Edge), 1.0))
    evaluation = objective.evaluate([edge])[0]
    assert np.isfinite(evaluation.cost)
    for jacobian in objective.linearise_effects(evaluation).jacobian.values():
        np.testing.assert_array_equal(jacobian, 0.0)
