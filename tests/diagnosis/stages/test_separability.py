"""Separability and likeness of rigs, from distances that are worked out by hand."""

import numpy as np
import pytest

from seatsim.diagnosis.design.separability import (
    PredictedExperiment,
    measure_cosines,
    measure_likeness,
    measure_separability,
)

NONE = np.zeros((0, 2))


def predict(outputs, nuisances=NONE, own=None):
    outputs = np.array(outputs, dtype=float)
    return PredictedExperiment(outputs, np.array(nuisances, dtype=float), own or [NONE] * len(outputs))


SAME = predict([[1.0, 2.0], [1.0, 2.0]])


def test_a_nuisance_takes_away_what_its_prior_lets_it():
    # Least of (3 - 2 u)^2 + (u / s)^2 is 9 / (1 + 4 s^2).
    new = predict([[0.0, 4.0], [3.0, 4.0]], [[2.0, 0.0]])
    old = predict(SAME.outputs, [[0.0, 0.0]])
    for std in (0.5, 2.0):
        assert measure_separability(old, new, std, 9.0) == pytest.approx(np.sqrt(9.0 / (1.0 + 4.0 * std**2)))


def test_own_parameters_are_those_of_the_rig_that_is_moved_under_the_wide_prior():
    own = [np.array([[2.0, 0.0]]), np.array([[0.0, 1.0]])]
    old = predict(SAME.outputs, NONE, [np.zeros((1, 2))] * 2)
    new = predict([[0.0, 0.0], [3.0, 0.0]], NONE, own)
    # The first rig reaches the second by its own parameter; the second cannot move that way. The nearest counts.
    assert measure_separability(old, new, 0.1, 2.0) == pytest.approx(np.sqrt(9.0 / 17.0))
    turned = predict([[0.0, 0.0], [0.0, 3.0]], NONE, own)
    assert measure_separability(old, turned, 0.1, 2.0) == pytest.approx(np.sqrt(9.0 / 5.0))


def test_the_nearest_pair_counts():
    old = predict([[0.0, 0.0]] * 3)
    new = predict([[0.0, 0.0], [3.0, 4.0], [3.0, 6.0]])
    assert measure_separability(old, new, 1.0, 1.0) == pytest.approx(2.0)


def test_cosines_are_those_of_the_angles_between_vectors_that_are_not_faint():
    angles = np.radians([0.0, 60.0, 180.0, 90.0])
    vectors = np.array([1.0, 5.0, 0.2, 3.0])[:, None] * np.array([np.cos(angles), np.sin(angles)]).T
    expected = np.cos(angles[:, None] - angles)
    assert np.allclose(measure_cosines(vectors), expected)
    vectors[2] *= 1e-10
    faint = measure_cosines(vectors)
    assert np.all(faint[2] == 0.0) and np.all(faint[:, 2] == 0.0)
    assert faint[0, 1] == pytest.approx(0.5) and faint[0, 0] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("vectors", "likeness"),
    [
        ([[3.0, 0.0], [0.0, 4.0]], 1.0 / 26.0),
        ([[3.0, 0.0], [3.0, 0.0]], 1.0),
        ([[3.0, 0.0], [-3.0, 0.0]], 1.0),
        ([[10.0, 0.0], [2.0, 0.0]], 41.0 / 105.0),
        ([[0.1, 0.0], [0.0, 0.1]], 1.0 / 1.02),
        ([[5.0, 0.0, 0.0], [0.0, 5.0, 0.0], [3.0, 4.0, 0.0]], (2.0 * 20.0 + 1.0) / 51.0),
    ],
)
def test_likeness_is_that_of_the_most_alike_pair(vectors, likeness):
    assert measure_likeness(np.array(vectors)) == pytest.approx(likeness)
