"""What data say of parameters, beside ordinary least squares on a damper whose force is linear in its parameters."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from seatsim.identification.assessment import compute_information, correlation_length
from seatsim.identification.damper_record import find_model
from seatsim.identification.problem import state_problem
from seatsim.identification.settings import IdentificationSettings as Settings

from .benches import BINGHAM, made


def test_standard_deviations_are_those_of_ordinary_least_squares_with_fewer_samples():
    """Without current the force is c_a v + fc_a tanh(v / v_ref) + f0."""
    record = made(noise=0.05, seconds=3.0, rate=300.0)
    problem, _ = state_problem([record], find_model("bingham"), 0.0, Settings(fix={"v_ref": BINGHAM.v_ref}))
    start = problem.coordinates.start
    vector = problem.coordinates.to_vector(BINGHAM._replace(c_b=start.c_b, fc_b=start.fc_b))
    with ThreadPoolExecutor(1) as executor:
        known = compute_information(problem, vector, executor)
    residuals = problem.residuals(vector) / problem.weights[0]
    columns = np.column_stack([record.velocity, np.tanh(record.velocity / BINGHAM.v_ref), np.ones(len(record.force))])
    samples = len(residuals) / correlation_length(residuals)
    variance = np.sum(residuals**2) / (samples - 3)
    expected = np.sqrt(np.diag(variance * np.linalg.inv(columns.T @ columns)))
    assert [estimate.name for estimate in known.estimates] == ["c_a", "fc_a", "f0"]
    assert [estimate.std for estimate in known.estimates] == pytest.approx(list(expected), rel=2e-3)
    assert known.samples == pytest.approx(samples)
    assert [estimate.unit for estimate in known.estimates] == ["N s/m", "N", "N"]
