"""What data say of parameters, beside ordinary least squares on a damper whose force is linear in its parameters."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from seatsim.identification.damper_record import find_model
from seatsim.identification.information import _invert_normal_matrix, compute_information, correlation_length
from seatsim.identification.problem import state_problem
from seatsim.identification.settings import IdentificationSettings as Settings

from .benches import BINGHAM, made


@pytest.fixture(scope="module")
def linear():
    """Record, problem and true vector of a Bingham damper without current, F = c_a v + fc_a tanh(v / v_ref) + f0."""
    record = made(noise=0.05, seconds=3.0, rate=300.0)
    problem, _ = state_problem([record], find_model("bingham"), 0.0, Settings(fix={"v_ref": BINGHAM.v_ref}))
    start = BINGHAM._replace(c_b=problem.coordinates.start.c_b, fc_b=problem.coordinates.start.fc_b)
    return record, problem, problem.coordinates.to_vector(start)


@pytest.fixture(scope="module")
def known(linear):
    _, problem, vector = linear
    with ThreadPoolExecutor(1) as executor:
        return compute_information(problem, vector, executor)


def test_standard_deviations_are_those_of_ordinary_least_squares_with_fewer_samples(linear, known):
    record, problem, vector = linear
    residuals = problem.residuals(vector) / problem.weights[0]
    columns = np.column_stack([record.velocity, np.tanh(record.velocity / BINGHAM.v_ref), np.ones(len(record.force))])
    samples = len(residuals) / correlation_length(residuals)
    variance = np.sum(residuals**2) / (samples - 3)
    expected = np.sqrt(np.diag(variance * np.linalg.inv(columns.T @ columns)))
    assert [estimate.name for estimate in known.estimates] == ["c_a", "fc_a", "f0"]
    assert [estimate.std for estimate in known.estimates] == pytest.approx(list(expected), rel=2e-3)
    assert known.samples == pytest.approx(samples)
    assert [estimate.unit for estimate in known.estimates] == ["N s/m", "N", "N"]


def test_a_parameter_is_identified_where_it_is_known_to_a_tenth_of_its_size(known):
    for estimate in known.estimates:
        assert estimate.value == pytest.approx(getattr(BINGHAM, estimate.name), rel=1e-9)
        assert estimate.identified and estimate.std < 0.1 * abs(estimate.value)


def test_what_has_no_influence_has_a_huge_and_finite_variance():
    jacobian = np.random.default_rng(0).standard_normal((40, 2))
    none = _invert_normal_matrix(np.column_stack([jacobian, np.zeros(40)]))
    twice = _invert_normal_matrix(np.column_stack([jacobian, jacobian[:, 0]]))
    assert none[2, 2] > 1e12 and twice[0, 0] > 1e9 and np.all(np.isfinite(none)) and np.all(np.isfinite(twice))
    assert none[0, 0] == pytest.approx(np.linalg.inv(jacobian.T @ jacobian)[0, 0], rel=1e-6)
