"""Curves of the bounds over travel."""

import numpy as np
import pytest

from controllers.clairvoyant import ClairvoyantBounds

FOUND = ClairvoyantBounds(
    np.array([1.0, 4.0]), np.array([2.0, 5.0]), np.array([1.5, 1.2]), np.array([0.5, 1.0]), np.zeros((2, 3)), 0.005
)


def test_the_bound_is_the_highest_of_all_weights():
    assert FOUND.bound(0.0) == pytest.approx(np.sqrt(5.0))
    # At 1 m: 2 - 1 and 5 - 4 meet; at 1.2 m the first weight is higher; at 10 m nothing is left.
    np.testing.assert_allclose(FOUND.bound([1.0, 1.2, 10.0]), [1.0, np.sqrt(2.0 - 1.44), 0.0])
    np.testing.assert_allclose(FOUND.bound(0.5), 2.0)


def test_the_best_is_interpolated_and_never_rises_with_travel():
    np.testing.assert_allclose(FOUND.best([0.5, 0.75, 2.0]), [1.5, 1.35, 1.2])
    assert np.isnan(FOUND.best(0.4))
    turned = ClairvoyantBounds(
        FOUND.weights, FOUND.lower, np.array([1.2, 1.1, 1.5]), np.array([1.0, 2.0, 0.5]), FOUND.force, 0.005
    )
    np.testing.assert_allclose(turned.best([0.75, 1.0, 1.5]), [1.35, 1.2, 1.15])
    worse = ClairvoyantBounds(FOUND.weights, FOUND.lower, np.array([1.2, 1.4]), FOUND.travel, FOUND.force, 0.005)
    np.testing.assert_allclose(worse.best([0.75, 3.0]), [1.2, 1.2])
