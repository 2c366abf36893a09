"""Bounded minima against the conditions that only the minimum of a strictly convex quadratic meets."""

import numpy as np
import pytest

from seatsim.diagnosis.fit import minimise_bounded


def pose(count, collinear=0.0):
    """Yield random problems of a unit diagonal, with bounds on both sides of 0 or at it."""
    draw = np.random.default_rng(count)
    for _ in range(10):
        rows = draw.normal(size=(40, count))
        if collinear:
            rows = rows[:, :1] + collinear * rows
        size = np.sqrt(np.sum(rows**2, axis=0))
        matrix = rows.T @ rows / np.outer(size, size) + 1e-8 * np.eye(count)
        right, low, high = draw.normal(size=count), -draw.uniform(0.0, 1.0, count), draw.uniform(0.0, 1.0, count)
        low[draw.random(count) < 0.2] = 0.0
        yield matrix, right, low, high


@pytest.mark.parametrize("count", [1, 24])
@pytest.mark.parametrize("collinear", [0.0, 1e-4])
def test_the_gradient_points_outwards_at_each_bound_and_vanishes_between(count, collinear):
    for matrix, right, low, high in pose(count, collinear):
        found = minimise_bounded(matrix, right, low, high)
        gradient = matrix @ found - right
        assert np.all((low <= found) & (found <= high))
        between = (low < found) & (found < high)
        assert np.abs(gradient[between]).max(initial=0.0) < 1e-6
        assert np.all(gradient[(found == low) & (low < high)] > -1e-6)
        assert np.all(gradient[(found == high) & (low < high)] < 1e-6)


@pytest.mark.parametrize("unit", [1e-6, 1e9])
def test_the_minimum_is_the_same_in_every_unit(unit):
    for matrix, right, low, high in pose(12):
        found = minimise_bounded(matrix, unit * right, unit * low, unit * high)
        np.testing.assert_allclose(found / unit, minimise_bounded(matrix, right, low, high), rtol=1e-6, atol=1e-6)
