"""Cosines and likenesses of vectors that are worked out by hand."""

import numpy as np
import pytest

from seatsim.diagnosis.design.separability import measure_cosines, measure_likeness


def test_cosines_are_those_of_the_angles_between_vectors():
    angles = np.radians([0.0, 60.0, 180.0, 90.0])
    vectors = np.array([1.0, 5.0, 0.2, 3.0])[:, None] * np.array([np.cos(angles), np.sin(angles)]).T
    expected = np.cos(angles[:, None] - angles)
    assert np.allclose(measure_cosines(vectors, 1e-9), expected)
    faint = measure_cosines(vectors, 0.2 + 1e-12)
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
