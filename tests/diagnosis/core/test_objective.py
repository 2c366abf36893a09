"""Costs against sums over all numbers, and Jacobians against the rig's own linear map and central differences."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.noise import weigh_gap
from seatsim.diagnosis.objective import Evaluation

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


def test_the_excess_is_reduced_chi_square_less_one_and_never_negative(rig):
    whitened = {"first": np.zeros((2, 30)), "second": np.zeros((2, 20))}
    assert Evaluation(rig, {}, whitened, 100.0).rows == 100
    assert Evaluation(rig, {}, whitened, 250.0).excess == pytest.approx(1.5)
    assert Evaluation(rig, {}, whitened, 40.0).excess == 0.0


def test_the_jacobian_of_a_bent_rig_nears_central_differences_with_the_step(objective, evaluation):
    vector, errors = evaluation.parameters.vector, []
    small = 1e-5 * (np.arange(5) == 4)
    above, below = (
        objective.evaluate([evaluation.parameters.move_to(vector + sign * small)])[0].whitened for sign in (1.0, -1.0)
    )
    exact = {run: (below[run] - above[run]).ravel() / 2e-5 for run in above}
    for step in (0.02, 0.01):
        settings = objective.settings._replace(fit=objective.settings.fit._replace(difference_step=step))
        bent = dataclasses.replace(objective, problem=dataclasses.replace(objective.problem, settings=settings))
        jacobian = bent.linearise(evaluation, [4]).jacobian
        errors.append(
            np.concatenate([jacobian[run][0] - exact[run] for run in exact])
            / np.linalg.norm(np.hstack([*exact.values()]))
        )
    # d(a^3)/da = 3 a^2 with a = 0.5 k: 3 * 0.8^2 * 0.5 = 0.96; a one-sided step of 0.02 adds 3 a step 0.5^2.
    own = np.concatenate([exact[run] for run in objective.problem.runs])
    np.testing.assert_allclose(own, 0.96 * whiten(objective, "b.two"), rtol=1e-4, atol=1e-4)
    first, second = (np.linalg.norm(error) for error in errors)
    assert first == pytest.approx((3 * 0.8 * 0.02 * 0.25 + 0.02**2 * 0.125) / 0.96, rel=1e-3)
    assert second == pytest.approx(0.5 * first, rel=0.02)


def test_at_an_upper_bound_the_difference_is_taken_downwards(objective):
    top = objective.evaluate([place(objective.problem, (CUBE, 10.0), deviations=[1.0, 0.0])])[0]
    jacobian = objective.linearise(top, [0, 2]).jacobian
    assert all(abs(shift[1][0]) <= 1.0 for shift in objective.problem.calls)
    found = np.hstack([jacobian[run] for run in objective.problem.runs])
    np.testing.assert_allclose(found[0], whiten(objective, "nuisance 0"), rtol=1e-6, atol=1e-6)
    # Backwards from 10 by 0.01: 3 a^2 - 3 a step + step^2, in natural sizes of 0.5.
    below = 0.5 * (3 * 10.0**2 - 3 * 10.0 * 0.01 + 0.01**2)
    np.testing.assert_allclose(found[1], below * whiten(objective, "b.two"), rtol=1e-5, atol=1e-4)


def test_the_gradient_of_the_cost_is_that_of_the_normal_equations(objective):
    """Half the cost's slope is `-J'r` and the prior's part, where the rig is linear."""
    rig = place(objective.problem, (PAIR, 1.0, -0.5), deviations=[0.25, -0.5])
    evaluation = objective.evaluate([rig])[0]
    linear = objective.linearise(evaluation, range(4))
    right = sum(
        linear.normal_equations(run, np.zeros((0, values.size)), values)[1]
        for run, values in evaluation.whitened.items()
    )
    slopes = []
    for k in range(4):
        above, below = (
            objective.evaluate([rig.move_to(rig.vector + sign * 1e-3 * (np.arange(4) == k))])[0].cost
            for sign in (1.0, -1.0)
        )
        slopes.append((above - below) / 2e-3)
    prior = np.array([0.25, -0.5, 0.0, 0.0]) / 0.58**2
    np.testing.assert_allclose(slopes, 2.0 * (prior - right), rtol=1e-6)


def test_a_rig_that_cannot_be_simulated_a_step_away_has_no_sensitivity(objective):
    edge = place(objective.problem, (offer("b.two", cls=Edge), 1.0))
    evaluation = objective.evaluate([edge])[0]
    assert np.isfinite(evaluation.cost)
    for jacobian in objective.linearise_effects(evaluation).jacobian.values():
        np.testing.assert_array_equal(jacobian, 0.0)


def test_weights_by_the_gap_charge_every_further_parameter_by_schwarz(objective, rig, evaluation):
    assert (rig.further, evaluation.charged) == (1, evaluation.cost)
    by_gap = dataclasses.replace(objective, weights=weigh_gap(objective.problem, evaluation.residuals))
    found = by_gap.evaluate([rig])[0]
    # exp(-n / 2 log cost) falls by n^(1/2) for n = 40 independent numbers.
    assert (found.charged / found.cost) ** -20 == pytest.approx(40.0**-0.5)
    # A rig with two more is charged twice as much, in logarithms.
    twice = by_gap.evaluate([rig.add(offer_two("b.two", (1.0, 1.0), (0.0, 0.0), (2.0, 2.0)), np.zeros(2))])[0]
    assert (twice.charged / twice.cost) ** -20 == pytest.approx(40.0**-1.0)
